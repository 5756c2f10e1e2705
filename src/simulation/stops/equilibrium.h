#pragma once
/// Once gravity is whole: out-of-balance forces are small against the applied ones, and kinetic energy against strain
/// energy; and nothing that acts on the soil has still to change.
#include "scene/stage.h"
#include "simulation/run.h"
#include "simulation/stops/loads_to_come.h"

namespace talus {

template <int dim>
class StopAtEquilibrium final : public StopCriterion<dim> {
 public:
  StopAtEquilibrium(const Stage &stage, const AtEquilibrium &keys) : stage_(stage), keys_(keys) {}

  bool met(Run<dim> &run, const Verdict &) override {
    constexpr int steps_between_checks = 25;
    if (run.clock.steps % steps_between_checks || run.clock.time - run.progress.begin < stage_.gravity_ramp())
      return false;
    const Balance sums = run.balance();
    const bool balanced = sums.unbalanced <= keys_.force_ratio * sums.applied,
               quiet = sums.kinetic <= keys_.energy_ratio * sums.strain;
    if (!balanced || !quiet) return false;
    if (loads_to_come_.hold_up(run, "the soil is in equilibrium", loads_to_come_(run))) return false;
    run.recorder.note(
        "stage " + stage_.name + " is in equilibrium: unbalanced force ratio " + std::to_string(sums.ratio()),
        event::equilibrium, {{"unbalanced_force_ratio", sums.ratio()}});
    return true;
  }

 private:
  const Stage &stage_;
  const AtEquilibrium &keys_;
  LoadsToCome<dim> loads_to_come_;
};

}  // namespace talus
