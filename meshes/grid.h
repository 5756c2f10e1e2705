#pragma once
/// Reads grid files: ESRI ASCII, GeoTIFF and whatever else GDAL reads. Part of talus-mesh, which hands the values to
/// the program: no library of Talus links GDAL.
#include <string>

#include "base/grid.h"

namespace talus {

/// Throws std::invalid_argument for a file that is no grid, cells that are not square or do not face north, and
/// coordinates in degrees or feet.
Grid read_grid(const std::string &file);

/// The same, of elevations; also for those in another unit than metres, and coordinates that seem to be degrees.
Grid read_elevations(const std::string &file);

/// Writes values as the program reads them (src/mesh_source.cpp): a line of columns, rows, west, south and spacing,
/// then the values as doubles. Throws std::invalid_argument.
void write_values(const Grid &grid, const std::string &file);

}  // namespace talus
