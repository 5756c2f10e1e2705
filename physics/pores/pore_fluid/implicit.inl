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
    const double content = Phases::suction ? cell.density[0] * cell.saturation : cell.density[0];
    of.modulus[c] = cell.density[0] / (liquid_.density_slope(content) * pores);
    of.unbounded[c] = Phases::suction ? liquid_.pressure_at(content)
                                      : cell.pressure[0] - of.modulus[c] * pores * (1 - cell.saturation);
    if (Phases::suction) {
      of.open.open[c] = !smoothed(c), of.open.own_volume[c] = frame.particle_volume[c];
      of.open.beyond[c] = volume_beyond_particles(frame, c), of.open.saturation[c] = cell.saturation;
    }
    if (!smoothed(c)) continue;
    for (int i : frame.shape[c].node)
      nodal_[2 * i] += frame.weight[c] / (dim + 1), nodal_[2 * i + 1] += frame.particle_volume[c] / (dim + 1);
  }
  PetscCall(frame.grid.sum(nodal_.data(), 2));
  for (int i = 0; i < nodes; ++i) of.volume[i] = nodal_[2 * i], of.particle_volume[i] = nodal_[2 * i + 1];
  if constexpr (Phases::suction) start_drying(frame, of);
  find_gaps(frame, conditions);
  find_mobility(frame, conditions, step, of);
  PetscFunctionReturn(0);
}

/// How the pores of cells dry, and the volumes of open cells.
template <int dim, class Phases>
void PoreFluid<dim, Phases>::start_drying(const Frame &frame, ImplicitPressure<dim> &of) requires Phases::suction {
  const int nodes = frame.grid.node_count();
  of.liquid = &liquid_, of.bishop = bishop_;
  for (size_t b = 0; b < bodies_.size(); ++b)
    for (int q = 0; q < frame.points[b].count; ++q) of.drying[frame.points[b].cell[q]].soil = &soils_[b];
  for (int c = 0; c < frame.grid.cell_count(); ++c) {
    of.drying[c].begin(liquid_, of.unbounded[c], cells_[c].pressure[0], 1 - cells_[c].saturation);
    of.volume[nodes + c] = of.particle_volume[nodes + c] = of.open.open[c] ? frame.particle_volume[c] : 0;
  }
}

/// What an impulse of the pressure moves at the nodes in a step with drag.
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
    if (!Phases::suction && gap_[i] == Vec<dim>{}) continue;
    solid = share / mass, liquid = -1 / at.whole_mass;
    resolve_drag<1>(step, mass, solid, &at, &liquid);
    of.gap_solid[i] = solid, of.gap_apart[i] = liquid - solid;
  }
  of.gap = gap_.data(), of.gap_corners.clear();
  for (const auto &[i, c, k] : conditions.gap_cells()) of.gap_corners.push_back({i, c, reference_[c][k]});
}

/// Where boundaries hold the liquid that would move with `fluid` before drag: limits of one side count where it is
/// beyond them.
template <int dim, class Phases>
void PoreFluid<dim, Phases>::find_walls(const Frame &frame, const PoreConditions<dim> &conditions, double step,
                                        const Vec<dim> *solid, const Vec<dim> *fluid, ImplicitPressure<dim> &of) const {
  of.walls.clear();
  limits(frame, conditions, [&](int i, FlowLimits<dim> &all) {
    const NodalFluid at = over_step(i, 0);
    Vec<dim> against;
    for (int d = 0; d < dim; ++d) against[d] = (fluid[i][d] - solid[i][d]) / (1 + drag_number(step, at));
    hold_within<dim>(all, against);
    of.walls.push_back({i, at.mass / (frame.grid.mass[i] + at.mass), {}});
    for (int k = 0; k < all.count; ++k)
      if (all.all[k].low == all.all[k].high || all.all[k].taken != 0) of.walls.back().along.add(all.all[k].n, 0);
  });
}

/// Adds to velocities [1 + fluids][nodes] what the change of the pressures adds to them in a step without drag.
/// Collective.
template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::push_by_change(const StepStart<dim> &at, ImplicitPressure<dim> &of,
                                                      Vec<dim> *velocity) const {
  PetscFunctionBeginUser;
  const FilledGrid<dim> &grid = at.grid;
  const double step = at.step;
  const int nodes = grid.node_count();
  PetscCall(of.find_push(at, of.change.data(), of.mixture_change.data()));
  for (int i = 0; i < nodes; ++i) {
    if (!(grid.mass[i] > 0 && nodes_[i].whole(0) > 0)) continue;
    Vec<dim> push, on_liquid;
    talus::store<dim>(push.data(), of.on_mixture(i));
    talus::store<dim>(on_liquid.data(), of.push[i]);
    add_scaled<dim>(on_liquid, -of.push[i][of.at_gap], gap_[i]);
    add_scaled<dim>(velocity[nodes + i], step / nodes_[i].whole(0), on_liquid);
    add_scaled<dim>(velocity[i], step / grid.mass[i], push);
    add_scaled<dim>(velocity[i], -step / grid.mass[i] * nodes_[i].mass(0) / nodes_[i].whole(0), on_liquid);
  }
  PetscFunctionReturn(0);
}

}  // namespace talus
