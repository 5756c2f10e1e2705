#include "solvers/forward_euler.h"

namespace talus {

std::unique_ptr<Integrator> ForwardEulerSettings::make() const { return std::make_unique<ForwardEuler>(*this); }

PetscErrorCode ForwardEuler::advance(Motion &motion, double t, const StepBounds &bounds, double *taken) {
  PetscFunctionBeginUser;
  const double step = step_length(settings_.rule(), t, bounds);
  const int size = motion.size();
  double *v = motion.velocity();
  displacement_.resize(size), change_.resize(size);  // within capacity once the soil has spread furthest
  PetscCall(motion.rates(t, nullptr, v, displacement_.data(), change_.data()));
  for (int i = 0; i < size; ++i) displacement_[i] *= step, v[i] += step * change_[i];
  PetscCall(motion.apply_boundaries_and_drag(t + step, step, v));
  PetscCall(motion.accept(t + step, displacement_.data(), v));
  *taken = step;
  ++statistics_.evaluations;
  count(step, bounded_by(bounds.until - t, step));
  PetscFunctionReturn(0);
}

}  // namespace talus
