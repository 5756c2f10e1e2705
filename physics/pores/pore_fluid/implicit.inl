// Pressure that is implicit in time; theory of pores, section 8; included only where PoreFluid is instantiated.
#include <algorithm>

#include "physics/pores/pore_fluid.h"

namespace talus {

/// Stiffness and pressure of the water in the cells, and volumes and mobilities of the nodes, at the start of a step.
/// Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::start_implicit(const Frame &frame, const PoreConditions<dim> &conditions,
                                                      double step, ImplicitPressure<dim> &of) {
  PetscFunctionBeginUser;
  const int nodes = frame.grid.node_count(), cells = frame.grid.cell_count();
  std::fill_n(nodal_.begin(), 2 * nodes, 0.);
  for (int c = 0; c < cells; ++c) {
    const CellPores &cell = cells_[c];
    const double pores = cell.mass[0] / (cell.density[0] * cell.saturation * frame.particle_volume[c]);
    of.modulus[c] = cell.density[0] / (liquid_.density_slope(cell.density[0]) * pores);
    of.unbounded[c] = cell.pressure[0] - of.modulus[c] * pores * (1 - cell.saturation);
    for (int i : frame.shape[c].node)
      nodal_[2 * i] += frame.weight[c] / (dim + 1), nodal_[2 * i + 1] += frame.particle_volume[c] / (dim + 1);
  }
  PetscCall(frame.grid.sum(nodal_.data(), 2));
  for (int i = 0; i < nodes; ++i) of.volume[i] = nodal_[2 * i], of.particle_volume[i] = nodal_[2 * i + 1];
  find_gaps(frame, conditions);
  find_mobility(frame, conditions, step, of);
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

/// Adds to velocities [1 + fluids][nodes] what the change of the pressures adds to them in a step without drag.
/// Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::push_by_change(const Frame &frame, double step, ImplicitPressure<dim> &of,
                                                      Vec<dim> *velocity) const {
  PetscFunctionBeginUser;
  const FilledGrid<dim> &grid = frame.grid;
  const int nodes = grid.node_count();
  PetscCall(of.find_push(frame.grid, of.change.data()));
  for (int i = 0; i < nodes; ++i) {
    if (!(grid.mass[i] > 0 && nodes_[i].whole(0) > 0)) continue;
    Vec<dim> push, on_liquid;
    talus::store<dim>(push.data(), of.push[i]);
    on_liquid = push;
    add_scaled<dim>(on_liquid, -of.push[i][of.at_gap], gap_[i]);
    add_scaled<dim>(velocity[nodes + i], step / nodes_[i].whole(0), on_liquid);
    add_scaled<dim>(velocity[i], step / grid.mass[i], push);
    add_scaled<dim>(velocity[i], -step / grid.mass[i] * nodes_[i].mass(0) / nodes_[i].whole(0), on_liquid);
  }
  PetscFunctionReturn(0);
}

}  // namespace talus
