#include "simulation/search_region.h"

#include <algorithm>
#include <limits>

#include "meshes/polygon.h"
#include "scene/factor_source.h"

namespace talus {

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
