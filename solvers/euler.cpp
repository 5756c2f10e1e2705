#include "solvers/euler.h"

namespace talus {

std::unique_ptr<Integrator> EulerSettings::make() const { return std::make_unique<Euler>(*this); }

PetscErrorCode Euler::advance(Motion &motion, double t, const StepBounds &bounds, double *taken) {
  PetscFunctionBeginUser;
  const double step = step_length(settings_.rule(), t, bounds);
  const int size = motion.size();
  double *v = motion.velocity();
  acceleration_.resize(size), mapped_.resize(size);  // within capacity once the soil has spread furthest
  PetscCall(motion.acceleration(t, nullptr, v, acceleration_.data()));
  for (int i = 0; i < size; ++i) v[i] += step * acceleration_[i];
  PetscCall(motion.apply_boundaries_and_drag(t + step, step, v));
  PetscCall(motion.map_back(t + step, step, v, mapped_.data()));
  for (int i = 0; i < size; ++i) mapped_[i] *= step;
  PetscCall(motion.accept(t + step, mapped_.data(), v));
  *taken = step;
  ++statistics_.evaluations;
  count(step, bounded_by(bounds.until - t, step));
  PetscFunctionReturn(0);
}

}  // namespace talus
