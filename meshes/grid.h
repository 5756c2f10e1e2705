#pragma once
/// Reads grid files: ESRI ASCII, GeoTIFF and whatever else GDAL reads. Part of talus-mesh, which hands the values to
/// the program: no library of Talus links GDAL.
#include <string>

#include "base/grid.h"

namespace talus {

/// The values of the first band, with the scale and the offset that the file gives it. Throws std::invalid_argument for
/// a file that is no grid, cells that are not square or do not face north, and coordinates in degrees or feet.
Grid read_grid(const std::string &file);

/// The same, of elevations; also for those in another unit than metres, and coordinates that seem to be degrees.
Grid read_elevations(const std::string &file);

/// Throws std::invalid_argument where the projection of a grid is not that of the file `of`, given as well-known text:
/// where they differ as definitions and by more than a tenth of the spacing at the middle of the grid. Nothing is known
/// of an empty projection; heights do not count.
void check_same_projection(const Grid &grid, const std::string &projection, const std::string &of);

/// Writes values as the program reads them (src/mesh_source.cpp): a line of columns, rows, west, south and spacing,
/// then the values as doubles. Throws std::invalid_argument.
void write_values(const Grid &grid, const std::string &file);

}  // namespace talus
