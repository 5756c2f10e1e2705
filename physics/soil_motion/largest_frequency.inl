// Largest frequency of elastic motion of the filled mesh, docs/theory (5.7); included only where SoilMotion is
// instantiated.
#include "physics/soil_motion.h"

namespace talus {

/// Adds the forces of the elastic stress that displacements `x` cause, and returns x^T K x of this rank [J]; cells
/// without patches, which are stiffer than with them.
template <int dim, class Phases>
double SoilMotion<dim, Phases>::elastic_force(const Vec<dim> *x, Vec<dim> *force) const {
  double energy = 0;
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const Shape<dim> &cell = grid_.shape[c];
    const auto &[lame, shear] = elasticity_[c];
    Square<dim> g = Square<dim>::Zero();
    for (int k = 0; k < dim; ++k)
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) g(i, j) += (x[cell.node[k + 1]][i] - x[cell.node[0]][i]) * cell.gradient[k][j];
    Square<dim> stress = shear * (g + g.transpose());
    stress.diagonal().array() += lame * g.trace();
    energy += weight_[c] * stress.cwiseProduct(g).sum();
    for (int k = 0; k < dim; ++k) {
      const auto f = weight_[c] * (stress * map<dim>(cell.gradient[k]));
      map<dim>(force[cell.node[k + 1]]) += f, map<dim>(force[cell.node[0]]) -= f;
    }
  }
  return energy;
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::iterate_to_largest_frequency(int iterations,
                                                                     double *omega) requires(!Phases::liquid) {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count(), cells = grid_.cell_count();
  if (elasticity_.empty()) {
    elasticity_.resize(mesh_.cell_count());
    for (auto *field : {&mode_, &wave_, &wave_force_}) field->resize(mesh_.node_count());
  }
  std::fill_n(elasticity_.begin(), cells, std::array<double, 2>{});
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const double shear = shear_modulus(bodies_[b]->law()), lame = bulk_modulus(bodies_[b]->law()) - 2 * shear / 3;
    for (int q = 0; q < points_[b].count; ++q) {
      const int c = points_[b].cell[q];
      const double share = points_[b].volume[q] / particle_volume_[c];
      elasticity_[c][0] += share * lame, elasticity_[c][1] += share * shear;
    }
  }
  double peak = 0;
  for (int i = 0; i < nodes; ++i)
    for (double x : mode_[grid_.mesh_node[i]]) peak = std::max(peak, std::abs(x));
  MPI_Allreduce(MPI_IN_PLACE, &peak, 1, MPI_DOUBLE, MPI_MAX, comm());
  const double scale = peak > 0 ? 1 / peak : 0,
               noise = 0.1;  // the same at a node on all ranks: from it a mode of new cells grows
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < dim; ++d) {
      const Vec<dim> &X = mesh_.position[grid_.mesh_node[i]];
      double phase = d;
      for (int j = 0; j < dim; ++j) phase += (3 + 2 * j) * X[j] / mesh_.mean_edge[grid_.mesh_node[i]];
      wave_[i][d] = scale * mode_[grid_.mesh_node[i]][d] + noise * std::sin(phase);
    }
  for (int k = 0; k < iterations; ++k) {
    std::fill_n(wave_force_.begin(), nodes, Vec<dim>{});
    double sums[2] = {0, elastic_force(wave_.data(), wave_force_.data())};
    PetscCall(grid_.sum(wave_force_[0].data(), dim));
    for (int i = 0; i < nodes; ++i)
      for (double &f : wave_force_[i]) f *= grid_.mass[i] > smallest_mass_ ? 1 / grid_.mass[i] : 0;
    sums[0] = seen_square(wave_force_[0].data());
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm());
    *omega = std::sqrt(sums[0] / sums[1]);
    PetscCall(back_and_forth(wave_force_.data(), wave_.data()));
    for (int i = 0; i < nodes; ++i)
      for (double &x : wave_[i]) x /= *omega * *omega;
  }
  for (int i = 0; i < nodes; ++i) mode_[grid_.mesh_node[i]] = wave_[i];
  PetscFunctionReturn(0);
}

}  // namespace talus
