#include "meshes/ellipsoid.h"

#include <cmath>

namespace talus {

std::array<std::array<double, 3>, 3> Ellipsoid::axes() const {
  const double s = std::sin(dip_direction), c = std::cos(dip_direction);
  return {{{std::cos(dip) * s, std::cos(dip) * c, -std::sin(dip)},
           {c, -s, 0},
           {std::sin(dip) * s, std::sin(dip) * c, std::cos(dip)}}};
}

double Ellipsoid::side(double x, double y, double sign) const {
  const auto axis = axes();
  double square = 0, mixed = 0, rest = -1;  // of the equation for the height above the centre
  for (int k = 0; k < 3; ++k) {
    const double level = (axis[k][0] * (x - centre[0]) + axis[k][1] * (y - centre[1])) / semi_axes[k],
                 rise = axis[k][2] / semi_axes[k];
    square += rise * rise, mixed += level * rise, rest += level * level;
  }
  return centre[2] + (-mixed + sign * std::sqrt(mixed * mixed - square * rest)) / square;
}

double Ellipsoid::bottom(double x, double y) const { return side(x, y, -1); }
double Ellipsoid::top(double x, double y) const { return side(x, y, 1); }

/// On the unit sphere the rim is the great circle normal to (n0, 0, n2), since the second axis is level.
std::array<double, 3> Ellipsoid::rim(double angle) const {
  const auto axis = axes();
  const double n0 = axis[0][2] / semi_axes[0], n2 = axis[2][2] / semi_axes[2], n = std::hypot(n0, n2);
  const double along[] = {std::sin(angle) * n2 / n, std::cos(angle), -std::sin(angle) * n0 / n};
  std::array<double, 3> place = centre;
  for (int k = 0; k < 3; ++k)
    for (int d = 0; d < 3; ++d) place[d] += along[k] * semi_axes[k] * axis[k][d];
  return place;
}

}  // namespace talus
