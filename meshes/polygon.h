#pragma once
/// Plane geometry of polygons and segments.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/vec.h"

namespace talus {

inline double cross(const Vec<2> &a, const Vec<2> &b, const Vec<2> &c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

inline double distance_to_segment(const Vec<2> &a, const Vec<2> &b, const Vec<2> &x) {
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double t = std::clamp(((x[0] - a[0]) * dx + (x[1] - a[1]) * dy) / (dx * dx + dy * dy), 0., 1.);
  return std::hypot(a[0] + t * dx - x[0], a[1] + t * dy - x[1]);
}

/// Segments ab and cd have a point in common, to within a tolerance [m].
inline bool segments_meet(const Vec<2> &a, const Vec<2> &b, const Vec<2> &c, const Vec<2> &d, double tolerance) {
  const auto apart = [](double s, double t) { return (s > 0 && t > 0) || (s < 0 && t < 0); };
  if (!apart(cross(a, b, c), cross(a, b, d)) && !apart(cross(c, d, a), cross(c, d, b)) && cross(a, b, c) != 0)
    return true;
  return std::min({distance_to_segment(a, b, c), distance_to_segment(a, b, d), distance_to_segment(c, d, a),
                   distance_to_segment(c, d, b)}) <= tolerance;
}

/// Positive when the corners go round counter-clockwise.
inline double signed_area(const std::vector<Vec<2>> &polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    twice += cross(polygon[0], polygon[i], polygon[(i + 1) % polygon.size()]);
  return twice / 2;
}

/// Parity of the edges that a ray upward from x crosses; points on an edge may fall on either side.
inline bool is_inside(const std::vector<Vec<2>> &polygon, const Vec<2> &x) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec<2> &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a[0] <= x[0]) == (b[0] <= x[0])) continue;
    inside ^= a[1] + (x[0] - a[0]) / (b[0] - a[0]) * (b[1] - a[1]) > x[1];
  }
  return inside;
}

inline double distance_to_polygon(const std::vector<Vec<2>> &polygon, const Vec<2> &x) {
  double least = distance_to_segment(polygon.back(), polygon.front(), x);
  for (std::size_t i = 0; i + 1 < polygon.size(); ++i)
    least = std::min(least, distance_to_segment(polygon[i], polygon[i + 1], x));
  return least;
}

}  // namespace talus
