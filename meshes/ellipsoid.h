#pragma once
#include <array>

namespace talus {

/// A slip surface like a spoon: the lower side of an ellipsoid. Its first axis points down the dip, the second along
/// the strike, the third along the normal. Dip direction is the azimuth, clockwise from north, towards which the
/// surface dips: 90 degrees is east.
struct Ellipsoid {
  std::array<double, 3> centre;       ///< in the coordinates of the grid [m]
  std::array<double, 3> semi_axes;    ///< down the dip, along the strike, along the normal [m]
  double dip = 0, dip_direction = 0;  ///< [rad]
  /// Elevation of the lower side; not a number beside the ellipsoid.
  double bottom(double x, double y) const;
  /// The same of the upper side.
  double top(double x, double y) const;
  /// A place of the rim, seen from above, where lower and upper side meet; `angle` from 0 to 2 pi goes round it.
  std::array<double, 3> rim(double angle) const;

 private:
  std::array<std::array<double, 3>, 3> axes() const;
  double side(double x, double y, double sign) const;
};

}  // namespace talus
