#include "earthquake/shaking.h"

#include "earthquake/sources.h"

namespace talus {

GroundShaking::GroundShaking(const std::vector<EarthquakeSource> &components) {
  for (const EarthquakeSource &source : components) {
    std::array<double, 3> direction{};
    double size = 0;
    for (std::size_t d = 0; d < source.direction.size(); ++d) size += source.direction[d] * source.direction[d];
    for (std::size_t d = 0; d < source.direction.size(); ++d) direction[d] = source.direction[d] / std::sqrt(size);
    if (source.direction.empty()) direction[0] = 1;
    GroundMotion motion = read_motion(source);
    std::vector<double> velocity = motion.velocity();
    components_.push_back({direction, std::move(motion), std::move(velocity)});
  }
}

double GroundShaking::duration() const {
  double longest = 0;
  for (const Component &one : components_) longest = std::max(longest, one.motion.duration());
  return longest;
}

std::array<double, 3> GroundShaking::velocity(double t) const {
  std::array<double, 3> sum{};
  for (const auto &[direction, motion, at_values] : components_) {
    if (t <= 0) continue;
    const auto k = std::min(static_cast<std::size_t>(t / motion.step), at_values.size() - 1);
    const double since = t - static_cast<double>(k) * motion.step;
    const double v = at_values[k] + since * (motion.acceleration[k] + motion.at(t)) / 2;
    for (int d = 0; d < 3; ++d) sum[d] += (k + 1 < at_values.size() ? v : at_values[k]) * direction[d];
  }
  return sum;
}

std::array<double, 3> GroundShaking::acceleration(double t) const {
  std::array<double, 3> sum{};
  for (const Component &one : components_) {
    const double a = one.motion.at(t);
    for (int d = 0; d < 3; ++d) sum[d] += a * one.direction[d];
  }
  return sum;
}

}  // namespace talus
