#pragma once
/// Reads grid files: ESRI ASCII, GeoTIFF and whatever else GDAL reads. Part of talus-mesh, which hands the values to
/// the program: no library of Talus links GDAL.
#include <array>
#include <string>

#include "base/grid.h"

namespace talus {

/// While one lives, GDAL prints nothing: what is wrong with a file is said in one sentence of ours.
struct QuietGdal {
  QuietGdal();
  ~QuietGdal();
  QuietGdal(const QuietGdal &) = delete;
};

/// The values of the first band, with the scale and the offset that the file gives it. Throws std::invalid_argument for
/// a file that is no grid, cells that are not square or do not face north, and coordinates in degrees or feet.
Grid read_grid(const std::string &file);

/// The same, of elevations; also for those in another unit than metres, and coordinates that seem to be degrees.
Grid read_elevations(const std::string &file);

/// What a file says of where it lies.
struct Location {
  std::string file, projection;  ///< path; well-known text, empty where the file names none
  std::array<double, 2> middle;  ///< in its coordinates [m]
  double near;                   ///< what is nearer than this counts as the same place [m]
  bool vector = false;           ///< of polygons, not a grid, which other programs project
};
inline Location location_of(const Grid &grid) {
  return {
      grid.file, grid.projection, {(grid.west + grid.east()) / 2, (grid.south + grid.north()) / 2}, grid.spacing / 10};
}

/// Throws std::invalid_argument where the projection of a file is not that of the file `of`, given as well-known text:
/// where they differ as definitions and by more than `near` at the middle. Nothing is known of an empty projection;
/// heights do not count.
void check_same_projection(const Location &own, const std::string &projection, const std::string &of);

/// Lengths on the map to those on the ellipsoid of its datum at the middle of a file, towards the east and the north of
/// the map: 0.9996 to 1.001 in UTM, 1.5 in Web Mercator at a latitude of 48 degrees. Not a number where the projection
/// is not known or PROJ cannot tell.
std::array<double, 2> map_scale(const Location &location);

/// Writes values as the program reads them (src/mesh_source.cpp): a line of columns, rows, west, south and spacing,
/// then the values as doubles. Throws std::invalid_argument.
void write_values(const Grid &grid, const std::string &file);

}  // namespace talus
