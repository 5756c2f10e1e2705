// Fluids between particles and nodes; theory of pores, section 4; included only where PoreFluid is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"
#include "scene/scene.h"

namespace talus {

template <int dim, class Phases>
Pores<dim> PoreFluid<dim, Phases>::pores_of(std::vector<PorePoints> &points, int b) {
  Pores<dim> pores{points[b].grains.data(), {}, {}, 1 / bodies_[b]->grain_density()};
  for (int a = 0; a < fluids; ++a) pores.mass[a] = points[b].mass[a].data(), pores.impulse[a] = impulse_[a].data();
  return pores;
}

/// First moment of the free surface, theory (5.2). Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::find_moment(const Frame &frame) {
  PetscFunctionBeginUser;
  const FilledGrid<dim> &grid = frame.grid;
  const int vertical = scene_.vertical();
  std::fill_n(moment_.begin(), grid.node_count(), Vec<dim>{});
  for (int c = 0; c < grid.cell_count(); ++c) {
    const double elevation = place(frame, c, reference_[c])[vertical];
    Vec<dim> first{};
    for (int k = dim; k >= 0; --k) {
      const int i = grid.shape[c].node[k];
      for (int d = 0; d < dim; ++d) {
        const double g = k ? grid.shape[c].gradient[k - 1][d] : first[d];
        first[d] -= g;
        moment_[i][d] += frame.weight[c] * g * (frame.position[i][vertical] - elevation);
      }
      moment_[i][vertical] -= frame.weight[c] * reference_[c][k];
    }
  }
  PetscCall(frame.grid.sum(moment_[0].data(), dim));
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::gather(const Frame &frame, PoreConditions<dim> &conditions, const Array &filling,
                                              const Vec<dim> *solid, Vec<dim> *velocity) {
  PetscFunctionBeginUser;
  FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count(), cells = grid.cell_count();
  Array *const mass = smooth_;  // of the fluids in a cell [kg], in an array that smoothing uses later
  for (int a = 0; a < fluids; ++a) std::fill_n(mass[a].begin(), cells, 0.);
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    const PointSet &set = frame.points[b];
    PorePoints &points = points_[b];
    points.count = set.count;
    if (!frame.averaged) {  // particles are the points
      const double over_density = 1 / bodies_[b]->grain_density();
      points.reserve(set.count);
      for (int i = 0; i < p.count; ++i) {
        points.grains[i] = p.mass[i] * over_density;
        for (int a = 0; a < fluids; ++a) points.mass[a][i] = p.fluid_mass[a][i];
      }
    }
    for (int q = 0; q < set.count; ++q) {
      const int c = set.cell[q];
      for (int a = 0; a < fluids; ++a) mass[a][c] += points.mass[a][q];
      if constexpr (Phases::suction) {
        points.share[q] =
            std::clamp(1 - points.mass[0][q] / (liquid_.density * (frame.volume[b][q] - points.grains[q])), 0.,
                       1.);  // where Newton starts
        for (int node : grid.shape[c].node) body_of_node_[node] = static_cast<int>(b);
      }
    }
  }
  // velocities of the fluids at nodes: within a cell a fluid is spread as the grains are
  std::fill_n(momentum_.begin(), nodes, std::array<Quad, fluids>{});
  for (int c = 0; c < cells; ++c) {
    const auto &matrix = grid.mass_matrix[c];
    auto &rows = rows_[c];
    for (int k = 0; k <= dim; ++k) rows[k] = matrix[k];
    for (int k = 0, pair = dim + 1; k <= dim; ++k)
      for (int l = k + 1; l <= dim; ++l, ++pair) rows[k] += matrix[pair], rows[l] += matrix[pair];
    grain_mass_[c] = 0;
    const double scale = 1 / frame.particle_volume[c];
    for (int k = 0; k <= dim; ++k) {
      grain_mass_[c] += rows[k];
      mean_[c][k] = grid.nodal_share[c][k] * scale;
      reference_[c][k] = mean_[c][k] + frame.blend[c] * (1. / (dim + 1) - mean_[c][k]);
    }
    const Quad row = load<dim + 1>(rows.data());
    for (int a = 0; a < fluids; ++a) {
      const double ratio = mass[a][c] / grain_mass_[c];
      Quad part[4]{};  // by component, then by vertex
#pragma GCC unroll 8
      for (int d = 0; d < dim; ++d) part[d] = impulse_[a][c][d];
      part[last] = row;
      transpose(part);
#pragma GCC unroll 8
      for (int k = 0; k <= dim; ++k) momentum_[grid.shape[c].node[k]][a] += quad(ratio) * part[k];
    }
  }
  PetscCall(grid.sum(reinterpret_cast<double *>(momentum_.data()), 4 * fluids));
  for (int i = 0; i < nodes; ++i)
    for (int a = 0; a < fluids; ++a) {
      const Quad &momentum = momentum_[i][a];
      for (int d = 0; d < dim; ++d)
        velocity[a * nodes + i][d] = momentum[last] > 0 ? momentum[d] / momentum[last] : solid[i][d];
    }
  PetscCall(update_pressures(frame));
  for (int i = 0; i < nodes; ++i) talus::store<dim>(surface_[i].data(), nodes_[i].geometry);
  if (conditions.open_water()) PetscCall(find_moment(frame));
  PetscCall(conditions.begin(grid, filling, surface_, moment_));
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
void PoreFluid<dim, Phases>::write_update(int nodes, const Vec<dim> *velocity, const Vec<dim> *start, double flip,
                                          NodalUpdate &update) const {
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i) {
      const int n = a * nodes + i;
      update.fluid[a][i] = load<dim>(velocity[n].data()) - quad(flip) * load<dim>(start[n].data());
    }
}

}  // namespace talus
