#pragma once
/// Motion of the ground in one direction, at equal steps of time.
#include <algorithm>
#include <cmath>
#include <vector>

namespace talus {

struct GroundMotion {
  double step = 0;                   ///< [s]
  std::vector<double> acceleration;  ///< the first at t = 0 [m/s2]

  double duration() const { return acceleration.empty() ? 0 : step * static_cast<double>(acceleration.size() - 1); }
  /// Acceleration at a time, linear between the values; 0 outside of the record [m/s2].
  double at(double t) const {
    const double place = t / step;
    const auto last = static_cast<double>(acceleration.size()) - 1;
    if (!(place >= 0 && place <= last)) return 0;
    const auto k = static_cast<std::size_t>(std::min(place, last - 1));
    const double share = place - static_cast<double>(k);
    return (1 - share) * acceleration[k] + share * acceleration[k + 1];
  }
  /// Largest magnitude of the acceleration [m/s2].
  double peak() const {
    double most = 0;
    for (const double a : acceleration) most = std::max(most, std::abs(a));
    return most;
  }
  /// Velocity and displacement of ground that is at rest at t = 0, exact for acceleration that is linear between its
  /// values [m/s], [m].
  std::vector<double> velocity() const;
  std::vector<double> displacement() const;
};

}  // namespace talus
