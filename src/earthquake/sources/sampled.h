#pragma once
/// Values of a formula.
#include "earthquake/ground_motion.h"

namespace talus {

/// The motion a(t) of a duration whose largest frequency of importance is known [s], [Hz].
template <class Formula>
GroundMotion sampled(double duration, double frequency, Formula &&a) {
  constexpr double per_period = 100;
  const auto steps = static_cast<std::size_t>(std::ceil(duration * frequency * per_period));
  GroundMotion motion{duration / static_cast<double>(steps), std::vector<double>(steps + 1)};
  for (std::size_t k = 0; k <= steps; ++k) motion.acceleration[k] = a(static_cast<double>(k) * motion.step);
  return motion;
}

}  // namespace talus
