#include "physics/soil_motion/fastest_mode.h"

#include <algorithm>
#include <cmath>

#include "base/local_numbers.h"
#include "base/room.h"
#include "physics/kinematics.h"
#include "physics/laws/law.h"
#include "transfer/mass_matrix.h"

namespace talus {

template <int dim, int fields>
void FastestMode<dim, fields>::measure_elasticity(const FilledGrid<dim> &grid, const SoilState<dim> &state,
                                                  const std::vector<std::unique_ptr<Body<dim>>> &bodies,
                                                  const std::vector<PointSet> &points) {
  std::fill_n(elasticity_.begin(), grid.cell_count(), Elasticity{});
  for (size_t b = 0; b < bodies.size(); ++b) {
    const double shear = shear_modulus(bodies[b]->law()), lame = bulk_modulus(bodies[b]->law()) - 2 * shear / 3;
    const PoreStiffness &pores = pores_[b];
    for (int q = 0; q < points[b].count; ++q) {
      const int c = points[b].cell[q];
      const double share = points[b].volume[q] / state.particle_volume[c];
      Elasticity &cell = elasticity_[c];
      cell.lame += share * lame, cell.shear += share * shear;
      if constexpr (fluids > 0) {
        cell.porosity += share * pores.porosity;
        for (int a = 0; a < fluids; ++a)
          cell.pore_modulus[a] += share * pores.fluids[a].bulk_modulus / pores.porosity,
              cell.inertia[a] += share * pores.porosity * pores.fluids[a].density;
      }
    }
  }
}

/// Masses of the fluids at the nodes, with pores full of each. Collective.
template <int dim, int fields>
PetscErrorCode FastestMode<dim, fields>::measure_fluid_mass(FilledGrid<dim> &grid, const SoilState<dim> &state) {
  PetscFunctionBeginUser;
  for (int a = 0; a < fluids; ++a) {
    std::vector<double> &mass = fluid_mass_[a];
    std::fill_n(mass.begin(), grid.node_count(), 0.);
    for (int c = 0; c < grid.cell_count(); ++c)
      for (int node : state.shape[c].node) mass[node] += state.weight[c] * elasticity_[c].inertia[a] / (dim + 1);
    PetscCall(grid.sum(mass.data(), 1));
  }
  PetscFunctionReturn(0);
}

/// Starts from the last mode, scaled to 1, and a tenth of noise, the same at a node on all ranks: from it a mode of
/// cells newly filled grows. Collective.
template <int dim, int fields>
PetscErrorCode FastestMode<dim, fields>::start(const FilledGrid<dim> &grid) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  double peak = 0;
  for (const auto &mode : mode_)
    for (int i = 0; i < nodes; ++i)
      for (double x : mode[grid.mesh_node[i]]) peak = std::max(peak, std::abs(x));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &peak, 1, MPI_DOUBLE, MPI_MAX, mesh_.comm()));
  const double scale = peak > 0 ? 1 / peak : 0, noise = 0.1;
  for (int f = 0; f < fields; ++f)
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) {
        const Vec<dim> &X = mesh_.position[grid.mesh_node[i]];
        double phase = f * dim + d;
        for (int j = 0; j < dim; ++j) phase += (3 + 2 * j) * X[j] / mesh_.mean_edge[grid.mesh_node[i]];
        wave_[f * nodes + i][d] = scale * mode_[f][grid.mesh_node[i]][d] + noise * std::sin(phase);
      }
  PetscFunctionReturn(0);
}

/// Adds the forces of the elastic stress that displacements `wave_` = x cause, and returns x^T K x of this rank [J];
/// cells without patches and smoothing of pore pressures, which are stiffer than with them.
template <int dim, int fields>
double FastestMode<dim, fields>::elastic_force(const FilledGrid<dim> &grid, const SoilState<dim> &state) {
  double energy = 0;
  const int nodes = grid.node_count();
  for (int c = 0; c < grid.cell_count(); ++c) {
    const Shape<dim> &cell = state.shape[c];
    const double weight = state.weight[c];
    const Elasticity &elastic = elasticity_[c];
    const Vec<dim> *x = wave_.data();
    Square<dim> g = Square<dim>::Zero();
    for (int k = 0; k < dim; ++k)
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) g(i, j) += (x[cell.node[k + 1]][i] - x[cell.node[0]][i]) * cell.gradient[k][j];
    Square<dim> stress = elastic.shear * (g + g.transpose());
    stress.diagonal().array() += elastic.lame * g.trace();
    energy += weight * stress.cwiseProduct(g).sum();
    if constexpr (fluids > 0)
      for (int a = 0; a < fluids; ++a) {
        const int first = (1 + a) * nodes;
        double divergence = 0;
        for (int k = 0; k < dim; ++k)
          for (int i = 0; i < dim; ++i)
            divergence += (x[first + cell.node[k + 1]][i] - x[first + cell.node[0]][i]) * cell.gradient[k][i];
        const double n = elastic.porosity, strain = (1 - n) * g.trace() + n * divergence;
        const double pressure = elastic.pore_modulus[a] * strain;
        energy += weight * pressure * strain;
        stress.diagonal().array() += (1 - n) * pressure;
        for (int k = 0; k < dim; ++k) {
          const auto f = weight * n * pressure * map<dim>(cell.gradient[k]);
          map<dim>(force_[first + cell.node[k + 1]]) += f, map<dim>(force_[first + cell.node[0]]) -= f;
        }
      }
    for (int k = 0; k < dim; ++k) {
      const auto f = weight * (stress * map<dim>(cell.gradient[k]));
      map<dim>(force_[cell.node[k + 1]]) += f, map<dim>(force_[cell.node[0]]) -= f;
    }
  }
  return energy;
}

/// With A = S M^-1 K, which is symmetric in the energy x^T K x, the square root of energy(A x) / energy(x) lies between
/// the Rayleigh quotients of x and of A x and needs no product beside the energy.
template <int dim, int fields>
PetscErrorCode FastestMode<dim, fields>::find(FilledGrid<dim> &grid, const SoilState<dim> &state,
                                              const std::vector<std::unique_ptr<Body<dim>>> &bodies,
                                              const std::vector<PointSet> &points, int iterations, double *omega) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  if (elasticity_.empty()) {
    make_room(elasticity_, mesh_.cell_count());
    for (auto &mode : mode_)
      if (mode.empty()) make_room(mode, mesh_.node_count());  // else it comes from a checkpoint
    for (auto &mass : fluid_mass_) make_room(mass, mesh_.node_count());
    for (auto *field : {&wave_, &force_}) make_room(*field, static_cast<size_t>(fields) * mesh_.node_count());
  }
  measure_elasticity(grid, state, bodies, points);
  PetscCall(measure_fluid_mass(grid, state));
  PetscCall(start(grid));
  double scale = 1, last = 0;  // of this wave over A times the last one; energy of the last one
  for (int k = 0; k < iterations; ++k) {
    std::fill_n(force_.begin(), static_cast<size_t>(nodes) * fields, Vec<dim>{});
    double energy = elastic_force(grid, state);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPI_DOUBLE, MPI_SUM, mesh_.comm()));
    if (k > 0) {
      const double square = std::sqrt(energy / last) / scale;
      *omega = std::sqrt(square), scale = 1 / square;
    }
    last = energy;
    for (int f = 0; f < fields; ++f) {
      PetscCall(grid.sum(force_[f * nodes].data(), dim));
      for (int i = 0; i < nodes; ++i) {
        const double mass = f == 0 ? grid.mass[i] : fluid_mass_[f - 1][i];
        for (double &x : force_[f * nodes + i]) x *= grid.mass[i] > smallest_mass_ ? scale / mass : 0;
      }
    }
    PetscCall((to_particles_and_back<dim, fields>(grid, force_.data(), wave_.data())));
  }
  for (int f = 0; f < fields; ++f)
    for (int i = 0; i < nodes; ++i) mode_[f][grid.mesh_node[i]] = wave_[f * nodes + i];
  PetscFunctionReturn(0);
}

template <int dim, int fields>
void FastestMode<dim, fields>::serialize(Archive &archive) {
  std::vector<long long> nodes;  // that move
  std::vector<Vec<dim>> values[fields];
  for (size_t i = 0; i < mode_[0].size(); ++i) {
    if (std::all_of(mode_, mode_ + fields, [i](const auto &mode) { return mode[i] == Vec<dim>{}; })) continue;
    nodes.push_back(mesh_.global_node[i]);
    for (int f = 0; f < fields; ++f) values[f].push_back(mode_[f][i]);
  }
  const Archive::Rows rows = archive.rows("nodes of the fastest mode", Belongs::to_points, nodes);
  for (auto &field : values) archive.column(rows, "fastest mode", field);
  if (!archive.reading()) return;
  const LocalNumbers node_of(mesh_.global_node);
  for (int f = 0; f < fields; ++f) {
    mode_[f].assign(mesh_.node_count(), Vec<dim>{});
    for (size_t k = 0; k < nodes.size(); ++k) mode_[f][node_of(nodes[k])] = values[f][k];
  }
}

template class FastestMode<2, 1>;
template class FastestMode<2, 2>;
template class FastestMode<2, 3>;
template class FastestMode<3, 1>;
template class FastestMode<3, 2>;
template class FastestMode<3, 3>;

}  // namespace talus
