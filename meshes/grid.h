#pragma once
/// A grid of elevations as read from a terrain file: ESRI ASCII, GeoTIFF and whatever else GDAL reads. Part of
/// talus-mesh: no library of Talus links GDAL.
#include <string>
#include <vector>

namespace talus {

struct Grid {
  std::string file;
  int columns = 0, rows = 0;
  double west = 0, south = 0;     ///< of the first elevation, the centre of its cell [m]
  double spacing = 0;             ///< of columns and rows [m]
  std::vector<double> elevation;  ///< [rows][columns], from the southwest; not a number where there is no data [m]
  std::string projection;         ///< as well-known text; empty where the file names none

  double east() const { return west + (columns - 1) * spacing; }
  double north() const { return south + (rows - 1) * spacing; }
  /// Linear between elevations along both axes; not a number outside and beside holes [m].
  double at(double x, double y) const;
};

/// Throws std::invalid_argument for a file that is no grid, cells that are not square or do not face north, coordinates
/// in degrees or feet, and elevations in another unit than metres.
Grid read_grid(const std::string &file);

}  // namespace talus
