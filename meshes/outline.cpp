#include "meshes/outline.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>

namespace talus {
namespace {

[[noreturn]] void complain(const std::string &file, const std::string &text) {
  throw std::invalid_argument(file + ": " + text);
}

void add_rings(const OGRGeometry &geometry, Outline &outline) {
  if (const auto type = wkbFlatten(geometry.getGeometryType());
      type == wkbMultiPolygon || type == wkbGeometryCollection) {
    for (const OGRGeometry *part : *geometry.toGeometryCollection()) add_rings(*part, outline);
  } else if (type == wkbPolygon) {
    for (const OGRLinearRing *ring : *geometry.toPolygon()) {
      outline.rings.emplace_back();
      for (const OGRPoint &point : *ring) outline.rings.back().push_back({point.getX(), point.getY()});
    }
  }
}

}  // namespace

bool Outline::contains(double x, double y) const {
  bool inside = false;
  for (const auto &ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const auto &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
    }
  return inside;
}

Outline read_outline(const std::string &file) {
  if (!std::filesystem::exists(file)) complain(file, "cannot be opened; check the path");
  GDALAllRegister();
  CPLPushErrorHandler(CPLQuietErrorHandler);
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  CPLPopErrorHandler();
  if (!data) complain(file, "is no file of outlines that GDAL reads; give a Shapefile (.shp) or a GeoPackage (.gpkg)");
  Outline outline;
  outline.location.file = file;
  for (OGRLayer *layer : data->GetLayers()) {
    const std::size_t before = outline.rings.size();
    for (const OGRFeatureUniquePtr &feature : *layer)
      if (const OGRGeometry *geometry = feature->GetGeometryRef()) add_rings(*geometry, outline);
    const OGRSpatialReference *reference = layer->GetSpatialRef();
    if (outline.rings.size() == before || !reference || !outline.location.projection.empty()) continue;
    if (reference->IsGeographic() || (reference->IsProjected() && std::abs(reference->GetLinearUnits() - 1) > 1e-9))
      complain(file, std::string("has coordinates in ") +
                         (reference->IsGeographic() ? "degrees" : "another unit than metres") +
                         "; project it to those of the terrain, such as by ogr2ogr -t_srs");
    char *text = nullptr;
    reference->exportToWkt(&text);
    outline.location.projection = text;
    CPLFree(text);
  }
  if (outline.rings.empty())
    complain(file, "has no polygons; draw the outline as a polygon, or make one of its lines by ogr2ogr or QGIS");
  constexpr double far = std::numeric_limits<double>::infinity();
  std::array<double, 2> low{far, far}, high{-far, -far};
  for (const auto &ring : outline.rings)
    for (const auto &point : ring)
      for (int d = 0; d < 2; ++d) low[d] = std::min(low[d], point[d]), high[d] = std::max(high[d], point[d]);
  outline.location.middle = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
  outline.location.near = 1;  // [m], less than any outline of a slide is known by
  return outline;
}

std::vector<double> bowl(const std::vector<char> &inside, int columns, double deepest) {
  const int nodes = static_cast<int>(inside.size());
  std::vector<int> number(nodes, -1);
  int unknowns = 0;
  for (int k = 0; k < nodes; ++k)
    if (inside[k]) number[k] = unknowns++;
  std::vector<double> depth(nodes, 0);
  if (unknowns == 0) return depth;
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < nodes; ++k) {
    if (!inside[k]) continue;
    entries.emplace_back(number[k], number[k], 4);
    const int column = k % columns;
    for (const int beside : {column > 0 ? k - 1 : -1, column + 1 < columns ? k + 1 : -1, k - columns, k + columns})
      if (beside >= 0 && beside < nodes && inside[beside]) entries.emplace_back(number[k], number[beside], -1);
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd found = solver.solve(Eigen::VectorXd::Ones(unknowns)),
                        scaled = found * (deepest / found.maxCoeff());
  for (int k = 0; k < nodes; ++k)
    if (inside[k]) depth[k] = scaled[number[k]];
  return depth;
}

}  // namespace talus
