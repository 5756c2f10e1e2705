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

/// Adds the particles, or those that are still missing, to the grid.
template <int dim, class Phases>
template <bool averaged>
void SoilMotion<dim, Phases>::gather() {
  for (size_t b = 0; b < bodies_.size(); ++b) {
    PointSet &points = points_[b];
    const ParticleArrays<dim> &p = bodies_[b]->particles();
    if (!averaged) points.own_cell.resize(std::max<size_t>(points.own_cell.size(), p.count));
    Pores<dim> pores;
    if constexpr (Phases::liquid) pores = fluid_.pores(b);
    to_nodes<dim, averaged, fluids>(*bodies_[b], grid_, velocities_.momentum.data(), points, pores,
                                    movers_ ? &(*movers_)[b] : nullptr);
    if (!averaged) points.count = p.count;
    if (averaged && reads_shares(bodies_[b]->law())) average_shares(b);
    refer_to_points(b);
  }
  accepted_.refer_to(grid_);
  movers_ = nullptr;
}

/// Lets the points of a body, and with them the accepted state, refer to where stress is: with averaged stress in
/// arrays of their own, otherwise in those of the particles.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::refer_to_points(size_t b) {
  PointSet &points = points_[b];
  const ParticleArrays<dim> &p = bodies_[b]->particles();
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

/// Shares of strength at the stress points of a body: means of those of the particles, weighted by volume.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::average_shares(size_t b) {
  PointSet &points = points_[b];
  const ParticleArrays<dim> &p = bodies_[b]->particles();
  std::fill_n(points.own_cohesion_share.begin(), points.count, 0.);
  std::fill_n(points.own_friction_share.begin(), points.count, 0.);
  for (int i = 0; i < p.count; ++i) {
    const int q = points.find(p.cell[i]);
    const double weight = p.volume[i] / points.own_volume[q];
    points.own_cohesion_share[q] += weight * p.cohesion_share[i];
    points.own_friction_share[q] += weight * p.friction_share[i];
  }
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::update_pore_pressures(double t) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) PetscCall(fluid_.update_pressures(pore_frame(t, accepted_)));
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::begin(double t) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) fluid_.prescribed = !loading.pore_flow, fluid_.prescribed_ramp = loading.ramp;
  if (gathered_) PetscFunctionReturn(0);
  if (!movers_) std::fill(velocities_.momentum.begin(), velocities_.momentum.end(), Vec<dim>{});
  with_transfer(transfer_, [&]<bool averaged>() { gather<averaged>(); });
  grid_.complete();
  PetscCall(finish_gather(t));
  velocities_.remap_time = t, velocities_.own_share = velocities_.kept;
  gathered_ = true, accepted_time_ = t, moved_ = 0, smallest_ratio_ = 1, step_ratio_ = 1;
  PetscFunctionReturn(0);
}

/// Nodal masses and velocities from the sums over particles, then all that depends on which cells hold soil.
/// Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::finish_gather(double t) {
  PetscFunctionBeginUser;
  constexpr int width = dim + 2;  // mass, momentum, volume
  const int nodes = grid_.node_count(), cells = grid_.cell_count();
  const double load_time = loading.time_at(t);
  std::vector<Vec<dim>> &start = velocities_.start, &now = velocities_.now;
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
    for (int d = 0; d < dim; ++d) nodal_[i * width + 1 + d] = velocities_.momentum[i][d];
  PetscCall(grid_.sum(nodal_.data(), width));
  for (int i = 0; i < nodes; ++i) {
    // A particle that round-off puts outside its cell gives a node a negative mass; no particle sees a node without
    // any.
    const double m = grid_.mass[i] = std::max(nodal_[i * width], smallest_mass_);
    for (int d = 0; d < dim; ++d) start[i][d] = nodal_[i * width + 1 + d] / m;
  }
  set_weights(nodal_);
  if (conditions_.has_dashpots()) measure_impedance();
  for (int c = 0; c < cells; ++c) filling_[c] = accepted_.weight[c] / grid_.shape[c].volume;
  PetscCall(conditions_.begin(grid_, impedance_, filling_));
  conditions_.surface_loads().begin(bodies_, grid_);
  PetscCall(meet_boundaries(load_time));
  std::copy_n(start.begin(), nodes, now.begin());
  if constexpr (Phases::liquid) {
    PetscCall(fluid_.gather(pore_frame(t, accepted_), pore_conditions_, filling_, start.data(), now.data() + nodes));
    std::copy_n(now.begin() + nodes, nodes * fluids, start.begin() + nodes);
    std::copy_n(now.begin(), nodes * fields, velocities_.before_step.begin());
    fluid_.constrain(pore_frame(t, accepted_), pore_conditions_, now.data(), now.data() + nodes);
  }
  PetscCall(velocities_.find_unmapped_start(
      nodes, [this](const Vec<dim> *in, Vec<dim> *out) { return to_particles_and_back(in, out); }));
  if constexpr (Phases::prescribed) PetscCall(water_.begin(grid_, load_time));
  for (size_t b = 0; b < bodies_.size(); ++b)
    if (nonlocal_[b]) PetscCall(nonlocal_[b]->begin(grid_, points_[b]));
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
    admit_stress<dim>(bodies_[b]->law(), {.count = p.count,
                                          .stress_in = p.stress,
                                          .history_in = history_seen_by_law(b),
                                          .stress_out = p.stress,
                                          .history_out = p.history,
                                          .cell = p.cell,
                                          .increment = increment_.data(),
                                          .size = softening_size(b),
                                          .suction = find_suction(b),
                                          .cohesion_share = p.cohesion_share,
                                          .friction_share = p.friction_share});
    if (nonlocal_[b]) nonlocal_[b]->restore(p, p.history);
  }
}

/// Suction at the stress points of a body at the start of the step under way, or null where its law reads none.
template <int dim, class Phases>
const double *SoilMotion<dim, Phases>::find_suction(size_t b) {
  if (!reads_suction(bodies_[b]->law())) return nullptr;
  if constexpr (Phases::prescribed)
    return water_.suction(grid_, blend_.data(), points_[b], loading.time, loading.ramp);
  else if constexpr (Phases::suction)
    return fluid_.suction(static_cast<int>(b));
  else
    return nullptr;  // the scene reader refuses such laws where there is no suction
}

/// Impedances rho c_p and rho c_s of the cells, means over their points weighted by volume.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::measure_impedance() {
  for (int c = 0; c < grid_.cell_count(); ++c) impedance_[c] = {0, 0};
  for (size_t b = 0; b < bodies_.size(); ++b) {
    const double wave = constrained_modulus(bodies_[b]->law()), shear = shear_modulus(bodies_[b]->law());
    for (int q = 0; q < points_[b].count; ++q) {
      const int c = points_[b].cell[q];
      double m = 0;
      for (int k = 0; k < simplex_pairs<dim>; ++k) m += (k <= dim ? 1 : 2) * grid_.mass_matrix[c][k];
      const double density = m / accepted_.particle_volume[c],
                   share = points_[b].volume[q] / accepted_.particle_volume[c];
      impedance_[c][0] += share * std::sqrt(density * wave), impedance_[c][1] += share * std::sqrt(density * shear);
    }
  }
}

/// Integration volume: the cell's own where its nodes are well filled, that of its particles at the surface, theory
/// (4.5).
template <int dim, class Phases>
void SoilMotion<dim, Phases>::set_weights(const std::vector<double> &nodal) {
  constexpr int width = dim + 2;
  constexpr double ramp_start = dim == 2 ? 0.7 : 0.6, ramp_length = 0.2, full = 0.9;
  for (int c = 0; c < grid_.cell_count(); ++c) {
    const auto &node = grid_.shape[c].node;
    double volume = 0, filling = 1e300;
    for (double share : grid_.nodal_share[c]) volume += share;
    for (int i : node) filling = std::min(filling, nodal[i * width + dim + 1] / mesh_.nodal_volume[grid_.mesh_node[i]]);
    double &blend = blend_[c];
    switch (transfer_.integration) {
      case Integration::blended:
        blend = std::clamp((filling - ramp_start) / ramp_length, 0., 1.);
        break;
      case Integration::mixed:
        blend = filling > 0.5 && volume > full * grid_.shape[c].volume;
        break;
      case Integration::cell:
        blend = filling > 0.5;
        break;
      case Integration::particle:
        blend = 0;
        break;
    }
    accepted_.particle_volume[c] = volume;
    accepted_.weight[c] = volume + blend * (grid_.shape[c].volume - volume);
    slenderness_[c] = 0;
    for (const auto &g : grid_.shape[c].gradient)
      for (double x : g) slenderness_[c] += x * x;
  }
}

/// Prepares what particles read of the nodes at the end t of a Lagrangian part; returns the share of their own velocity
/// that particles keep, theory (4.11).
template <int dim, class Phases>
double SoilMotion<dim, Phases>::prepare_update(double t) {
  const double share = velocities_.own_share_at(t);
  const std::vector<Vec<dim>> &now = velocities_.now, &start = velocities_.start;
  for (int i = 0; i < grid_.node_count(); ++i) {
    const Vec<dim> &v = now[i], &v0 = start[i], &x = grid_.position[i], &X = mesh_.position[grid_.mesh_node[i]];
    for (int d = 0; d < dim; ++d) {
      update_.velocity[i][d] = v[d] - share * v0[d];
      update_.displacement[i][d] = x[d] - X[d];
    }
  }
  const int nodes = grid_.node_count();
  if constexpr (Phases::liquid) fluid_.write_update(nodes, now.data() + nodes, start.data() + nodes, share, update_);
  return share;
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
  PetscCall(conditions_.surface_loads().end(grid_, accepted_.weight));
  const double share = prepare_update(t);
  with_transfer(transfer_, [&]<bool averaged>() {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      Pores<dim> pores;
      if constexpr (Phases::liquid) pores = fluid_.pores(b);
      to_particles<dim, averaged, fluids>(*bodies_[b], end_of_part(b, share, pores), movers[b]);
    }
  });
  clear_grid();
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::update_particles_and_gather(double t, std::vector<std::vector<int>> &movers) {
  PetscFunctionBeginUser;
  PetscCall(conditions_.surface_loads().end(grid_, accepted_.weight));
  const double share = prepare_update(t);
  std::fill(velocities_.momentum.begin(), velocities_.momentum.end(), Vec<dim>{});
  with_transfer(transfer_, [&]<bool averaged>() {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      Pores<dim> pores, next;
      if constexpr (Phases::liquid) pores = fluid_.pores(b), next = fluid_.next_pores(b);
      to_next_nodes<dim, averaged, fluids>(*bodies_[b], end_of_part(b, share, pores), next_grid_,
                                           velocities_.momentum.data(), next_points_[b], next, movers[b]);
    }
  });
  clear_grid();
  std::swap(grid_, next_grid_), std::swap(points_, next_points_);
  if constexpr (Phases::liquid) fluid_.swap_points();
  movers_ = &movers;
  PetscFunctionReturn(0);
}

}  // namespace talus
