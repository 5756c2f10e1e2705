#include "earthquake/ground_path.h"

#include <algorithm>

namespace talus {

GroundPath::GroundPath(const GroundShaking &shaking) : shaking_(shaking) {
  for (const auto &one : shaking.components()) at_values_.push_back(one.motion.displacement());
}

std::array<double, 3> GroundPath::displacement(double t) const {
  std::array<double, 3> sum{};
  if (t <= 0) return sum;
  for (std::size_t c = 0; c < at_values_.size(); ++c) {
    const auto &[direction, motion, velocity] = shaking_.components()[c];
    const auto k = std::min(static_cast<std::size_t>(t / motion.step), velocity.size() - 1);
    const double since = k + 1 < velocity.size() ? t - static_cast<double>(k) * motion.step : 0;
    const double x = at_values_[c][k] + since * (velocity[k] + since * (2 * motion.acceleration[k] + motion.at(t)) / 6);
    for (int d = 0; d < 3; ++d) sum[d] += x * direction[d];
  }
  return sum;
}

}  // namespace talus
