#pragma once
/// The plug of the time loop: one step of any integrator over any motion.
#include "base/archive.h"
#include "physics/motion.h"

namespace talus {

class Integrator {
 public:
  virtual ~Integrator() = default;
  /// Advances the motion from t by `step` [s]; a step that an integrator divides further ends at t + step all the same.
  virtual PetscErrorCode advance(Motion &motion, double t, double step) = 0;
  /// What the next step depends on beside the motion, such as an adapted step size; for checkpoints.
  virtual void keep(Archive &) {}
};

}  // namespace talus
