// Forces on the mixture and accelerations of the fluids; theory of pores, (4.4), (4.5); included only where PoreFluid
// is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/pores/pore_fluid.h"

namespace talus {

template <int dim, class Phases>
void PoreFluid<dim, Phases>::add_to_mixture(const Frame &frame, const PoreConditions<dim> &conditions,
                                            Vec<dim> *force) const {
  const std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  for (int i = 0; i < frame.grid.node_count(); ++i)
    for (int d = 0; d < dim; ++d) {
      force[i][d] += at[i].push[mixture][d];
      for (int a = 0; a < fluids; ++a) force[i][d] += at[i].mass(a) * weight_factor(at[i], a) * frame.gravity[d];
    }
  conditions.pressures(frame.time, frame.grid, unit_weight(frame),
                       [&](int i, double, const Vec<dim> &, const Vec<dim> &load) {
                         for (int d = 0; d < dim; ++d) force[i][d] -= load[d];
                       });
}

/// Conductivity that the soil at a node has at the pressure prescribed beyond its face [m2/(Pa s)].
template <int dim, class Phases>
double PoreFluid<dim, Phases>::conductivity_beyond(int node, const NodePores &at, double pressure) const {
  double relative = 1;
  if constexpr (Phases::suction) {
    const SoilPores &soil = soils_[body_of_node_[node]];
    if (pressure < -soil.entry()) relative = soil.at(1 - talus::saturation(soil.retention(), -pressure)).liquid;
  }
  return at.conductivity(mixture) / at.volume() * relative;
}

template <int dim, class Phases>
PetscErrorCode PoreFluid<dim, Phases>::find_accelerations(const Frame &frame, const PoreConditions<dim> &conditions,
                                                          Vec<dim> *force, Vec<dim> *acceleration,
                                                          const Vec<dim> *velocity) {
  PetscFunctionBeginUser;
  const std::vector<NodePores> &at = frame.trial ? trial_nodes_ : nodes_;
  const int nodes = frame.grid.node_count();
  std::fill_n(beyond_.begin(), nodes, 0.);
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i) {
      const double whole = at[i].whole(a), scale = whole > 0 ? 1 / whole : 0;
      for (int d = 0; d < dim; ++d)
        acceleration[a * nodes + i][d] =
            whole > 0 ? at[i].push[a][d] * scale + weight_factor(at[i], a) * frame.gravity[d] : 0;
    }
  // a gap between particles: the pressure beyond it is that of the neighbouring cells, extrapolated to the node with
  // the weight of the fluid
  const std::vector<CellPores> &pores = frame.trial ? trial_cells_ : cells_;
  std::fill_n(nodal_.begin(), nodes * fluids, 0.);
  for (const auto &[i, c, k] : conditions.gap_cells()) {
    const Vec<dim> x = place(frame, c, reference_[c]);
    const double part = frame.weight[c] * reference_[c][k];
    double rise = 0;
    for (int d = 0; d < dim; ++d) rise += frame.gravity[d] * (frame.position[i][d] - x[d]);
    nodal_[i * fluids] += part * (pores[c].smooth[0] + liquid_.density * rise);
    if constexpr (Phases::gas) nodal_[i * fluids + 1] += part * (pores[c].smooth[1] + gas_.density * rise);
  }
  PetscCall(frame.grid.sum(nodal_.data(), fluids));
  conditions.gaps(
      frame.grid, [&](int i) { return surface_at(at[i]); },
      [&](int i, const Vec<dim> &area) {
        for (int a = 0; a < fluids; ++a)
          for (int d = 0; d < dim && at[i].whole(a) > 0; ++d)
            acceleration[a * nodes + i][d] -= nodal_[i * fluids + a] / at[i].volume() * area[d] / at[i].whole(a);
      });
  conditions.pressures(frame.time, frame.grid, unit_weight(frame),
                       [&](int i, double p, const Vec<dim> &push, const Vec<dim> &) {
                         for (int d = 0; d < dim; ++d) acceleration[i][d] -= push[d] / at[i].whole(0);
                         beyond_[i] = conductivity_beyond(i, at[i], p);
                       });
  if constexpr (Phases::gas)
    conditions.gas_pressures(frame.time, frame.grid, [&](int i, double p, const Vec<dim> &area) {
      for (int d = 0; d < dim; ++d) acceleration[nodes + i][d] -= p * area[d] / at[i].whole(1);
    });
  for (int i = 0; i < nodes && explicit_drag_ && !prescribed; ++i)
    for (int a = 0; a < fluids; ++a) {
      const double rate = drag_number(1, at_node(i, a));
      for (int d = 0; d < dim; ++d)
        acceleration[a * nodes + i][d] -= rate * (velocity[(1 + a) * nodes + i][d] - velocity[i][d]);
    }
  for (int a = 0; a < fluids; ++a)
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) force[i][d] -= at[i].mass(a) * acceleration[a * nodes + i][d];
  PetscFunctionReturn(0);
}

}  // namespace talus
