#include "physics/soil_motion/fastest_mode.h"

#include <algorithm>
#include <cmath>

#include "base/local_numbers.h"
#include "physics/kinematics.h"
#include "physics/laws/laws.h"
#include "transfer/mass_matrix.h"

namespace talus {

template <int dim>
void FastestMode<dim>::measure_elasticity(const FilledGrid<dim> &grid, const SoilState<dim> &state,
                                          const std::vector<std::unique_ptr<Body<dim>>> &bodies,
                                          const std::vector<PointSet> &points) {
  std::fill_n(elasticity_.begin(), grid.cell_count(), std::array<double, 2>{});
  for (size_t b = 0; b < bodies.size(); ++b) {
    const double shear = shear_modulus(bodies[b]->law()), lame = bulk_modulus(bodies[b]->law()) - 2 * shear / 3;
    for (int q = 0; q < points[b].count; ++q) {
      const int c = points[b].cell[q];
      const double share = points[b].volume[q] / state.particle_volume[c];
      elasticity_[c][0] += share * lame, elasticity_[c][1] += share * shear;
    }
  }
}

/// Starts from the last mode, scaled to 1, and a tenth of noise, the same at a node on all ranks: from it a mode of
/// cells newly filled grows. Collective.
template <int dim>
PetscErrorCode FastestMode<dim>::start(const FilledGrid<dim> &grid) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  double peak = 0;
  for (int i = 0; i < nodes; ++i)
    for (double x : mode_[grid.mesh_node[i]]) peak = std::max(peak, std::abs(x));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &peak, 1, MPI_DOUBLE, MPI_MAX, mesh_.comm()));
  const double scale = peak > 0 ? 1 / peak : 0, noise = 0.1;
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < dim; ++d) {
      const Vec<dim> &X = mesh_.position[grid.mesh_node[i]];
      double phase = d;
      for (int j = 0; j < dim; ++j) phase += (3 + 2 * j) * X[j] / mesh_.mean_edge[grid.mesh_node[i]];
      wave_[i][d] = scale * mode_[grid.mesh_node[i]][d] + noise * std::sin(phase);
    }
  PetscFunctionReturn(0);
}

/// Adds the forces of the elastic stress that displacements `wave_` = x cause, and returns x^T K x of this rank [J];
/// cells without patches, which are stiffer than with them.
template <int dim>
double FastestMode<dim>::elastic_force(const FilledGrid<dim> &grid, const SoilState<dim> &state) {
  double energy = 0;
  const Vec<dim> *x = wave_.data();
  for (int c = 0; c < grid.cell_count(); ++c) {
    const Shape<dim> &cell = state.shape[c];
    const double weight = state.weight[c];
    const auto &[lame, shear] = elasticity_[c];
    Square<dim> g = Square<dim>::Zero();
    for (int k = 0; k < dim; ++k)
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) g(i, j) += (x[cell.node[k + 1]][i] - x[cell.node[0]][i]) * cell.gradient[k][j];
    Square<dim> stress = shear * (g + g.transpose());
    stress.diagonal().array() += lame * g.trace();
    energy += weight * stress.cwiseProduct(g).sum();
    for (int k = 0; k < dim; ++k) {
      const auto f = weight * (stress * map<dim>(cell.gradient[k]));
      map<dim>(force_[cell.node[k + 1]]) += f, map<dim>(force_[cell.node[0]]) -= f;
    }
  }
  return energy;
}

template <int dim>
PetscErrorCode FastestMode<dim>::find(FilledGrid<dim> &grid, const SoilState<dim> &state,
                                      const std::vector<std::unique_ptr<Body<dim>>> &bodies,
                                      const std::vector<PointSet> &points, int iterations, double *omega) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  if (elasticity_.empty()) {
    elasticity_.resize(mesh_.cell_count());
    for (auto *field : {&mode_, &wave_, &force_}) field->resize(mesh_.node_count());
  }
  measure_elasticity(grid, state, bodies, points);
  PetscCall(start(grid));
  for (int k = 0; k < iterations; ++k) {
    std::fill_n(force_.begin(), nodes, Vec<dim>{});
    double sums[2] = {0, elastic_force(grid, state)};
    PetscCall(grid.sum(force_[0].data(), dim));
    for (int i = 0; i < nodes; ++i)
      for (double &f : force_[i]) f *= grid.mass[i] > smallest_mass_ ? 1 / grid.mass[i] : 0;
    sums[0] = seen_square<dim, 1>(grid, force_.data());
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm()));
    *omega = std::sqrt(sums[0] / sums[1]);
    PetscCall((to_particles_and_back<dim, 1>(grid, force_.data(), wave_.data())));
    for (int i = 0; i < nodes; ++i)
      for (double &x : wave_[i]) x /= *omega * *omega;
  }
  for (int i = 0; i < nodes; ++i) mode_[grid.mesh_node[i]] = wave_[i];
  PetscFunctionReturn(0);
}

template <int dim>
void FastestMode<dim>::serialize(Archive &archive) {
  std::vector<long long> nodes;  // that move
  std::vector<Vec<dim>> values;
  for (size_t i = 0; i < mode_.size(); ++i)
    if (mode_[i] != Vec<dim>{}) nodes.push_back(mesh_.global_node[i]), values.push_back(mode_[i]);
  archive.column(archive.rows("nodes of the fastest mode", Belongs::to_points, nodes), "fastest mode", values);
  if (!archive.reading()) return;
  mode_.assign(mesh_.node_count(), Vec<dim>{});
  const LocalNumbers node_of(mesh_.global_node);
  for (size_t k = 0; k < nodes.size(); ++k) mode_[node_of(nodes[k])] = values[k];
}

template class FastestMode<2>;
template class FastestMode<3>;

}  // namespace talus
