#pragma once
/// A water table of a scene: a polyline of points [x, elevation], level beyond its ends, or a function of the place,
/// such as a grid.
#include <algorithm>
#include <vector>

#include "scene/function.h"

namespace talus {

/// Elevation of a polyline of points [x, elevation] at x, level beyond its ends [m].
inline double elevation_of(const std::vector<std::vector<double>> &points, double x) {
  if (points.size() == 1) return points[0][1];
  size_t k = 1;
  while (k + 1 < points.size() && points[k][0] < x) ++k;
  const double s = std::clamp((x - points[k - 1][0]) / (points[k][0] - points[k - 1][0]), 0., 1.);
  return points[k - 1][1] + s * (points[k][1] - points[k - 1][1]);
}

struct WaterTable {
  std::vector<std::vector<double>> points;  ///< [m]
  Function elevation;                       ///< in place of points, of x, y, z [m]

  bool given() const { return !points.empty() || elevation.given(); }
  /// Has it one elevation everywhere?
  bool level() const { return points.size() == 1; }
  /// Elevation at a place, of which z is 0 in plane strain; only for a table that is given [m].
  double at(double x, double y, double z) const {
    return points.empty() ? elevation(x, y, z, 0) : elevation_of(points, x);
  }
};

}  // namespace talus
