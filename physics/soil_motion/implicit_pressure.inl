// Pore pressure implicit in time; theory of pores, section 8; included only where SoilMotion is instantiated.
#include <algorithm>

#include "physics/soil_motion.h"

namespace talus {

/// Strain of the pores in a step that ends at t, from velocities before drag [field][node]. Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::find_strain_of_step(double t, const StepStart<dim> &at,
                                                            const Vec<dim> *velocity) requires Phases::liquid {
  PetscFunctionBeginUser;
  const int nodes = grid_.node_count();
  Vec<dim> *solid = implicit_.after_drag.data(), *fluid = solid + nodes, *mapped = implicit_.mapped.data();
  std::copy_n(velocity, nodes * fields, solid);
  const auto frame = pore_frame(t, accepted_);
  fluid_.apply_drag_to_solid(at.step, frame, pore_conditions_, solid, fluid);
  conditions_.foresee(loading.time_at(t), at.step, grid_, solid, contact(t, at.step));
  fluid_.find_walls(frame, pore_conditions_, at.step, solid, fluid, implicit_);
  fluid_.apply_drag_to_fluids(at.step, frame, pore_conditions_, solid, fluid);
  PetscCall(map_change(at.step, solid, mapped));
  constrain(t, mapped);
  for (int i = 0; i < nodes * fields; ++i)
    for (double &x : mapped[i]) x *= at.step;
  PetscCall(implicit_.find_strain(at, mapped));
  PetscFunctionReturn(0);
}

/// Adds to velocities before drag, [field][node], the impulse of the change of pore pressure in the step, so that the
/// pressures at its end act. Where a boundary limits the flux on one side only, whether it does is found by trial, and
/// so is whether the skeleton bears a pressure that was suction.
/// Collective.
template <int dim, class Phases>
PetscErrorCode SoilMotion<dim, Phases>::add_implicit_pressure(double t, double gamma,
                                                              Vec<dim> *velocity) requires Phases::liquid {
  PetscFunctionBeginUser;
  const bool by_trial = Phases::suction || pore_conditions_.limits_one_side();
  const int most_trials = by_trial ? 4 : 1;
  const auto frame = pore_frame(t, accepted_);
  const StepStart<dim> at{grid_, conditions_.prescribed(), accepted_.shape, accepted_.weight.data(), gamma};
  PetscCall(fluid_.start_implicit(frame, pore_conditions_, gamma, implicit_));
  PetscCall(implicit_.begin(at));
  implicit_.damped.clear();
  conditions_.each_damped(gamma, grid_, contact(t, gamma), [&](int i, const Square<dim> &rest) {
    implicit_.damped.push_back({i, fluid_.free_share(gamma, i), rest});
  });
  bool changed = true;
  for (int trial = 0; trial < most_trials && changed; ++trial) {
    PetscCall(find_strain_of_step(t, at, velocity));
    PetscCall(implicit_.solve(at, &changed));
    if (changed) PetscCall(fluid_.push_by_change(at, implicit_, velocity));
  }
  implicit_.end();
  PetscFunctionReturn(0);
}

}  // namespace talus
