#include "meshes/grid.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace talus {

QuietGdal::QuietGdal() { CPLPushErrorHandler(CPLQuietErrorHandler); }
QuietGdal::~QuietGdal() { CPLPopErrorHandler(); }

namespace {

[[noreturn]] void complain(const std::string &file, const std::string &text) {
  throw std::invalid_argument(file + ": " + text);
}

constexpr const char *to_metres =
    "project it to metres first, such as by gdalwarp -t_srs EPSG:CODE (CODE of a UTM zone or of the national grid)";

/// Metres, or a complaint. `map` is GDAL's: west, dx/column, dx/row, north, dy/column, dy/row.
void check_projection(const Grid &grid, const double *map, const OGRSpatialReference *projection) {
  if (projection && projection->IsGeographic()) {
    const double east = map[0] + grid.columns * map[1] + grid.rows * map[2],
                 south = map[3] + grid.columns * map[4] + grid.rows * map[5];
    if (std::max(std::abs(map[0]), std::abs(east)) > 361 || std::max(std::abs(map[3]), std::abs(south)) > 91)
      complain(grid.file,
               "says that its coordinates are degrees, but they reach beyond 360 and 90: correct what the "
               "file says of its projection, such as by gdal_edit.py -a_srs EPSG:CODE");
    complain(grid.file, std::string("has coordinates in degrees; ") + to_metres);
  }
  if (projection && projection->IsProjected() && std::abs(projection->GetLinearUnits() - 1) > 1e-9) {
    const char *unit = nullptr;
    projection->GetLinearUnits(&unit);
    complain(grid.file, std::string("has coordinates in ") + (unit ? unit : "another unit") + "; " + to_metres);
  }
}

/// Square cells in rows from west to east, or a complaint.
void check_cells(const std::string &file, const double *map) {
  std::ostringstream text;
  text.precision(9);
  if (map[2] != 0 || map[4] != 0 || !(map[1] > 0))
    text << "must have rows from west to east, but from one column to the next x changes by " << map[1] << " and y by "
         << map[4] << ", and from one row to the next by " << map[2] << " and " << map[5]
         << "; resample it, such as by gdalwarp -tr SIZE SIZE";
  else if (const double high = std::abs(map[5]); std::abs(high - map[1]) > 1e-6 * map[1])
    text << "must have square cells, but they are " << map[1] << " wide and " << high
         << " high; resample it, such as by gdalwarp -tr " << std::min(map[1], high) << " " << std::min(map[1], high);
  if (!text.str().empty()) complain(file, text.str());
}

/// Metres as far as elevations tell, or a complaint.
void check_elevations(const Grid &grid) {
  const std::string &unit = grid.unit;
  if (!unit.empty() && unit != "m" && unit != "metre" && unit != "meter" && unit != "metres" && unit != "meters")
    complain(grid.file, "has elevations in " + unit + "; convert them to metres first");
  if (!grid.projection.empty() || std::abs(grid.west) > 360 || std::abs(grid.east()) > 360 ||
      std::abs(grid.south) > 90 || std::abs(grid.north()) > 90)
    return;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double z : grid.values)
    if (!std::isnan(z)) low = std::min(low, z), high = std::max(high, z);
  const double extent = std::max(grid.columns, grid.rows) * grid.spacing;
  if (high - low <= 10 * extent) return;
  std::ostringstream text;
  text << "is " << extent << " wide and " << high - low << " m high, so that its coordinates seem to be degrees; "
       << to_metres;
  complain(grid.file, text.str());
}

/// The values of a band, from the southwest; not a number where it says that it has none. Rows are read in the order of
/// the file: GDAL finds a row of ESRI ASCII by those before it, and tries in vain again and again, for each of them
/// that a file which ends early has not, before it complains of a later one.
void read_values(GDALRasterBand &band, bool from_north, Grid &grid) {
  grid.values.resize(static_cast<std::size_t>(grid.columns) * grid.rows);
  CPLErrorReset();
  bool complete = true;
  for (int line = 0; line < grid.rows && complete; ++line) {
    const std::size_t row = from_north ? grid.rows - 1 - line : line;
    complete = band.RasterIO(GF_Read, 0, line, grid.columns, 1, &grid.values[row * grid.columns], grid.columns, 1,
                             GDT_Float64, 0, 0, nullptr) == CE_None;
  }
  if (!complete)
    complain(grid.file, "ends early or is damaged, so that not all of its " + std::to_string(grid.rows) + " rows of " +
                            std::to_string(grid.columns) +
                            " values can be read; fetch or write it again (GDAL: " + CPLGetLastErrorMsg() + ")");
  int has_hole = 0;
  const double hole = band.GetNoDataValue(&has_hole), scale = band.GetScale(), offset = band.GetOffset();
  const bool single = band.GetRasterDataType() == GDT_Float32;  // the value of a hole is written in more digits
  const auto missing = [&](double z) {
    return !std::isfinite(z) ||
           (has_hole && (z == hole || (single && static_cast<float>(z) == static_cast<float>(hole))));
  };
  for (double &z : grid.values) z = missing(z) ? std::numeric_limits<double>::quiet_NaN() : offset + scale * z;
  if (scale == 1 && offset == 0) return;
  std::ostringstream text;
  text << grid.file << ": values are " << scale << " times those stored plus " << offset
       << ", by the scale and the offset that the file gives its band";
  grid.remarks.push_back(text.str());
}

/// GDAL reads as many values of an ESRI ASCII grid as its header names, wherever its lines end, and leaves the rest.
void check_count(const Grid &grid) {
  std::ifstream in(grid.file);
  std::string line, word;
  long long values = 0, wide = 0;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    if (!(words >> word) || (std::isalpha(static_cast<unsigned char>(word[0])) && values == 0)) continue;
    long long here = 1;
    while (words >> word) ++here;
    values += here, wide = std::max(wide, here);
  }
  const long long named = static_cast<long long>(grid.rows) * grid.columns;
  if (values > named)
    complain(grid.file, "holds " + std::to_string(values) + " values, of up to " + std::to_string(wide) +
                            " in a line, where its header says " + std::to_string(grid.rows) + " rows of " +
                            std::to_string(grid.columns) + ", " + std::to_string(named) +
                            " values; correct nrows and ncols, or write the file again");
}

}  // namespace

Grid read_grid(const std::string &file) {
  if (!std::filesystem::exists(file)) complain(file, "cannot be opened; check the path");
  GDALAllRegister();
  CPLSetConfigOption("AAIGRID_DATATYPE", "Float64");  // GDAL reads ESRI ASCII in single precision else
  const QuietGdal quiet;                              // of a file that ends early GDAL complains once for each line
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!data)
    complain(file, "is no grid that GDAL reads; give ESRI ASCII (.asc) or GeoTIFF (.tif)" +
                       (*CPLGetLastErrorMsg() ? ": " + std::string(CPLGetLastErrorMsg()) : ""));
  Grid grid;
  grid.file = file, grid.columns = data->GetRasterXSize(), grid.rows = data->GetRasterYSize();
  double map[6];  // west, dx/column, dx/row, north, dy/column, dy/row
  if (data->GetGeoTransform(map) != CE_None)
    complain(file, "does not say where it lies; give a file with coordinates, such as a GeoTIFF with its tags");
  check_projection(grid, map, data->GetSpatialRef());  // first, since degrees are seldom square
  check_cells(file, map);
  if (grid.columns < 2 || grid.rows < 2) complain(file, "must have 2 rows and columns at least");
  grid.spacing = map[1];
  const bool from_north = map[5] < 0;
  grid.west = map[0] + map[1] / 2;
  grid.south = (from_north ? map[3] + grid.rows * map[5] : map[3]) + grid.spacing / 2;
  GDALRasterBand *band = data->GetRasterBand(1);
  grid.unit = band->GetUnitType();
  if (const int bands = data->GetRasterCount(); bands > 1) {
    const std::string name = band->GetDescription();
    grid.remarks.push_back(file + ": of its " + std::to_string(bands) + " bands the first is taken" +
                           (name.empty() ? "" : ", `" + name + "`") +
                           "; another one makes a file of its own by gdal_translate -b NUMBER");
  }
  read_values(*band, from_north, grid);
  if (std::string(data->GetDriver()->GetDescription()) == "AAIGrid") check_count(grid);
  if (const char *text = data->GetProjectionRef()) grid.projection = text;
  return grid;
}

Grid read_elevations(const std::string &file) {
  Grid grid = read_grid(file);
  check_elevations(grid);
  return grid;
}

void check_same_projection(const Location &here, const std::string &projection, const std::string &of) {
  if (here.projection.empty() || projection.empty() || here.projection == projection) return;
  OGRSpatialReference own, other;
  if (own.importFromWkt(here.projection.c_str()) != OGRERR_NONE ||
      other.importFromWkt(projection.c_str()) != OGRERR_NONE)
    return;
  for (OGRSpatialReference *one : {&own, &other}) {
    if (one->IsLocal()) return;  // a name without a place on the earth
    one->StripVertical();
    one->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  }
  const char *const options[] = {"CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS",
                                 "IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", nullptr};
  if (own.IsSame(&other, options)) return;
  // one definition has many spellings, of which places tell more than names
  const QuietGdal quiet;
  const std::unique_ptr<OGRCoordinateTransformation> to_other(OGRCreateCoordinateTransformation(&own, &other));
  auto [x, y] = here.middle;
  const bool near =
      to_other && to_other->Transform(1, &x, &y) && std::hypot(x - here.middle[0], y - here.middle[1]) < here.near;
  if (near) return;
  const auto name = [](const OGRSpatialReference &one) {
    const char *text = one.GetName();
    return std::string(text ? text : "one without a name");
  };
  complain(here.file, "has the projection " + name(own) + ", and " + of + " has " + name(other) +
                          ", in which the same place has other coordinates; project it to that by " +
                          (here.vector ? "ogr2ogr -t_srs, or correct what the file says by ogr2ogr -a_srs"
                                       : "gdalwarp -t_srs, or correct what the file says by gdal_edit.py -a_srs"));
}

std::array<double, 2> map_scale(const Location &location) {
  constexpr double not_known = std::numeric_limits<double>::quiet_NaN(), radian = 3.14159265358979323846 / 180;
  constexpr double half = 50;  // of the lengths that are compared [m]
  std::array<double, 2> scale{not_known, not_known};
  OGRSpatialReference map;
  const QuietGdal quiet;
  if (location.projection.empty() || map.importFromWkt(location.projection.c_str()) != OGRERR_NONE) return scale;
  map.StripVertical();
  if (!map.IsProjected()) return scale;
  const std::unique_ptr<OGRSpatialReference> earth(map.CloneGeogCS());
  if (!earth) return scale;
  map.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER), earth->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> to_earth(OGRCreateCoordinateTransformation(&map, earth.get()));
  if (!to_earth) return scale;
  const double inverse = earth->GetInvFlattening(), flattening = inverse > 0 ? 1 / inverse : 0,
               eccentricity = flattening * (2 - flattening);  // squared
  for (int d = 0; d < 2; ++d) {
    double x[] = {location.middle[0], location.middle[0]}, y[] = {location.middle[1], location.middle[1]};
    (d == 0 ? x : y)[0] -= half, (d == 0 ? x : y)[1] += half;
    if (!to_earth->Transform(2, x, y)) continue;
    const double latitude = (y[0] + y[1]) / 2 * radian, w = 1 - eccentricity * std::pow(std::sin(latitude), 2);
    const double across = earth->GetSemiMajor() / std::sqrt(w), along = across * (1 - eccentricity) / w;  // radii
    const double length = std::hypot(across * std::cos(latitude) * std::remainder(x[1] - x[0], 360) * radian,
                                     along * (y[1] - y[0]) * radian);
    if (length > 0 && std::isfinite(length)) scale[d] = 2 * half / length;
  }
  return scale;
}

void write_values(const Grid &grid, const std::string &file) {
  std::ofstream out(file, std::ios::binary);
  out.precision(17);
  out << grid.columns << " " << grid.rows << " " << grid.west << " " << grid.south << " " << grid.spacing << "\n";
  out.write(reinterpret_cast<const char *>(grid.values.data()),
            static_cast<std::streamsize>(grid.values.size() * sizeof(double)));
  if (!out.flush()) complain(file, "cannot be written; check the folder and its free space");
}

}  // namespace talus
