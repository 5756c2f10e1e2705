// Velocities between acceleration and motion: supports, drag, what particles map back; theory (4.9) and section 6;
// included only where SoilMotion is instantiated.
#include <algorithm>
#include <cmath>

#include "physics/soil_motion.h"

namespace talus {

/// What fluids in the pores add to contact in a step gamma that ends at t; what is captured fits into a std::function
/// without memory of its own.
template <int dim, class Phases>
typename Conditions<dim>::Pores SoilMotion<dim, Phases>::contact(double t, double gamma) {
  if constexpr (Phases::liquid)
    return {[this, gamma](int i) { return fluid_.inertia(gamma, grid_, pore_conditions_, i); },
            [this, t](int i, const Vec<dim> &n) { return fluid_.thrust(pore_frame(t, accepted_).gravity, i, n); }};
  return {};
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::apply_boundaries_and_drag(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v);
  if constexpr (Phases::liquid) {
    if (implicit_.acts && !fluid_.prescribed) PetscCall(add_implicit_pressure(t, gamma, velocity));
    fluid_.apply_drag_to_solid(gamma, pore_frame(t, accepted_), pore_conditions_, velocity,
                               velocity + grid_.node_count());
  }
  conditions_.move_ground(loading.ground_velocity_at(t));
  PetscCall(conditions_.resolve(loading.time_at(t), gamma, grid_, velocity, contact(t, gamma)));
  if constexpr (Phases::liquid)
    fluid_.apply_drag_to_fluids(gamma, pore_frame(t, accepted_), pore_conditions_, velocity,
                                velocity + grid_.node_count());
  PetscFunctionReturn(0);
}

/// Fluids follow the skeleton where supports fix it; the velocity of the skeleton stays free, as in the rates.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::apply_drag(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid) {
    const int nodes = grid_.node_count();
    Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v), *supported = scratch_.data();
    fluid_.apply_drag_to_solid(gamma, pore_frame(t, accepted_), pore_conditions_, velocity, velocity + nodes);
    std::copy_n(velocity, nodes, supported);
    conditions_.constrain(loading.time_at(t), grid_, supported, true);
    fluid_.apply_drag_to_fluids(gamma, pore_frame(t, accepted_), pore_conditions_, supported, velocity + nodes);
  }
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::apply_boundaries(double t, double gamma, double *v) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v);
  conditions_.move_ground(loading.ground_velocity_at(t));
  PetscCall(conditions_.resolve(loading.time_at(t), gamma, grid_, velocity, contact(t, gamma)));
  if constexpr (Phases::liquid)
    fluid_.constrain(pore_frame(t, accepted_), pore_conditions_, velocity, velocity + grid_.node_count());
  PetscFunctionReturn(0);
}

/// Imposes on velocities of all phases what boundaries prescribe at time t.
template <int dim, class Phases>
void SoilMotion<dim, Phases>::constrain(double t, Vec<dim> *v) {
  conditions_.constrain(loading.time_at(t), grid_, v, true);
  if constexpr (Phases::liquid) fluid_.constrain(pore_frame(t, accepted_), pore_conditions_, v, v + grid_.node_count());
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::to_particles_and_back(const Vec<dim> *in, Vec<dim> *out) {
  PetscFunctionBeginUser;
  if constexpr (Phases::liquid)
    if (implicit_.acts) {
      PetscCall(implicit_.to_particles_and_back(grid_, in, out));
      PetscFunctionReturn(0);
    }
  PetscCall((talus::to_particles_and_back<dim, fields - Phases::gas>(grid_, in, out)));
  if constexpr (Phases::gas) PetscCall(fluid_.gas_to_particles_and_back(grid_, in, out));
  PetscFunctionReturn(0);
}

/// What particles make of the change of the velocities in a step, [field][node], with what nodes keep. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::map_change(double gamma, const Vec<dim> *velocity,
                                                   Vec<dim> *mapped) requires Phases::liquid {
  PetscFunctionBeginUser;
  const int all = grid_.node_count() * fields;
  const std::vector<Vec<dim>> &before = velocities_.before_step;
  const double share = velocities_.relaxes ? velocities_.relaxed_in(gamma) : 0;
  for (int i = 0; i < all; ++i)
    for (int d = 0; d < dim; ++d) scratch_[i][d] = velocity[i][d] - (1 - share) * before[i][d];
  PetscCall(to_particles_and_back(scratch_.data(), mapped));
  for (int i = 0; i < all; ++i)
    for (int d = 0; d < dim; ++d) mapped[i][d] += (1 - share) * before[i][d];
  conditions_.keep_dashpots(velocity, mapped);
  PetscFunctionReturn(0);
}

template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::map_back(double t, double gamma, double *v, double *w) {
  PetscFunctionBeginUser;
  Vec<dim> *velocity = reinterpret_cast<Vec<dim> *>(v), *mapped = reinterpret_cast<Vec<dim> *>(w);
  const int nodes = grid_.node_count();
  const std::vector<Vec<dim>> &start = velocities_.start;
  if constexpr (Phases::liquid) {
    // drag and walls act on what particles would map back, as after a remap: that becomes the velocity of the nodes
    const int all = nodes * fields;
    PetscCall(map_change(gamma, velocity, mapped));
    constrain(t, mapped);
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) {
        velocities_.start[i][d] += mapped[i][d] - velocity[i][d];  // particles take the change that is not mapped
        velocity[i][d] = velocities_.before_step[i][d] = mapped[i][d];
      }
    PetscFunctionReturn(0);
  }
  if (velocities_.relaxes) {
    PetscCall(to_particles_and_back(velocity, mapped));
    conditions_.keep_dashpots(velocity, mapped);
    const double share = velocities_.relaxed_in(gamma), own = velocities_.own_share_at(t);
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) {
        velocity[i][d] += share * (mapped[i][d] - velocity[i][d]);
        mapped[i][d] += own * velocities_.unmapped_start[i][d];
      }
    conditions_.keep_dashpots(velocity, mapped);
    constrain(t, velocity);
    conditions_.join_bonded(velocity);
  } else {  // the same sum, mapped once
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) scratch_[i][d] = velocity[i][d] - velocities_.kept * start[i][d];
    PetscCall(to_particles_and_back(scratch_.data(), mapped));
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) mapped[i][d] += velocities_.kept * start[i][d];
    conditions_.keep_dashpots(velocity, mapped);
  }
  constrain(t, mapped);
  conditions_.follow_contacts(mapped);
  PetscFunctionReturn(0);
}

/// Supports and bases fix the places in every stage; what they take from the velocity is taken once, after the step.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::rates(double t, const double *u, const double *v, double *du, double *dv) {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count(), all = nodes * fields;
  if (damped()) {
    Vec<dim> *skeleton = scratch_.data();
    std::copy_n(reinterpret_cast<const Vec<dim> *>(v), nodes, skeleton);
    conditions_.constrain(loading.time_at(t), grid_, skeleton, true);
    PetscCall(find_moving(t, skeleton, velocities_.share_not_mapped(t), false));
  }
  PetscCall(accelerate(t, u, v, dv));
  const std::vector<Vec<dim>> &start = velocities_.start;
  Vec<dim> *supported = scratch_.data(), *mapped = reinterpret_cast<Vec<dim> *>(du),
           *change = reinterpret_cast<Vec<dim> *>(dv);
  std::copy_n(reinterpret_cast<const Vec<dim> *>(v), all, supported);
  constrain(t, supported);
  if (velocities_.relaxes) {
    PetscCall(to_particles_and_back(supported, mapped));
    const double own = velocities_.own_share_at(t);
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) {
        change[i][d] -= (supported[i][d] - mapped[i][d]) / velocities_.relaxation_time;
        mapped[i][d] += own * velocities_.unmapped_start[i][d];
      }
  } else {  // the same sum, mapped once
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) supported[i][d] -= velocities_.kept * start[i][d];
    PetscCall(to_particles_and_back(supported, mapped));
    for (int i = 0; i < all; ++i)
      for (int d = 0; d < dim; ++d) mapped[i][d] += velocities_.kept * start[i][d];
  }
  constrain(t, mapped);
  PetscFunctionReturn(0);
}

}  // namespace talus
