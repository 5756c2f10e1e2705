#include "meshes/outline.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "meshes/polygon.h"

namespace talus {
namespace {

[[noreturn]] void complain(const std::string &file, const std::string &text) {
  throw std::invalid_argument(file + ": " + text);
}

bool is_collection(const OGRGeometry &geometry) {
  const auto type = wkbFlatten(geometry.getGeometryType());
  return type == wkbMultiPolygon || type == wkbGeometryCollection;
}

/// " at (x, y)" where a message of GDAL names a point.
std::string place_in(const std::string &message) {
  const std::size_t point = message.find("point ");
  double x = 0, y = 0;
  if (point == std::string::npos || std::sscanf(message.c_str() + point, "point %lf %lf", &x, &y) != 2) return "";
  std::ostringstream text;
  text.precision(9);
  text << " at (" << x << ", " << y << ")";
  return text.str();
}

/// The polygons of a geometry, of whatever kind. Throws std::invalid_argument for one that crosses itself.
void add_polygons(const std::string &file, const OGRGeometry &geometry, OGRMultiPolygon &polygons) {
  if (is_collection(geometry)) {
    for (const OGRGeometry *part : *geometry.toGeometryCollection()) add_polygons(file, *part, polygons);
  } else if (wkbFlatten(geometry.getGeometryType()) == wkbPolygon) {
    std::unique_ptr<OGRGeometry> flat(geometry.clone());
    flat->flattenTo2D();
    CPLErrorReset();
    if (!flat->IsValid())
      complain(file, "has a polygon that crosses itself" + place_in(CPLGetLastErrorMsg()) +
                         ", or whose holes do; mend it, such as by ogr2ogr -makevalid");
    polygons.addGeometryDirectly(flat.release());
  }
}

bool beyond_degrees(const OGRGeometry &geometry) {
  OGREnvelope extent;
  geometry.getEnvelope(&extent);
  return std::max({std::abs(extent.MinX), std::abs(extent.MaxX), std::abs(extent.MinY), std::abs(extent.MaxY)}) > 360;
}

void add_rings(const OGRGeometry &geometry, Outline &outline) {
  if (is_collection(geometry)) {
    for (const OGRGeometry *part : *geometry.toGeometryCollection()) add_rings(*part, outline);
  } else if (wkbFlatten(geometry.getGeometryType()) == wkbPolygon) {
    const int number = outline.polygon.empty() ? 0 : outline.polygon.back() + 1;
    for (const OGRLinearRing *ring : *geometry.toPolygon()) {
      outline.rings.emplace_back(), outline.polygon.push_back(number);
      for (const OGRPoint &point : *ring) outline.rings.back().push_back({point.getX(), point.getY()});
    }
  }
}

/// The corner of the extent whose coordinates come before those of all points.
template <class Before>
std::array<double, 2> corner_of(const std::vector<std::vector<std::array<double, 2>>> &rings, Before before) {
  std::array<double, 2> corner = rings.front().front();
  for (const auto &ring : rings)
    for (const auto &point : ring)
      for (int d = 0; d < 2; ++d)
        if (before(point[d], corner[d])) corner[d] = point[d];
  return corner;
}

}  // namespace

std::vector<Outline> Outline::parts() const {
  std::vector<Outline> parts;
  for (std::size_t k = 0; k < rings.size(); ++k) {
    if (k == 0 || polygon[k] != polygon[k - 1]) parts.emplace_back().location = location;
    parts.back().rings.push_back(rings[k]), parts.back().polygon.push_back(0);
  }
  return parts;
}

double Outline::area() const {
  double sum = 0;
  for (std::size_t k = 0; k < rings.size(); ++k) {
    const bool hole = k > 0 && polygon[k] == polygon[k - 1];
    sum += (hole ? -1 : 1) * std::abs(signed_area({rings[k].begin(), rings[k].end()}));
  }
  return sum;
}

double Outline::perimeter() const {
  double sum = 0;
  for (const auto &ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const auto &a = ring[k], &b = ring[(k + 1) % ring.size()];
      sum += std::hypot(b[0] - a[0], b[1] - a[1]);
    }
  return sum;
}

std::array<double, 2> Outline::low() const { return corner_of(rings, std::less<>()); }
std::array<double, 2> Outline::high() const { return corner_of(rings, std::greater<>()); }

bool Outline::contains(double x, double y) const {
  bool inside = false;
  for (const auto &ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const auto &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
    }
  return inside;
}

bool Outline::touches(double x, double y, double near) const {
  for (const auto &ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const auto &a = ring[k], &b = ring[(k + 1) % ring.size()];
      bool beside = false;
      const double here[] = {x, y};
      for (int d = 0; d < 2; ++d)
        beside = beside || here[d] < std::min(a[d], b[d]) - near || here[d] > std::max(a[d], b[d]) + near;
      if (beside) continue;
      if (a == b || distance_to_segment({a[0], a[1]}, {b[0], b[1]}, {x, y}) <= near) return true;
    }
  return false;
}

std::array<double, 4> Outline::sides_around(double x, double y, double farthest) const {
  std::array<double, 4> nearest{farthest, farthest, farthest, farthest};
  const double here[] = {x, y};
  for (const auto &ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const auto &a = ring[k], &b = ring[(k + 1) % ring.size()];
      for (int d = 0; d < 2; ++d) {  // along this axis
        const int e = 1 - d;
        if ((a[e] > here[e]) == (b[e] > here[e])) continue;
        const double away = a[d] + (here[e] - a[e]) / (b[e] - a[e]) * (b[d] - a[d]) - here[d];
        double &one = nearest[2 * d + (away > 0)];
        one = std::min(one, std::abs(away));
      }
    }
  return nearest;
}

Outline read_outline(const std::string &file) {
  if (!std::filesystem::exists(file)) complain(file, "cannot be opened; check the path");
  GDALAllRegister();
  const QuietGdal quiet;
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  if (!data) complain(file, "is no file of outlines that GDAL reads; give a Shapefile (.shp) or a GeoPackage (.gpkg)");
  Outline outline;
  outline.location.file = file, outline.location.vector = true;
  OGRMultiPolygon polygons;
  for (OGRLayer *layer : data->GetLayers()) {
    const int before = polygons.getNumGeometries();
    for (const OGRFeatureUniquePtr &feature : *layer)
      if (const OGRGeometry *geometry = feature->GetGeometryRef()) add_polygons(file, *geometry, polygons);
    const OGRSpatialReference *reference = layer->GetSpatialRef();
    if (polygons.getNumGeometries() == before || !reference || !outline.location.projection.empty()) continue;
    if (reference->IsGeographic() && beyond_degrees(polygons)) continue;  // as GDAL names a GeoPackage without any
    if (reference->IsGeographic() || (reference->IsProjected() && std::abs(reference->GetLinearUnits() - 1) > 1e-9))
      complain(file, std::string("has coordinates in ") +
                         (reference->IsGeographic() ? "degrees" : "another unit than metres") +
                         "; project it to those of the terrain, such as by ogr2ogr -t_srs");
    char *text = nullptr;
    reference->exportToWkt(&text);
    outline.location.projection = text;
    CPLFree(text);
  }
  if (polygons.getNumGeometries() > 1) {  // what several cover is inside, though it is in two of them
    const std::unique_ptr<OGRGeometry> all(polygons.UnionCascaded());
    if (!all) complain(file, "has polygons that GDAL cannot unite; draw the outline as one polygon");
    add_rings(*all, outline);
  } else {
    add_rings(polygons, outline);
  }
  if (outline.rings.empty())
    complain(file, "has no polygons; draw the outline as a polygon, or make one of its lines by ogr2ogr or QGIS");
  const auto low = outline.low(), high = outline.high();
  outline.location.middle = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
  outline.location.near = 1;  // [m], less than any outline of a slide is known by
  return outline;
}

std::vector<double> bowl(const std::vector<char> &inside, const std::vector<std::array<double, 4>> &rim, int columns,
                         double deepest) {
  const int nodes = static_cast<int>(inside.size());
  std::vector<int> number(nodes, -1);
  int unknowns = 0;
  for (int k = 0; k < nodes; ++k)
    if (inside[k]) number[k] = unknowns++;
  std::vector<double> depth(nodes, 0);
  if (unknowns == 0) return depth;
  const auto beside = [&](int k, int side) {
    constexpr int along[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    const int i = k % columns + along[side][0], at = i + (k / columns + along[side][1]) * columns;
    return i >= 0 && i < columns && at >= 0 && at < nodes && inside[at] && rim[k][side] >= 1 ? at : -1;
  };
  // Shortley & Weller (1938): second differences with the distances to the rim, exact for a paraboloid
  constexpr double nearest = 1e-4;  // of the rim, so that no row is much larger than the others
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < nodes; ++k) {
    if (!inside[k]) continue;
    double own = 0;
    for (int side = 0; side < 4; ++side) {
      const double here = std::max(rim[k][side], nearest), opposite = std::max(rim[k][side ^ 1], nearest),
                   weight = 2 / (here * (here + opposite));
      own += weight;
      if (const int at = beside(k, side); at >= 0) entries.emplace_back(number[k], number[at], -weight);
    }
    entries.emplace_back(number[k], number[k], own);
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver;
  solver.compute(matrix);
  const Eigen::VectorXd found = solver.solve(Eigen::VectorXd::Ones(unknowns));
  for (int k = 0; k < nodes; ++k)
    if (inside[k]) depth[k] = found[number[k]];
  // the deepest place lies between nodes: on a parabola through the deepest node and those beside it
  const int lowest = static_cast<int>(std::max_element(depth.begin(), depth.end()) - depth.begin());
  double most = depth[lowest];
  for (const int side : {0, 2})
    if (const int a = beside(lowest, side), b = beside(lowest, side + 1); a >= 0 && b >= 0)
      if (const double bend = 2 * depth[lowest] - depth[a] - depth[b]; bend > 0)
        most += (depth[b] - depth[a]) * (depth[b] - depth[a]) / (8 * bend);
  for (double &one : depth) one *= deepest / most;
  return depth;
}

}  // namespace talus
