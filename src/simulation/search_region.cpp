#include "simulation/search_region.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "meshes/polygon.h"
#include "scene/factor_source.h"

namespace talus {

TensionCrack::TensionCrack(const FactorSource &search) : water_(search.crack_water) {
  for (const auto &point : search.tension_crack) line_.push_back({point[0], point[1]});
}

bool TensionCrack::wet() const { return water_ > FactorSource::no_water; }

bool TensionCrack::reaches(double x, double elevation) const {
  for (std::size_t i = 0; i + 1 < line_.size(); ++i) {
    const auto &[a, b] = std::pair{line_[i], line_[i + 1]};
    if (a[0] <= x && x <= b[0]) return elevation > a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]);
  }
  return false;
}

double TensionCrack::head(double elevation) const { return std::max(0., water_ - elevation); }

SearchRegion::SearchRegion(const FactorSource &search) : width_(search.width) {
  for (const auto &point : search.within) polygon_.push_back({point[0], point[1]});
  for (const auto &point : search.along) line_.push_back({point[0], point[1]});
}

bool SearchRegion::holds(double x, double elevation, double size) const {
  const Vec<2> place{x, elevation};
  if (!polygon_.empty() && !is_inside(polygon_, place)) return false;
  if (line_.empty()) return true;
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line_.size(); ++i)
    distance = std::min(distance, distance_to_segment(line_[i], line_[i + 1], place));
  return distance <= (width_ > 0 ? width_ / 2 : size);
}

}  // namespace talus
