#include "earthquake/ground_motion.h"

namespace talus {

std::vector<double> GroundMotion::velocity() const {
  std::vector<double> v(acceleration.size());
  for (std::size_t k = 1; k < v.size(); ++k) v[k] = v[k - 1] + step * (acceleration[k - 1] + acceleration[k]) / 2;
  return v;
}

std::vector<double> GroundMotion::displacement() const {
  const std::vector<double> v = velocity();
  std::vector<double> d(v.size());
  for (std::size_t k = 1; k < d.size(); ++k)
    d[k] = d[k - 1] + step * v[k - 1] + step * step * (2 * acceleration[k - 1] + acceleration[k]) / 6;
  return d;
}

}  // namespace talus
