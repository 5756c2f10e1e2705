#include "solvers/forward_euler.h"

namespace talus {

std::unique_ptr<Integrator> ForwardEulerSettings::make() const { return std::make_unique<ForwardEuler>(*this); }

PetscErrorCode ForwardEuler::advance(Motion &motion, double t, const StepBounds &bounds, double *taken) {
  PetscFunctionBeginUser;
  const bool fixed = settings_.step > 0;
  const double left = bounds.until - t,
               step = even_step(fixed ? settings_.step : settings_.fraction * bounds.critical, left, fixed);
  const int size = motion.size();
  double *v = motion.velocity();
  displacement_.resize(size), change_.resize(size);  // within capacity once the soil has spread furthest
  PetscCall(motion.rates(t, nullptr, v, displacement_.data(), change_.data()));
  for (int i = 0; i < size; ++i) displacement_[i] *= step, v[i] += step * change_[i];
  PetscCall(motion.drag(t + step, step, v));
  PetscCall(motion.accept(t + step, displacement_.data(), v));
  *taken = step;
  ++statistics_.evaluations;
  count(step, bounded_by(left, step));
  PetscFunctionReturn(0);
}

}  // namespace talus
