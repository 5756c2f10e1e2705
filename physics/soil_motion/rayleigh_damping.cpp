#include "physics/soil_motion/rayleigh_damping.h"

#include <algorithm>

#include "base/room.h"
#include "scene/body_source.h"

namespace talus {
namespace {

template <int dim>
bool any_damped(const std::vector<std::unique_ptr<Body<dim>>> &bodies) {
  return std::ranges::any_of(bodies, [](const auto &body) { return body->source().damping_ratio > 0; });
}

/// Cells that need room.
template <int dim>
int cells_of(const BackgroundMesh<dim> &mesh, const std::vector<std::unique_ptr<Body<dim>>> &bodies) {
  return any_damped(bodies) ? mesh.cell_count() : 0;
}

}  // namespace

template <int dim>
RayleighDamping<dim>::RayleighDamping(const BackgroundMesh<dim> &mesh,
                                      const std::vector<std::unique_ptr<Body<dim>>> &bodies)
    : rates_(cells_of(mesh, bodies)), mean_(cells_of(mesh, bodies)) {
  if (!any_damped(bodies)) return;
  for (const auto &body : bodies)
    ratio_.push_back(body->source().damping_ratio), history_count_.push_back(static_cast<int>(body->history_count()));
  of_body_.resize(bodies.size()), own_.resize(bodies.size()), stress_.resize(bodies.size());
  make_room(ahead_, mesh.cell_count()), make_room(cell_factor_, mesh.cell_count());
  make_room(force_, mesh.node_count()), make_room(mass_factor_, mesh.node_count());
}

template <int dim>
void RayleighDamping<dim>::set(const std::array<double, 2> &frequencies) {
  for (size_t b = 0; b < of_body_.size(); ++b) of_body_[b] = rayleigh(ratio_[b], frequencies);
}

template <int dim>
PetscErrorCode RayleighDamping<dim>::find_rates(FilledGrid<dim> &grid, const Vec<dim> *velocity,
                                                const SoilState<dim> &state, Locking locking, PatchMeans &patches,
                                                std::vector<double> &nodal) {
  PetscFunctionBeginUser;
  for (int c = 0; c < grid.cell_count(); ++c) {
    const Shape<dim> &shape = state.shape[c];
    const Vec<dim> &first = velocity[shape.node[0]];
    double g[dim][dim]{};
    for (int k = 0; k < dim; ++k)
      for (int d = 0; d < dim; ++d)
        for (int j = 0; j < dim; ++j) g[d][j] += (velocity[shape.node[k + 1]][d] - first[d]) * shape.gradient[k][j];
    auto &rate = rates_.increment[c].strain;
    rate[0] = g[0][0], rate[1] = g[1][1], rate[3] = (g[0][1] + g[1][0]) / 2;
    if constexpr (dim == 2)
      rate[2] = 0;
    else
      rate[2] = g[2][2], rate[4] = (g[1][2] + g[2][1]) / 2, rate[5] = (g[0][2] + g[2][0]) / 2;
    rates_.volume_strain[c] = rate[0] + rate[1] + rate[2];
  }
  PetscCall(rates_.smooth_volume_strain(locking, grid, state.weight.data(), state.shape, patches, nodal));
  PetscFunctionReturn(0);
}

template <int dim>
const Increment<dim> *RayleighDamping<dim>::strain_ahead(size_t body, int cells) {
  const double beta = of_body_[body].stiffness;
  for (int c = 0; c < cells; ++c) {
    Increment<dim> &increment = ahead_[c];
    increment = {};
    for (int d = 0; d < (dim == 2 ? 1 : 3); ++d) increment.rotation[4 * d] = 1;
    for (size_t s = 0; s < increment.strain.size(); ++s) increment.strain[s] = beta * rates_.increment[c].strain[s];
  }
  return ahead_.data();
}

template <int dim>
double *RayleighDamping<dim>::stress(size_t body, int points) {
  std::vector<double> &own = own_[body];
  own.resize(std::max(own.size(), static_cast<size_t>(points) * stress_size<dim>));
  return stress_[body] = own.data();
}

template <int dim>
double *RayleighDamping<dim>::history(size_t body, int points) {
  history_.resize(std::max(history_.size(), static_cast<size_t>(points) * history_count_[body]));
  return history_.data();
}

template <int dim>
void RayleighDamping<dim>::take_off(size_t body, const double *present, int points) {
  double *stress = stress_[body];
  for (int k = 0; k < points * stress_size<dim>; ++k) stress[k] = present ? stress[k] - present[k] : 0;
}

template <int dim>
void RayleighDamping<dim>::add_forces(const FilledGrid<dim> &grid, const std::vector<PointSet> &points,
                                      const SoilState<dim> &state, Locking locking, PatchMeans &patches,
                                      Vec<dim> *force) {
  mean_.find(grid, points, stress_, state, locking, patches);
  std::fill_n(force_.begin(), grid.node_count(), Vec<dim>{});
  for (int c = 0; c < grid.cell_count(); ++c) {
    const std::array<Vec<dim>, dim + 1> forces = mean_.forces(c, state);
    for (int k = 0; k <= dim; ++k) add_scaled<dim>(force_[state.shape[c].node[k]], 1, forces[k]);
  }
  for (int i = 0; i < grid.node_count(); ++i) add_scaled<dim>(force[i], 1, force_[i]);
}

template <int dim>
PetscErrorCode RayleighDamping<dim>::find_mass_factors(FilledGrid<dim> &grid, const std::vector<PointSet> &points,
                                                       const SoilState<dim> &state) {
  PetscFunctionBeginUser;
  const double alpha = of_body_[0].mass;
  const int nodes = grid.node_count();
  if (std::ranges::all_of(of_body_, [alpha](const Rayleigh &one) { return one.mass == alpha; })) {
    std::fill_n(mass_factor_.begin(), nodes, alpha);
    PetscFunctionReturn(0);
  }
  std::fill_n(cell_factor_.begin(), grid.cell_count(), 0.);
  std::fill_n(mass_factor_.begin(), nodes, 0.);
  for (size_t b = 0; b < points.size(); ++b)
    for (int q = 0; q < points[b].count; ++q) {
      const int c = points[b].cell[q];
      cell_factor_[c] += of_body_[b].mass * state.volume[b][q] / state.particle_volume[c];
    }
  for (int c = 0; c < grid.cell_count(); ++c) {
    const auto &matrix = grid.mass_matrix[c];
    const auto &node = state.shape[c].node;
    for (int k = 0, pair = dim + 1; k <= dim; ++k) {
      mass_factor_[node[k]] += cell_factor_[c] * matrix[k];
      for (int l = k + 1; l <= dim; ++l, ++pair)
        mass_factor_[node[k]] += cell_factor_[c] * matrix[pair],
            mass_factor_[node[l]] += cell_factor_[c] * matrix[pair];
    }
  }
  PetscCall(grid.sum(mass_factor_.data(), 1));
  for (int i = 0; i < nodes; ++i) mass_factor_[i] /= grid.mass[i];
  PetscFunctionReturn(0);
}

template class RayleighDamping<2>;
template class RayleighDamping<3>;

}  // namespace talus
