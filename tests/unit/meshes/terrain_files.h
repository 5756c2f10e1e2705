#pragma once
/// Terrain files that tests write, what Terrain says to them, and talus-mesh.
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <regex>
#include <sstream>

#include "meshes/terrain.h"

namespace talus::terrain_files {

using Elevation = std::function<double(double x, double y)>;
inline constexpr double east = 5000, south = 2000, spacing = 10;  // of the first elevation of the grids below
inline constexpr int columns = 21, rows = 17;
inline constexpr double radian = 3.14159265358979323846 / 180;

/// Falls to the east by 3 in 10.
inline double plane(double x, double) { return 100 - 0.3 * (x - east); }

struct Answer {
  int status;
  std::string text;
};

class TerrainFiles : public ::testing::Test {
 protected:
  const std::filesystem::path folder = std::filesystem::path(P_tmpdir) / ("talus_terrain_" + std::to_string(getpid()));
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::string in_folder(const std::string &name) const { return (folder / name).string(); }

  std::string ascii(const Elevation &elevation, const std::string &name = "a.asc", double cell = spacing,
                    double west = east, double bottom = south) const {
    std::ofstream file(in_folder(name));
    file.precision(12);
    file << "ncols " << columns << "\nnrows " << rows << "\nxllcenter " << west << "\nyllcenter " << bottom
         << "\ncellsize " << cell << "\nNODATA_value -9999\n";
    for (int j = rows - 1; j >= 0; --j)
      for (int i = 0; i < columns; ++i)
        file << elevation(west + i * cell, bottom + j * cell) << (i + 1 < columns ? " " : "\n");
    return in_folder(name);
  }

  /// The same as GeoTIFF of a projection, EPSG.
  std::string geotiff(
      const Elevation &elevation, int projection, double cell = spacing, double west = east, double bottom = south,
      int bands = 1, const std::function<void(GDALRasterBand &)> &describe = [](GDALRasterBand &) {}) const {
    GDALAllRegister();
    const std::unique_ptr<GDALDataset> data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        in_folder("a.tif").c_str(), columns, rows, bands, GDT_Float32, nullptr));
    describe(*data->GetRasterBand(1));
    double map[] = {west - cell / 2, cell, 0, bottom + (rows - 0.5) * cell, 0, -cell};
    data->SetGeoTransform(map);
    OGRSpatialReference reference;
    reference.importFromEPSG(projection);
    data->SetSpatialRef(&reference);
    std::vector<float> z;
    for (int j = rows - 1; j >= 0; --j)
      for (int i = 0; i < columns; ++i) z.push_back(static_cast<float>(elevation(west + i * cell, bottom + j * cell)));
    EXPECT_EQ(data->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, columns, rows, z.data(), columns, rows, GDT_Float32, 0,
                                               0, nullptr),
              CE_None);
    return in_folder("a.tif");
  }

  using Ring = std::vector<std::array<double, 2>>;
  /// A polygon, with its holes, of a GeoPackage.
  std::string package(const std::vector<Ring> &rings, int projection) const { return package_of({rings}, projection); }
  std::string package_of(const std::vector<std::vector<Ring>> &polygons, int projection) const {
    GDALAllRegister();
    const std::string file = in_folder("outline.gpkg");
    std::filesystem::remove(file);
    const std::unique_ptr<GDALDataset> data(
        GetGDALDriverManager()->GetDriverByName("GPKG")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    OGRSpatialReference reference;
    reference.importFromEPSG(projection);
    OGRLayer *layer = data->CreateLayer("slide", &reference, wkbPolygon);
    for (const std::vector<Ring> &rings : polygons) {
      OGRPolygon polygon;
      for (const Ring &places : rings) {
        OGRLinearRing ring;
        for (const auto &[x, y] : places) ring.addPoint(x, y);
        ring.closeRings();
        polygon.addRing(&ring);
      }
      OGRFeature feature(layer->GetLayerDefn());
      feature.SetGeometry(&polygon);
      EXPECT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
    }
    return file;
  }
  /// A circle with a round hole around its centre, radius 0 for none.
  std::string outline(double x, double y, double radius, double hole, int projection) const {
    std::vector<Ring> rings;
    for (const double r : {radius, hole}) {
      Ring ring;
      for (int k = 0; k < 90; ++k) ring.push_back({x + r * std::cos(k * 4 * radian), y + r * std::sin(k * 4 * radian)});
      if (r > 0) rings.push_back(ring);
    }
    return package(rings, projection);
  }

  static TerrainOptions options(const std::string &file) {
    TerrainOptions o;
    o.file = file, o.size = 20, o.air = 30;
    return o;
  }
  static std::string complaint(const TerrainOptions &o) {
    try {
      const Terrain terrain(o);
    } catch (const std::invalid_argument &error) {
      return error.what();
    }
    return "";
  }
  static void expect_words(const std::string &text, const std::vector<std::string> &words) {
    for (const std::string &word : words)
      EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
  }
  static bool doubts(const TerrainOptions &o, const std::string &word) {
    for (const std::string &sentence : Terrain(o).doubts())
      if (sentence.find(word) != std::string::npos) return true;
    return false;
  }

  /// Broken off after a minute, which nothing here takes.
  static Answer run(const std::string &arguments) {
    Answer answer{-1, ""};
    FILE *pipe = popen(("timeout 60 " TALUS_MESH " " + arguments + " 2>&1").c_str(), "r");
    if (!pipe) return answer;
    for (int c; (c = std::fgetc(pipe)) != EOF;) answer.text += static_cast<char>(c);
    answer.status = WEXITSTATUS(pclose(pipe));
    return answer;
  }
  /// Volume or area of a group in what talus-mesh prints; 0 where there is none.
  static double of_group(const Answer &answer, const std::string &name) {
    std::smatch found;
    const std::regex line("(region|group) " + name + ": \\d+ (cells|facets), (\\S+) m");
    return std::regex_search(answer.text, found, line) ? std::stod(found[3]) : 0;
  }
  static std::string content(const std::string &file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
};

}  // namespace talus::terrain_files
