// Particles to nodes and back: theory, section 4; included only where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"
#include "scene/transfer_source.h"

namespace talus {

/// Calls f<averaged>() as the scene's transfer asks for.
template <class F>
void with_transfer(const Transfer &transfer, F &&f) {
  transfer.average_stress ? f.template operator()<true>() : f.template operator()<false>();
}

/// Lets the points of a body, and with them the accepted state, refer to where stress is: with averaged stress in
/// arrays of their own, otherwise in those of the particles.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::refer_to_points(size_t b) {
  PointSet &points = points_[b];
  ParticleArrays<dim> &p = bodies_[b]->particles();
  const bool own = transfer_.average_stress;
  points.cell = points.own_cell.data();
  points.stress = own ? points.own_stress.data() : p.stress,
  points.history = own ? points.own_history.data() : p.history;
  points.volume = own ? points.own_volume.data() : p.volume,
  points.limit = own ? points.own_limit.data() : p.rest_volume;
  if (p.cohesion_share) {
    points.cohesion_share = own ? points.own_cohesion_share.data() : p.cohesion_share;
    points.friction_share = own ? points.own_friction_share.data() : p.friction_share;
  }
  accepted_.refer_to(points, b);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::update_pore_pressures(double t) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) PetscCall(fluid_.update_pressures(pore_frame(t, accepted_)));
  PetscFunctionReturn(0);
}

/// Gathers the particles, or those that the last remap has not gathered yet: the nodes get their mass and velocity.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::begin(double t) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) fluid_.prescribed = !loading.pore_flow, fluid_.prescribed_ramp = loading.ramp;
  if (gathered_) PetscFunctionReturn(0);
  if (!remap_.missing) std::fill(remap_.momentum.begin(), remap_.momentum.end(), Vec<dim>{});
  with_transfer(transfer_, [&]<bool averaged>() {
    for (size_t b = 0; b < bodies_.size(); ++b)
      to_nodes<dim, averaged, fluids>(*bodies_[b], grid_, remap_.momentum.data(), points_[b], pores_of(b),
                                      remap_.missing_of(b));
  });
  remap_.missing = nullptr;
  for (size_t b = 0; b < bodies_.size(); ++b) refer_to_points(b);
  accepted_.refer_to(grid_);
  grid_.complete();
  PetscCall(sum_particles());
  for (int i = 0; i < grid_.node_count(); ++i) {
    // A particle that round-off puts outside its cell gives a node a negative mass; no particle sees a node without
    // any.
    const double *sums = &nodal_[i * nodal_sums], m = grid_.mass[i] = std::max(sums[0], smallest_mass_);
    for (int d = 0; d < dim; ++d) velocities_.start[i][d] = sums[1 + d] / m;
  }
  PetscCall(start_part(t));
  velocities_.remap_time = t, velocities_.own_share = velocities_.kept;
  gathered_ = true, accepted_time_ = t;
  measures_.begin_part();
  PetscFunctionReturn(0);
}

/// Mass, momentum and volume of the particles at the nodes, of all ranks, into `nodal_`. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::sum_particles() {
  PetscFunctionBeginUser;
  constexpr int width = nodal_sums;
  const int nodes = grid_.node_count(), cells = grid_.cell_count();
  std::fill_n(nodal_.begin(), nodes * width, 0.);
  for (int c = 0; c < cells; ++c) {
    const auto &matrix = grid_.mass_matrix[c];
    const auto &node = grid_.shape[c].node;
    for (int k = 0, pair = dim + 1; k <= dim; ++k) {
      nodal_[node[k] * width] += matrix[k];
      for (int l = k + 1; l <= dim; ++l, ++pair)
        nodal_[node[k] * width] += matrix[pair], nodal_[node[l] * width] += matrix[pair];
      nodal_[node[k] * width + dim + 1] += grid_.nodal_share[c][k];
    }
  }
  for (int i = 0; i < nodes; ++i)
    for (int d = 0; d < dim; ++d) nodal_[i * width + 1 + d] = remap_.momentum[i][d];
  PetscCall(grid_.sum(nodal_.data(), width));
  PetscFunctionReturn(0);
}

/// All that depends on which cells hold soil: how they are filled, what boundaries and pore fluids make of the
/// velocities at the start, and the averages of stress. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::start_part(double t) {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count();
  const double load_time = loading.time_at(t);
  std::vector<Vec<dim>> &start = velocities_.start, &now = velocities_.now;
  SoilContact<dim> *contact = conditions_.soil_contact();
  if (contact) PetscCall(contact->search(grid_, smallest_mass_, &nodal_[dim + 1], nodal_sums));
  filling_.find(grid_, transfer_.integration, &nodal_[dim + 1], nodal_sums, accepted_);
  if (conditions_.has_dashpots()) filling_.measure_impedance(grid_, bodies_, points_, accepted_);
  PetscCall(conditions_.begin(grid_, filling_.impedance, filling_.share));
  conditions_.surface_loads().begin(bodies_, grid_);
  PetscCall(meet_boundaries(load_time));
  if (contact) contact->meet(grid_, start.data());
  std::copy_n(start.begin(), nodes, now.begin());
  if constexpr (Phases::liquid) {
    if (implicit_.acts) implicit_.begin_part(grid_);
    PetscCall(
        fluid_.gather(pore_frame(t, accepted_), pore_conditions_, filling_.share, start.data(), now.data() + nodes));
    std::copy_n(now.begin() + nodes, nodes * fluids, start.begin() + nodes);
    std::copy_n(now.begin(), nodes * fields, velocities_.before_step.begin());
    fluid_.constrain(pore_frame(t, accepted_), pore_conditions_, now.data(), now.data() + nodes);
  }
  PetscCall(velocities_.find_unmapped_start(
      nodes, [this](const Vec<dim> *in, Vec<dim> *out) { return to_particles_and_back(in, out); }));
  if constexpr (Phases::prescribed) PetscCall(water_.begin(grid_, load_time));
  PetscCall(softening_.begin(grid_, points_));
  if (transfer_.average_stress) admit_mean_stress();
  PetscFunctionReturn(0);
}

/// Imposes the velocities of boundaries, and leaves nodes of a base the velocity at which soil meets it, docs/theory
/// (4.2a): it is taken in the first step, as an impulse like any other. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::meet_boundaries(double load_time) {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count();
  std::vector<Vec<dim>> &start = velocities_.start, &met = velocities_.moving, &left = scratch_;
  const bool bases = !conditions_.bases().none();
  if (bases) PetscCall((talus::to_particles_and_back<dim, 1>(grid_, start.data(), met.data())));
  for (int i = 0; bases && i < nodes; ++i)
    for (int d = 0; d < dim; ++d) left[i][d] = met[i][d] = 2 * start[i][d] - met[i][d];
  conditions_.constrain(load_time, grid_, start.data(), false);
  if (bases) conditions_.leave_base(left.data());
  for (int i = 0; bases && i < nodes; ++i)
    for (int d = 0; d < dim; ++d) start[i][d] += met[i][d] - left[i][d];
  PetscFunctionReturn(0);
}

/// Returns mean stresses to the yield surface, theory section 4.3. Where strength is uniform the mean of admissible
/// stresses is admissible.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::admit_mean_stress() {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    if (!strength_varies(bodies_[b]->law())) continue;
    const PointSet &p = points_[b];
    admit_stress<dim>(bodies_[b]->law(), stress_points(b, p.stress, p.history));
  }
}

/// Suction at the stress points of a body at the start of the step under way, or null where its law reads none.
template <int dim, class Phases>
const double *SoilMotion<dim, Phases>::find_suction(size_t b) {
  if (!reads_suction(bodies_[b]->law())) return nullptr;
  if constexpr (Phases::prescribed)
    return water_.suction(grid_, filling_.blend.data(), points_[b], loading.time, loading.ramp);
  else if constexpr (Phases::suction)
    return fluid_.suction(static_cast<int>(b));
  else
    return nullptr;  // the scene reader refuses such laws where there is no suction
}

/// Prepares what particles read of the nodes at the end t of a Lagrangian part.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::end_part(double t) {
  PetscFunctionBeginUser;
  PetscCall(conditions_.surface_loads().end(grid_, accepted_.weight));
  remap_.read_nodes(t, grid_, velocities_);
  const int nodes = grid_.node_count();
  if constexpr (Phases::liquid)
    fluid_.write_update(nodes, velocities_.now.data() + nodes, velocities_.start.data() + nodes, remap_.own_share,
                        remap_.nodal);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
void SoilMotion<dim, Phases>::clear_grid() {
  for (PointSet &points : points_) {
    for (int c = 0; c < grid_.cell_count(); ++c) points.leave(grid_.mesh_cell[c]);
    points.count = 0;
  }
  grid_.clear();
  gathered_ = false;
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::update_particles(double t, std::vector<std::vector<int>> &movers) {
  PetscFunctionBeginUser;
  PetscCall(end_part(t));
  with_transfer(transfer_, [&]<bool averaged>() {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      const Pores<dim> pores = pores_of(b);
      to_particles<dim, averaged, fluids>(*bodies_[b], remap_.end_of(grid_, points_[b], pores), movers[b]);
    }
  });
  clear_grid();
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::update_particles_and_gather(double t, std::vector<std::vector<int>> &movers) {
  PetscFunctionBeginUser;
  PetscCall(end_part(t));
  std::fill(remap_.momentum.begin(), remap_.momentum.end(), Vec<dim>{});
  with_transfer(transfer_, [&]<bool averaged>() {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      const Pores<dim> pores = pores_of(b), next = next_pores_of(b);
      to_next_nodes<dim, averaged, fluids>(*bodies_[b], remap_.end_of(grid_, points_[b], pores), remap_.grid,
                                           remap_.momentum.data(), remap_.points[b], next, movers[b]);
    }
  });
  clear_grid();
  std::swap(grid_, remap_.grid), std::swap(points_, remap_.points);
  if constexpr (Phases::liquid) fluid_.swap_points();
  remap_.missing = &movers;
  PetscFunctionReturn(0);
}

}  // namespace talus
