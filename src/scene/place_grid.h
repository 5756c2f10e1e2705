#pragma once
/// A grid file that expressions of a scene call by name: [grids] water = "water.tif", then "water(x, y)". The scene
/// names the file; its values arrive when the mesh is made, since they count from the origin of the mesh.
#include <array>
#include <cmath>
#include <string>

#include "base/grid.h"

namespace talus {

struct PlaceGrid {
  std::string file;                           ///< path, as the program opens it
  std::string digest;                         ///< of the values, once they have arrived
  std::array<double, 2> origin{};             ///< of the mesh in the coordinates of the file [m]
  Grid grid;                                  ///< no columns: not read yet
  mutable bool missed = false;                ///< a value was asked for where there is none ...
  mutable std::array<double, 2> missed_at{};  ///< ... here, in the coordinates of the file [m]

  /// Value at a place of the mesh; not a number, and `missed`, outside of the grid and beside holes; zero before the
  /// values have arrived.
  double at(double x, double y) const {
    if (grid.columns == 0) return 0;
    const double value = grid.at(x + origin[0], y + origin[1]);
    if (std::isnan(value)) missed = true, missed_at = {x + origin[0], y + origin[1]};
    return value;
  }
};

}  // namespace talus
