#pragma once
/// A grid file that expressions of a scene call by name: [grids] water = "water.tif", then "water(x, y)". The scene
/// names the file; its values arrive when the mesh is made, since they count from the origin of the mesh.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

  /// Corners of the box around the mesh, once it is there [m]: expressions that read the grid are asked in it, since
  /// nodes of the mesh leave it a little before they return.
  std::array<std::array<double, 3>, 2> mesh{std::array{-unbounded, -unbounded, -unbounded},
                                            std::array{unbounded, unbounded, unbounded}};

  /// Value at a place of the mesh; not a number, and `missed`, outside of the grid and beside holes; zero before the
  /// values have arrived. Values of the outermost cells hold as far as these reach, half a spacing.
  double at(double x, double y) const {
    if (grid.columns == 0) return 0;
    const double beyond = grid.spacing / 2;
    const auto held = [&](double place, double low, double high) {
      return place >= low - beyond && place <= high + beyond ? std::clamp(place, low, high) : place;
    };
    const double value =
        grid.at(held(x + origin[0], grid.west, grid.east()), held(y + origin[1], grid.south, grid.north()));
    if (std::isnan(value)) missed = true, missed_at = {x + origin[0], y + origin[1]};
    return value;
  }

 private:
  static constexpr double unbounded = std::numeric_limits<double>::infinity();
};

}  // namespace talus
