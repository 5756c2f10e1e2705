#include "solvers/euler.h"

namespace talus {

PetscErrorCode Euler::advance(Motion &motion, double t, double step) {
  PetscFunctionBeginUser;
  const int size = motion.size();
  double *v = motion.velocity();
  acceleration_.resize(size), mapped_.resize(size);  // within capacity once the soil has spread furthest
  PetscCall(motion.acceleration(t, nullptr, v, acceleration_.data()));
  for (int i = 0; i < size; ++i) v[i] += step * acceleration_[i];
  PetscCall(motion.drag(t, step, v));
  PetscCall(motion.map_back(t, step, v, mapped_.data()));
  for (int i = 0; i < size; ++i) mapped_[i] *= step;
  PetscCall(motion.accept(t + step, mapped_.data(), v));
  PetscFunctionReturn(0);
}

}  // namespace talus
