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
  std::vector<int> polygon;                               ///< of each ring, from 0 on
  /// The polygons, each for itself.
  std::vector<Outline> parts() const;
  double area() const;       ///< less that of holes [m2]
  double perimeter() const;  ///< with that of holes [m]
  /// Of its extent [m].
  std::array<double, 2> low() const;
  std::array<double, 2> high() const;
  /// Is a place in one of the polygons and in none of their holes?
  bool contains(double x, double y) const;
  /// Is a place on a side of a polygon, to within a distance?
  bool touches(double x, double y, double near) const;
  /// How far the sides lie from a place to the west, east, south and north, `farthest` at most.
  std::array<double, 4> sides_around(double x, double y, double farthest) const;
};

/// Throws std::invalid_argument for a file without polygons, and with coordinates that are not metres.
Outline read_outline(const std::string &file);

/// How far the bottom of a bowl lies below its rim at the nodes [rows][columns] of a grid, 0 outside: the solution of
/// laplace(depth) = -constant that is 0 at the rim and `deepest` at its deepest place. `rim` is the distance from a
/// node to the rim towards west, east, south and north, in spacings of the grid, 1 where it is not nearer than the next
/// node. On a plane slope this is the slip surface of the sloping local base level, whose curvature is the same
/// everywhere (Jaboyedoff et al. 2004).
std::vector<double> bowl(const std::vector<char> &inside, const std::vector<std::array<double, 4>> &rim, int columns,
                         double deepest);

}  // namespace talus
