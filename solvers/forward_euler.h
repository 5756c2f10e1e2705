#pragma once
/// The textbook's explicit Euler: places and velocities both move with the rates at the start of the step. For
/// comparison only: it amplifies every undamped wave, docs/theory/integrators.md, section 1.
#include <memory>
#include <vector>

#include "solvers/integrator.h"

namespace talus {

/// Keys of [integrator] with kind = "forward-euler".
struct ForwardEulerSettings : StepKeys {
  static constexpr const char *name = "forward-euler";
  ForwardEulerSettings() : StepKeys(0.1) {}
  template <class Visitor>
  void fields(Visitor &&v) {
    step_fields(
        v, "fixed time step; 0: a fraction of the critical step",
        "ratio of the time step to the critical step 2 / omega_max; waves grow at any fraction, slowly at small ones");
  }
  StepRule rule() const { return {step, fraction, 1}; }
  std::string drag_problem() const { return "would amplify the waves of the pores"; }
  std::unique_ptr<Integrator> make() const;
};

class ForwardEuler final : public Integrator {
 public:
  explicit ForwardEuler(const ForwardEulerSettings &settings) : settings_(settings) {}
  PetscErrorCode advance(Motion &motion, double t, const StepBounds &bounds, double *taken) override;

 private:
  ForwardEulerSettings settings_;
  std::vector<double> displacement_, change_;
};

}  // namespace talus
