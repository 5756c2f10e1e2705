// Pressure that is implicit in time; theory of pores, section 8; included only where PoreFluid is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"

namespace talus {

/// Stiffness and pressure of the water in the cells, and the volumes of the nodes, at the start of a step. Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::start_implicit(const Frame &frame, ImplicitPressure<dim> &of) const {
  PetscFunctionBeginUser;
  const int nodes = frame.grid.node_count(), cells = frame.grid.cell_count();
  std::fill_n(of.sums.begin(), 2 * nodes, 0.);
  for (int c = 0; c < cells; ++c) {
    const CellPores &cell = cells_[c];
    const double pores = cell.mass[0] / (cell.density[0] * cell.saturation * frame.particle_volume[c]);
    of.modulus[c] = cell.density[0] / (liquid_.density_slope(cell.density[0]) * pores);
    of.unbounded[c] = cell.pressure[0] - of.modulus[c] * pores * (1 - cell.saturation);
    for (int i : frame.shape[c].node)
      of.sums[2 * i] += frame.weight[c] / (dim + 1), of.sums[2 * i + 1] += frame.particle_volume[c] / (dim + 1);
  }
  PetscCall(frame.grid.sum(of.sums.data(), 2));
  for (int i = 0; i < nodes; ++i) of.volume[i] = of.sums[2 * i], of.particle_volume[i] = of.sums[2 * i + 1];
  PetscFunctionReturn(0);
}

/// Mean pressure of the cells of a node once its strain `of.held` has squeezed their pores, into `pressure`, and its
/// slope, into `of.stiffness`; below cavitation it falls with a little of it. Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::find_squeezed(const Frame &frame, double *pressure,
                                                     ImplicitPressure<dim> &of) const {
  PetscFunctionBeginUser;
  constexpr double vapour = 1e3;  // [Pa]: stiffness of pores that cavitate
  const int nodes = frame.grid.node_count();
  std::fill_n(of.sums.begin(), 2 * nodes, 0.);
  for (int c = 0; c < frame.grid.cell_count(); ++c) {
    const double part = frame.weight[c] / (dim + 1);
    for (int i : frame.shape[c].node) {
      const double full = of.unbounded[c] - of.modulus[c] * of.held[i] - cavitation_pressure;
      const double slope = full > 0 ? of.modulus[c] : vapour;
      of.sums[2 * i] += part * full / of.modulus[c] * slope;
      of.sums[2 * i + 1] += part * slope;
    }
  }
  PetscCall(frame.grid.sum(of.sums.data(), 2));
  for (int i = 0; i < nodes; ++i) {
    pressure[i] = cavitation_pressure + of.sums[2 * i] / of.volume[i];
    of.stiffness[i] = of.sums[2 * i + 1] / of.volume[i];
  }
  PetscFunctionReturn(0);
}

/// What an impulse of the pressure moves at the nodes in a step with drag, and where boundaries hold the liquid.
template <int dim, class Phases>
void PoreFluid<dim, Phases>::find_mobility(const Frame &frame, const PoreConditions<dim> &conditions, double step,
                                           ImplicitPressure<dim> &of) const {
  for (int i = 0; i < frame.grid.node_count(); ++i) {
    const NodalFluid at = over_step(i, 0);
    const double mass = frame.grid.mass[i];
    of.solid[i] = of.apart[i] = of.supported[i] = of.porosity[i] = of.gap_solid[i] = of.gap_apart[i] = 0;
    if (!(mass > 0 && at.whole_mass > 0)) continue;
    const double share = at.mass / at.whole_mass;
    double solid = (1 - share) / mass, liquid = 1 / at.whole_mass;
    resolve_drag<1>(step, mass, solid, &at, &liquid);
    of.solid[i] = solid, of.apart[i] = liquid - solid, of.porosity[i] = share;
    of.supported[i] = 1 / (at.whole_mass * (1 + drag_number(step, at)));
    if (gap_[i] == Vec<dim>{}) continue;
    solid = share / mass, liquid = -1 / at.whole_mass;
    resolve_drag<1>(step, mass, solid, &at, &liquid);
    of.gap_solid[i] = solid, of.gap_apart[i] = liquid - solid;
  }
  of.gap = gap_.data(), of.gap_corners.clear();
  for (const auto &[i, c, k] : conditions.gap_cells()) of.gap_corners.push_back({i, c, reference_[c][k]});
  of.walls.clear();
  limits(frame, conditions, [&](int i, FlowLimits<dim> &all) {
    of.walls.push_back({i, {}});
    for (int k = 0; k < all.count; ++k)
      if (all.all[k].low == all.all[k].high) of.walls.back().along.add(all.all[k].n, 0);
  });
}

/// Adds to velocities [1 + fluids][nodes] what nodal pressures add to them in a step without drag. Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::push_by(const Frame &frame, double step, const double *pressure,
                                               ImplicitPressure<dim> &of, Vec<dim> *velocity) const {
  PetscFunctionBeginUser;
  const FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count();
  PetscCall(of.find_push(frame.grid, frame.shape, frame.weight, pressure));
  PetscCall(of.find_beyond_gaps(frame.grid, frame.shape, frame.weight, pressure));
  for (int i = 0; i < nodes; ++i) {
    if (!(grid.mass[i] > 0 && nodes_[i].whole(0) > 0)) continue;
    Vec<dim> on_liquid = of.push[i];
    add_scaled<dim>(on_liquid, -of.beyond_gap[i], gap_[i]);
    add_scaled<dim>(velocity[nodes + i], step / nodes_[i].whole(0), on_liquid);
    add_scaled<dim>(velocity[i], step / grid.mass[i], of.push[i]);
    add_scaled<dim>(velocity[i], -step / grid.mass[i] * nodes_[i].mass(0) / nodes_[i].whole(0), on_liquid);
  }
  PetscFunctionReturn(0);
}

/// Strain of the pores at the nodes over displacements u [1 + fluids][nodes], theory of pores (8.3). Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::find_pore_strain(const Frame &frame, const PoreConditions<dim> &conditions,
                                                        const Vec<dim> *u, ImplicitPressure<dim> &of) {
  PetscFunctionBeginUser;
  const int nodes = frame.grid.node_count();
  PetscCall(find_divergence(frame, conditions, u));
  std::fill_n(of.sums.begin(), 2 * nodes, 0.);
  for (int c = 0; c < frame.grid.cell_count(); ++c) {
    const Shape<dim> &shape = frame.shape[c];
    Square<dim> g = Square<dim>::Identity();
    for (int k = 0; k < dim; ++k)
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) g(i, j) += (u[shape.node[k + 1]][i] - u[shape.node[0]][i]) * shape.gradient[k][j];
    const double part = frame.weight[c] / (dim + 1), own = part * std::log(g.determinant()),
                 apart = part * divergence_[0][c] / cells_[c].density[0];
    for (int i : shape.node) of.sums[2 * i] += own, of.sums[2 * i + 1] += apart;
  }
  PetscCall(frame.grid.sum(of.sums.data(), 2));
  for (int i = 0; i < nodes; ++i)
    of.strain[i] = of.sums[2 * i] / of.volume[i] + of.sums[2 * i + 1] / of.particle_volume[i];
  PetscFunctionReturn(0);
}

}  // namespace talus
