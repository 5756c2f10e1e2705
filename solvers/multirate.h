#pragma once
/// Two clocks, by SUNDIALS MRIStep: an explicit multirate method of order 3 takes the slow rates of a motion a few
/// times a step, and between them follows the fast ones by small Runge-Kutta steps of order 3 (Knoth & Wolke 1998;
/// Schlegel et al. 2009), docs/theory/integrators.md, section 5. For a motion that tells its rates apart (`slow_rates`,
/// `fast_rates`); no scene has such a motion yet, so no scene names it.
#include <memory>

#include "solvers/integrator.h"

namespace talus {

struct MultirateSettings {
  double step = 0;    ///< of the slow clock [s]
  int substeps = 10;  ///< of the fast clock in one step of the slow one
};

class Multirate final : public Integrator {
 public:
  explicit Multirate(const MultirateSettings &settings);
  ~Multirate() override;
  /// `statistics().evaluations` counts the fast rates.
  PetscErrorCode advance(Motion &motion, double t, const StepBounds &bounds, double *taken) override;
  long long slow_evaluations() const;

 private:
  struct Memory;  // SUNDIALS stays inside multirate.cpp
  MultirateSettings settings_;
  std::unique_ptr<Memory> memory_;
};

}  // namespace talus
