#pragma once
/// Outlines on a map, such as that of a slide: polygons of a Shapefile, a GeoPackage or another file that GDAL reads.
#include <array>
#include <string>
#include <vector>

#include "meshes/grid.h"

namespace talus {

struct Outline {
  Location location;
  std::vector<std::vector<std::array<double, 2>>> rings;  ///< of all polygons, also around their holes [m]
  /// Is a place in one of the polygons and in none of their holes?
  bool contains(double x, double y) const;
};

/// Throws std::invalid_argument for a file without polygons, and with coordinates that are not metres.
Outline read_outline(const std::string &file);

/// How far the bottom of a bowl lies below its rim at the nodes [rows][columns] inside: the solution of
/// laplace(depth) = -constant that is 0 at the nodes outside and `deepest` at most. On a plane slope this is the slip
/// surface of the sloping local base level, whose curvature is the same everywhere (Jaboyedoff et al. 2004).
std::vector<double> bowl(const std::vector<char> &inside, int columns, double deepest);

}  // namespace talus
