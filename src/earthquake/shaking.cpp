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
    components_.push_back({direction, read_motion(source)});
  }
}

double GroundShaking::duration() const {
  double longest = 0;
  for (const Component &one : components_) longest = std::max(longest, one.motion.duration());
  return longest;
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
