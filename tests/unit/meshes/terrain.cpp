// Terrain files: what is read, cut out and refused; and the meshes that talus-mesh makes of them.
#include "meshes/terrain.h"

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

namespace talus {
namespace {

using Elevation = std::function<double(double x, double y)>;
constexpr double east = 5000, south = 2000, spacing = 10;  // of the first elevation of the grids below
constexpr int columns = 21, rows = 17;
constexpr double radian = 3.14159265358979323846 / 180;

/// Falls to the east by 3 in 10.
double plane(double x, double) { return 100 - 0.3 * (x - east); }

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

/// Rows of the file run from north to south, and its elevations are those of the centres of cells.
TEST_F(TerrainFiles, HaveTheirElevationsWhereTheFormulaHasThem) {
  const Elevation formula = [](double x, double y) { return 50 + 0.2 * (x - east) - 0.1 * (y - south); };
  for (const std::string &file : {ascii(formula), geotiff(formula, 31254)}) {
    const Grid grid = read_grid(file);
    EXPECT_NEAR(grid.west, east, 1e-9);
    EXPECT_NEAR(grid.south, south, 1e-9);
    EXPECT_NEAR(grid.at(east + 33, south + 77), formula(east + 33, south + 77), 1e-4);
    EXPECT_TRUE(std::isnan(grid.at(east - 1, south)));
  }
  EXPECT_NE(read_grid(in_folder("a.tif")).projection.find("31254"), std::string::npos);
  EXPECT_EQ(read_grid(in_folder("a.asc")).projection, "");
}

TEST_F(TerrainFiles, GiveTheirWindowAndEveryOtherRow) {
  TerrainOptions o = options(ascii([](double x, double y) { return x + 3 * y; }));
  o.window = {east + 20, south + 30, east + 140, south + 110}, o.step = 2;
  const Terrain terrain(o);
  EXPECT_EQ(terrain.columns(), 7);
  EXPECT_EQ(terrain.rows(), 5);
  EXPECT_DOUBLE_EQ(terrain.x(6), 120);
  EXPECT_DOUBLE_EQ(terrain.y(4), 80);
  EXPECT_DOUBLE_EQ(terrain.ground_at(20, 40), east + 40 + 3 * (south + 70));
  expect_words(terrain.origin_document(), {"\"origin_m\": [5020, 2030]", "a.asc"});
}

/// Dip direction is the azimuth towards which the surface dips: points on the lower side, by vectors written out.
TEST_F(TerrainFiles, MeetAnEllipsoidThatDipsWhereItShould) {
  const double c = std::cos(30 * radian), s = std::sin(30 * radian);
  const struct {
    double direction;
    std::array<double, 3> first, second, third;
  } cases[] = {{90, {c, 0, -s}, {0, 1, 0}, {s, 0, c}},      // east
               {0, {0, c, -s}, {1, 0, 0}, {0, s, c}},       // north
               {180, {0, -c, -s}, {1, 0, 0}, {0, -s, c}}};  // south
  for (const auto &one : cases) {
    const Ellipsoid e{{100, 200, 50}, {30, 20, 10}, 30 * radian, one.direction * radian};
    for (const auto &[u, v] : {std::pair{0., 0.}, {0.3, 0.2}, {-0.4, 0.3}, {0.2, -0.6}}) {
      const double w = -std::sqrt(1 - u * u - v * v);
      std::array<double, 3> x = e.centre;
      for (int d = 0; d < 3; ++d) x[d] += 30 * u * one.first[d] + 20 * v * one.second[d] + 10 * w * one.third[d];
      EXPECT_NEAR(e.bottom(x[0], x[1]), x[2], 1e-9) << one.direction;
    }
    EXPECT_TRUE(std::isnan(e.bottom(140, 240)));
  }
}

/// Half an ellipsoid below level ground; the grid cuts its rim in steps.
TEST_F(TerrainFiles, SlideWithTheVolumeOfAnEllipsoid) {
  TerrainOptions o = options(ascii([](double, double) { return 50; }, "a.asc", 2));
  o.ellipsoid = Ellipsoid{{east + 20, south + 16, 50}, {15, 12, 6}, 0, 0.3};
  const Terrain terrain(o);
  const double pi = 180 * radian;
  EXPECT_NEAR(terrain.slide_volume() / (2. / 3 * pi * 15 * 12 * 6), 1, 0.02);
  EXPECT_NEAR(terrain.slide_area() / (pi * 15 * 12), 1, 0.04);
  EXPECT_NEAR(terrain.bed_at(20, 16), 44, 1e-9);
}

TEST_F(TerrainFiles, DoubtWhatIsRarelyMeant) {
  TerrainOptions o = options(ascii(plane));
  o.ellipsoid = Ellipsoid{{east + 100, south + 80, 70}, {60, 40, 20}, 17 * radian, 90 * radian};
  EXPECT_FALSE(doubts(o, "into the slope"));
  EXPECT_TRUE(doubts(o, "is not resolved"));  // 20 m cells, 13 m of soil
  o.ellipsoid->dip_direction = 270 * radian;
  EXPECT_TRUE(doubts(o, "dips towards 270 degrees from north, into the slope, which falls towards 90 degrees"));
  o.size = 4;
  EXPECT_FALSE(doubts(o, "is not resolved"));
  EXPECT_TRUE(doubts(o, "show no more"));
  EXPECT_FALSE(doubts(o, "reaches the edge"));
  o.ellipsoid->centre[0] = east + 180;
  o.ellipsoid->centre[2] = plane(east + 180, 0);
  EXPECT_TRUE(doubts(o, "reaches the edge of the window at (5200, "));
}

TEST_F(TerrainFiles, AreRefusedWithHoles) {
  TerrainOptions o =
      options(ascii([](double x, double y) { return x == east + 30 && y > south + 100 ? -9999. : 50.; }));
  expect_words(complaint(o), {"no data at 6 of 357 places", "(5030, 2110)", "gdal_fillnodata.py", "--window"});
  o.window = {east + 40, south, east + 200, south + 160};
  EXPECT_EQ(complaint(o), "");
}
TEST_F(TerrainFiles, AreRefusedInDegreesAndFeet) {
  const Elevation hill = [](double, double y) { return 1000 + 1e4 * (y - 47); };
  expect_words(complaint(options(ascii(hill, "d.asc", 0.001, 10.2, 47))),
               {"seem to be degrees", "project it to metres"});
  expect_words(complaint(options(geotiff(hill, 4326, 0.001, 10.2, 47))),
               {"coordinates in degrees", "project it to metres"});
  expect_words(complaint(options(geotiff(plane, 4326))), {"says that its coordinates are degrees", "gdal_edit.py"});
  const std::string file = geotiff(hill, 4326, 0.001, 10.2, 47);
  {  // degrees are seldom square
    const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
    double map[] = {10.2, 0.0015, 0, 47.016, 0, -0.001};
    data->SetGeoTransform(map);
  }
  expect_words(complaint(options(file)), {"coordinates in degrees", "project it to metres"});
  expect_words(complaint(options(geotiff(plane, 2225))), {"US survey foot", "project it to metres"});
}
TEST_F(TerrainFiles, AreRefusedWithCellsThatAreNotSquareOrTurned) {
  const auto with = [&](double dx_row, double dy_column, double dy_row) {
    const std::string file = geotiff(plane, 31254);
    const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
    double map[] = {east, 10, dx_row, south, dy_column, dy_row};
    data->SetGeoTransform(map);
    return options(file);
  };
  expect_words(complaint(with(0, 0, -20)), {"a.tif: must have square cells, but they are 10 wide and 20 high; resample "
                                            "it, such as by gdalwarp -tr 10 10"});
  expect_words(complaint(with(1, 2, -10)), {"a.tif: must have rows from west to east, but from one column to the next "
                                            "x changes by 10 and y by 2, and from one row to the next by 1 and -10"});
}
TEST_F(TerrainFiles, AreRefusedWhereTheyDoNotFit) {
  TerrainOptions o = options(ascii(plane));
  o.window = {east - 10, south, east + 100, south + 100};
  expect_words(complaint(o),
               {"--window 4990 2000 5100 2100 reaches out of the grid", "(5000, 2000) to (5200, 2160) m"});
  o.window = {east + 100, south, east, south + 100};
  expect_words(complaint(o), {"east > west"});
  o.window.clear(), o.step = 20;
  expect_words(complaint(o), {"smaller --step"});
  o.step = 1, o.base = 41;
  expect_words(complaint(o), {"--base 41 m must lie below the lowest ground, which is at 40 m, at (5200, 2000)"});
  o.base.reset(), o.air = 0;
  expect_words(complaint(o), {"--air must be above 0 m"});
  o.air = 30, o.size = 500;
  expect_words(complaint(o), {"--size 500 m is larger than the window"});
  o.size = 20, o.slip_surface = ascii([](double x, double y) { return plane(x, y) + 2; }, "slip.asc");
  expect_words(complaint(o), {"slip.asc lies above the ground everywhere, by 2 m", "lower it"});
  o.slip_surface = ascii(plane, "far.asc", 10, 9000);
  expect_words(complaint(o), {"does not lie in the window"});
  expect_words(complaint(options(in_folder("none.asc"))), {"none.asc: cannot be opened"});
  std::ofstream(in_folder("bad.asc")) << "no grid\n";
  expect_words(complaint(options(in_folder("bad.asc"))), {"bad.asc: is no grid that GDAL reads"});
}

/// Elevations stored as 0.1 z + 1000 are those of the formula, and a hole is told by its stored value.
TEST_F(TerrainFiles, HaveTheScaleAndOffsetOfTheirBand) {
  const std::string file = geotiff([](double x, double y) { return x == east ? -5 : (plane(x, y) - 1000) / 0.1; },
                                   31254, spacing, east, south, 2,
                                   [](GDALRasterBand &band) {
                                     band.SetScale(0.1), band.SetOffset(1000), band.SetNoDataValue(-5);
                                     band.SetDescription("ground");
                                   });
  const Grid grid = read_grid(file);
  EXPECT_NEAR(grid.at(east + 100, south + 50), plane(east + 100, 0), 1e-3);  // stored in single precision
  EXPECT_TRUE(std::isnan(grid.at(east, south)));
  ASSERT_EQ(grid.remarks.size(), 2u);
  expect_words(grid.remarks[0], {"of its 2 bands the first is taken, `ground`", "gdal_translate -b"});
  expect_words(grid.remarks[1], {"values are 0.1 times those stored plus 1000"});
  TerrainOptions o = options(file);
  o.window = {east + 10, south, east + 200, south + 160};
  EXPECT_TRUE(doubts(o, "0.1 times those stored plus 1000"));
}

/// One sentence, and not one of GDAL for each row that is missing.
TEST_F(TerrainFiles, AreRefusedWhenTheyEndEarly) {
  const std::string file = ascii(plane);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  const Answer answer = run(file + " -o " + in_folder("m.msh") + " --size 20 --air 20");
  EXPECT_EQ(answer.status, 2);
  expect_words(answer.text, {"a.asc: ends early or is damaged, so that not all of its 17 rows"});
  EXPECT_EQ(std::count(answer.text.begin(), answer.text.end(), '\n'), 1) << answer.text;
}

/// At once, however many rows are missing, and wherever the grid is read: GDAL's search for a row that is not there
/// doubles with each of them.
TEST_F(TerrainFiles, AreRefusedAtOnceWhenMostOfThemIsMissing) {
  std::ofstream(in_folder("begun.asc")) << "ncols 3\nnrows 500\nxllcenter " << east << "\nyllcenter " << south
                                        << "\ncellsize 10\n90 80 70\n90 80 70\n";
  const std::string begun = in_folder("begun.asc"), mesh = " -o " + in_folder("m.msh"), cells = " --size 20 --air 20";
  for (const std::string &arguments :
       {begun + mesh + cells, begun + mesh + " --values", ascii(plane) + mesh + cells + " --slip-surface " + begun}) {
    const Answer answer = run(arguments);
    EXPECT_EQ(answer.status, 2) << arguments;  // 124: it was still reading
    expect_words(answer.text, {"begun.asc: ends early or is damaged, so that not all of its 500 rows of 3 values"});
  }
}

/// Elevations that no ground has, on a slope and on rough ground; the roughness itself passes, and so does a cliff.
TEST_F(TerrainFiles, AreRefusedWithSpikes) {
  const auto with = [&](double value, const Elevation &elevation) {
    return options(
        ascii([=](double x, double y) { return x == east + 60 && y == south + 50 ? value : elevation(x, y); }));
  };
  const Elevation rough = [](double x, double y) { return plane(x, y) + 4 * std::sin(x) * std::cos(y) + 200; };
  for (const Elevation &ground : {Elevation(plane), rough})
    for (const double value : {9999., -9998., 0.}) {
      std::ostringstream words;
      words << "the elevation " << value << " m at (5060, 2050) stands ";
      expect_words(complaint(with(value, ground)), {words.str(), "gdal_translate -a_nodata", "gdal_fillnodata.py"});
    }
  EXPECT_EQ(complaint(with(plane(east + 60, 0) + 10, plane)), "");
  EXPECT_EQ(complaint(options(ascii(rough))), "");
  const Elevation wild = [](double x, double y) { return plane(x, y) + 30 * std::sin(x) * std::cos(y); };
  EXPECT_EQ(complaint(options(ascii(wild))), "") << "places stand out by more than two spacings, and so do all others";
  EXPECT_EQ(complaint(options(ascii([](double x, double y) { return plane(x, y) + (x < east + 90 ? 80 : 0); }))), "");
  const Elevation half = [](double x, double y) { return x < east + 90 ? -9998 : plane(x, y); };
  expect_words(complaint(options(ascii(half))), {"the elevation -9998 m at (5080, ", "lower than the place beside it"});
  TerrainOptions o = options(ascii(plane));
  o.slip_surface = ascii([](double x, double y) { return x > east + 100 ? -9998 : plane(x, y) - 5; }, "slip.asc");
  expect_words(complaint(o), {"slip.asc: the elevation -9998 m"});
}

/// The wall behind an ellipsoid that dips into a steep slope is no spike: what is wrong is the dip, or the elevation.
TEST_F(TerrainFiles, DoubtTheEllipsoidAndNotTheGround) {
  TerrainOptions o = options(ascii([](double x, double) { return 1000 - 0.8 * (x - east); }));
  o.size = 5;
  o.ellipsoid = Ellipsoid{{east + 100, south + 80, 920}, {80, 60, 15}, 39 * radian, 270 * radian};
  EXPECT_EQ(complaint(o), "");
  EXPECT_TRUE(doubts(o, "dips towards 270 degrees from north, into the slope, which falls towards 90 degrees"));
  o.ellipsoid->dip_direction = 90 * radian;
  EXPECT_FALSE(doubts(o, "into the slope"));
  o.ellipsoid->centre[2] = 780;
  expect_words(complaint(o), {"the ellipsoid lies wholly below the ground"});
}

/// Slip surfaces that no slide has.
TEST_F(TerrainFiles, DoNotMeetImpossibleSlipSurfaces) {
  const Elevation bowl = [](double x, double y) {
    return 12 - 0.005 * (std::pow(x - 5080, 2) + std::pow(y - 2080, 2));  // depth below the plane, to a radius of 49 m
  };
  const Elevation high = [](double x, double y) { return plane(x, y) + 1100; };
  TerrainOptions o = options(ascii(high));
  o.size = 4;
  o.slip_surface = ascii(bowl, "depth.asc");
  expect_words(complaint(o), {"depth.asc reaches up to 12 m only", "thick", "Are these depths?"});
  const auto slip = [&](const Elevation &hides) {
    return ascii([&](double x, double y) { return hides(x, y) > 0 ? -9999 : high(x, y) - bowl(x, y); }, "slip.asc");
  };
  o.slip_surface = slip([](double, double) { return 0; });
  EXPECT_FALSE(doubts(o, "wall"));
  o.slip_surface = slip([](double x, double) { return x - east - 80; });  // ends in the middle
  EXPECT_TRUE(doubts(o, "slip.asc ends 12 m below the ground at (5080, 2080), and it is 12 m deep at most"));
  o.slip_surface = slip([](double x, double y) { return x == east + 70 && y == south + 80; });  // a hole
  EXPECT_TRUE(doubts(o, "vertical wall"));
  o.slip_surface = ascii([&](double x, double y) { return high(x, y) - 60; }, "slip.asc");
  expect_words(complaint(o), {"slip.asc lies below the ground everywhere, by 60 m at least and 60 m on average"});
  o.slip_surface = ascii([&](double x, double y) { return high(x, y) - 3; }, "slip.asc");  // loose soil, all of it
  EXPECT_TRUE(doubts(o, "slip.asc lies below the ground everywhere, by 3 m at least"));
  o.slip_surface.clear();
  o.ellipsoid = Ellipsoid{{east + 100, south + 80, 1170}, {60, 40, 20}, 17 * radian, 90 * radian};
  EXPECT_FALSE(doubts(o, "wall"));
  o.ellipsoid->centre[2] = 1160;  // a dome still comes out
  EXPECT_TRUE(doubts(o, "the ellipsoid ends 11.8 m below"));
  o.ellipsoid->centre[2] = 1140;
  expect_words(complaint(o), {"lies wholly below the ground", "50.", "raise its centre"});
}

/// Which of the two is in feet no file says: both are named, and not a place that stands out.
TEST_F(TerrainFiles, AreNotMixedInFeetAndMetres) {
  const Elevation high = [](double x, double y) { return plane(x, y) + 600; };
  const Elevation slip = [&](double x, double y) {
    const double depth = 12 - 0.005 * (std::pow(x - 5080, 2) + std::pow(y - 2080, 2));
    return depth > -3 ? high(x, y) - depth : -9999;
  };
  const auto feet = [](const Elevation &of) {
    return [of](double x, double y) { return of(x, y) < 0 ? -9999 : of(x, y) / 0.3048; };
  };
  TerrainOptions o = options(ascii(feet(high)));
  o.size = 4, o.slip_surface = ascii(slip, "slip.asc");
  expect_words(complaint(o), {"slip.asc has the elevation ", " m at (5", ", where ", "a.asc has ",
                              "and everywhere 0.299 to 0.306 times those of the ground: one of the two seems to be in "
                              "feet. Convert it to metres"});
  o.file = ascii(high), o.slip_surface = ascii(feet(slip), "slip.asc");
  expect_words(complaint(o), {"one of the two seems to be in feet"});
  o.slip_surface = ascii(slip, "slip.asc");
  EXPECT_EQ(complaint(o), "");
  const Elevation low = [&](double x, double y) { return high(x, y) - 660; };  // 10 m above the sea and 3 m of it ...
  o.file = ascii([&](double x, double y) { return low(x, y) > 10 ? low(x, y) : 10; });
  o.slip_surface = ascii([&](double x, double) { return x > 5140 && x < 5180 ? 3. : -9999; }, "slip.asc");
  EXPECT_EQ(complaint(o).find("feet"), std::string::npos) << "... are a slide that is not deep: " << complaint(o);
}

/// The rim of an ellipsoid is where both sides meet.
TEST_F(TerrainFiles, MeetAnEllipsoidUpToItsRim) {
  const Ellipsoid e{{100, 200, 50}, {30, 20, 10}, 30 * radian, 40 * radian};
  for (const double angle : {0., 1., 2.5, 4., 6.}) {
    const auto [x, y, z] = e.rim(angle);
    const double inside = 1 - 1e-10;  // towards the centre, where the root is real; sides part by its root, 1e-5
    const double u = 100 + inside * (x - 100), v = 200 + inside * (y - 200);
    EXPECT_NEAR(e.bottom(u, v), z, 1e-3);
    EXPECT_NEAR(e.top(u, v), z, 1e-3);
    EXPECT_TRUE(std::isnan(e.top(100 + 1.001 * (x - 100), 200 + 1.001 * (y - 200))));
  }
}

/// In a circle the bowl is a paraboloid, half as deep on average as in the middle.
TEST_F(TerrainFiles, SlideInAnOutline) {
  TerrainOptions o = options(geotiff([](double x, double) { return 500 - 0.3 * (x - east); }, 31254, 2));
  std::filesystem::rename(o.file, in_folder("terrain.tif"));
  o.file = in_folder("terrain.tif"), o.size = 2;
  o.outline = outline(east + 20, south + 16, 14.9, 0, 31254), o.depth = 6;
  const double circle = 180 * radian * 14.9 * 14.9;
  const Terrain bowl(o);
  // at nodes the depth is that of the paraboloid but for the sides of the polygon, 0.1 %; sums over 180 nodes, 2 m
  // apart
  EXPECT_NEAR(bowl.slide_area() / circle, 1, 0.03);
  EXPECT_NEAR(bowl.slide_volume() / (circle * 6 / 2), 1, 0.01);
  EXPECT_NEAR(bowl.ground_at(20, 16) - bowl.bed_at(20, 16), 6, 1e-9);
  EXPECT_NEAR(bowl.ground_at(28, 16) - bowl.bed_at(28, 16), 6 * (1 - std::pow(8. / 14.9, 2)), 0.01);
  EXPECT_TRUE(bowl.doubts().empty());
  o.bowl = false;
  EXPECT_NEAR(Terrain(o).slide_volume() / (circle * 6), 1, 0.03);
  o.outline = outline(east + 20, south + 16, 14.9, 7.45, 31254);
  EXPECT_NEAR(Terrain(o).slide_volume() / (circle * 6 * 0.75), 1, 0.03);
  o.depth = 0;
  expect_words(complaint(o), {"--depth must be above 0 m"});
  o.depth = 6, o.outline = outline(east + 500, south + 16, 14.9, 0, 31254);
  expect_words(complaint(o), {"outline.gpkg does not lie in the window"});
  o.outline = outline(east + 20, south + 16, 14.9, 0, 31255);
  expect_words(complaint(o), {"outline.gpkg: has the projection MGI / Austria GK Central", "ogr2ogr -t_srs"});
  o.outline = outline(east + 20, south + 16, 14.9, 0, 2225);
  expect_words(complaint(o), {"outline.gpkg: has coordinates in another unit than metres"});
  o.outline = outline(10, 47, 1, 0, 4326);
  expect_words(complaint(o), {"outline.gpkg: has coordinates in degrees"});
  o.slip_surface = in_folder("terrain.tif");
  expect_words(complaint(o), {"give one slip surface"});
  o.slip_surface.clear(), o.outline = ascii(plane);
  expect_words(complaint(o), {"a.asc: is no file of outlines that GDAL reads"});
}

/// What two polygons cover is inside, and so is one that is there twice.
TEST_F(TerrainFiles, OutlineOfSeveralPolygons) {
  TerrainOptions o = options(geotiff([](double x, double) { return 500 - 0.3 * (x - east); }, 31254, 2));
  std::filesystem::rename(o.file, in_folder("terrain.tif"));
  o.file = in_folder("terrain.tif"), o.size = 2, o.depth = 6, o.bowl = false;
  const auto box = [](double from, double to) {
    return Ring{{east + from, south + 4}, {east + to, south + 4}, {east + to, south + 20}, {east + from, south + 20}};
  };
  const auto volume = [&](const std::vector<std::vector<Ring>> &polygons) {
    o.outline = package_of(polygons, 31254);
    return Terrain(o).slide_volume();
  };
  EXPECT_NEAR(volume({{box(5, 19)}, {box(13, 29)}}), volume({{box(5, 29)}}), 1e-9);
  EXPECT_NEAR(volume({{box(5, 19)}, {box(5, 19)}}), volume({{box(5, 19)}}), 1e-9);
  EXPECT_NEAR(volume({{box(5, 11)}, {box(21, 29)}}), volume({{box(5, 11)}}) + volume({{box(21, 29)}}), 1e-9);
  const Ring crossed{{east + 4, south + 4}, {east + 20, south + 20}, {east + 20, south + 4}, {east + 4, south + 20}};
  o.outline = package({crossed}, 31254);
  expect_words(complaint(o), {"outline.gpkg: has a polygon that crosses itself", "makevalid"});
}

/// The volume is that of the outline wherever its middle lies between nodes, and with a radius of six nodes.
TEST_F(TerrainFiles, HaveTheVolumeOfAnOutlineBetweenNodes) {
  TerrainOptions o = options(ascii([](double, double) { return 500; }));
  for (const double radius : {60., 70.})
    for (const auto &[x, y] : {std::pair{100., 80.}, {103., 81.}, {105., 80.}, {105., 75.}, {98.3, 83.1}}) {
      o.outline = outline(east + x, south + y, radius, 0, 31254), o.depth = 15;
      EXPECT_NEAR(Terrain(o).slide_volume() / (180 * radian * radius * radius * 15 / 2), 1, 0.03)
          << radius << " " << x << " " << y;
    }
}

/// Sides on nodes, and turned by right angles: nodes on the outline count alike on all sides.
TEST_F(TerrainFiles, HaveOneVolumeInAllDirections) {
  const Ring corners{{-60, -30}, {40, -30}, {60, -10}, {60, 50}, {-20, 50}, {-20, 10}, {-60, 10}};
  const double area = 120 * 80 - 40 * 40 - 20 * 20 / 2;
  for (const bool bowl : {true, false}) {
    double first = 0;
    for (int turn = 0; turn < 4; ++turn) {
      Ring ring;
      for (const auto &[u, v] : corners) {
        const std::array<double, 2> turned[] = {{u, v}, {-v, u}, {-u, -v}, {v, -u}};
        ring.push_back({east + 100 + turned[turn][0], south + 80 + turned[turn][1]});
      }
      TerrainOptions o = options(ascii([](double, double) { return 500; }));
      o.outline = package({ring}, 31254), o.depth = 15, o.bowl = bowl;
      const double volume = Terrain(o).slide_volume();
      if (turn == 0) first = volume;
      EXPECT_NEAR(volume, first, 1e-6 * first) << bowl << " " << turn;
      if (bowl) continue;
      // by Pick's theorem: corners count as sides do, one cell too much in all
      EXPECT_NEAR(volume, (area + spacing * spacing) * 15, 1e-6 * volume);
    }
  }
}

/// Layers below grids: their cells have the volume between the grids, to half a cell at their borders.
TEST_F(TerrainFiles, HaveLayers) {
  const std::string clay = ascii([](double x, double y) { return plane(x, y) - 20; }, "clay.asc"),
                    rock = ascii([](double x, double) { return x > east + 50 ? 30 : -100; }, "rock.asc");
  const std::string arguments = ascii(plane) + " -o " + in_folder("m.msh") +
                                " --size 5 --far-size 8 --base 10 --window 5000 2000 5100 2080 --layer clay " + clay;
  const Answer answer = run(arguments + " --layer rock " + rock);
  EXPECT_EQ(answer.status, 0) << answer.text;
  EXPECT_NEAR(of_group(answer, "ground") / (100 * 80 * 20), 1, 0.02);
  EXPECT_NEAR(of_group(answer, "rock") / (45 * 80 * 20), 1, 0.05);
  EXPECT_NEAR(of_group(answer, "ground") + of_group(answer, "clay") + of_group(answer, "rock"), 100 * 80 * 75, 5);
  expect_words(run(arguments + " --layer rock " + ascii([](double, double) { return -100; }, "low.asc")).text,
               {"warning: layer rock has no cells"});
  const std::string deep = ascii([](double x, double y) { return plane(x, y) - 40; }, "deep.asc");
  expect_words(run(ascii(plane) + " -o " + in_folder("m.msh") +
                   " --size 10 --far-size 10 --base 10 --window 5000 2000 5100 2080 --layer clay " + deep +
                   " --layer rock " + clay)
                   .text,
               {"warning: layer clay has no cells: its surface, ", "lies below that of layer rock", "top to bottom"});
  TerrainOptions o = options(ascii(plane));
  o.layers = {{"clay", clay}};
  expect_words(complaint(o), {"--layer NAME FILE parts the ground over a flat base"});
  o.base = 0, o.layers = {{"slide", clay}};
  expect_words(complaint(o), {"slide is a group of the mesh already"});
  o.layers = {{"clay", ascii(plane, "far.asc", 10, 5050)}};
  expect_words(complaint(o), {"far.asc has no elevation at (5000, 2000), where layer clay needs one"});
}

/// A place without data counts only where it has a part in the value.
TEST(GridValues, NeedTheValuesThatCount) {
  Grid grid;
  grid.columns = 3, grid.rows = 2, grid.spacing = 10, grid.values = {1, 2, std::nan(""), 3, 4, std::nan("")};
  EXPECT_EQ(grid.at(10, 0), 2);
  EXPECT_EQ(grid.at(10, 5), 3);
  EXPECT_EQ(grid.at(5, 10), 3.5);
  EXPECT_TRUE(std::isnan(grid.at(11, 5)) && std::isnan(grid.at(20, 0)));
}

/// Cells are as small along the way as in the slide, and grow beside it.
TEST_F(TerrainFiles, AreFineAlongTheWay) {
  TerrainOptions o = options(ascii(plane));
  o.size = 4, o.far_size = 30;
  o.ellipsoid = Ellipsoid{{east + 50, south + 80, plane(east + 50, 0)}, {30, 20, 12}, 17 * radian, 90 * radian};
  EXPECT_TRUE(doubts(o, "cells grow to 30 m on the way"));
  o.halvings = 1;
  EXPECT_TRUE(doubts(o, "cells grow to 15 m (30 m with edges halved once) on the way"));
  o.halvings = 2;  // 7.5 m
  EXPECT_FALSE(doubts(o, "on the way"));
  o.halvings = 0;
  EXPECT_GT(Terrain(o).size_at(180, 80, 50), 15);
  o.way = {east + 50, south + 80, east + 120, south + 80, east + 200, south + 100}, o.way_width = 40;
  const Terrain terrain(o);
  EXPECT_FALSE(doubts(o, "on the way"));
  EXPECT_DOUBLE_EQ(terrain.size_at(100, 80, 70), 4);
  EXPECT_DOUBLE_EQ(terrain.size_at(160, 90, 50), 4);
  EXPECT_DOUBLE_EQ(terrain.size_at(100, 100, 70), 4);
  EXPECT_NEAR(terrain.size_at(100, 150, 70), 4 + 0.2 * 50, 1);
  EXPECT_FALSE(doubts(o, "the way leaves the terrain"));
  EXPECT_FALSE(doubts(o, "the mesh reaches"));
  o.air = 5;
  EXPECT_TRUE(doubts(o, "the mesh reaches 5 m above the ground (--air), and the slide is up to"));
  o.air = 30;
  o.way[4] += 30;
  EXPECT_TRUE(doubts(o, "the way leaves the terrain that is meshed: its point 3 is at x = 5230, y = "));
  o.way = {east + 180, south + 20, east + 190, south + 30}, o.way_width = 10;
  EXPECT_TRUE(doubts(o, "cells grow to 30 m on the way")) << "a way that the slide does not take";
  o.way = {east + 50, south + 85, east + 120, south + 85}, o.way_width = 2;
  EXPECT_FALSE(doubts(o, "cells grow to")) << "between two rows of the grid";
  o.way = {50, 80, 120, 80};
  expect_words(complaint(o), {"--way, which begins at x = 50, y = 80 m, lies beside the terrain that is meshed",
                              "from x = 5000 to 5200", "in the coordinates of the grid"});
  o.way.pop_back();
  expect_words(complaint(o), {"two points"});
  o.way = {1, 1, 2, 2}, o.way_width = 0;
  expect_words(complaint(o), {"--way-width must be above 0 m"});
}

/// A slip surface in another projection is refused; the same one by another name, or none, is not.
TEST_F(TerrainFiles, CompareProjections) {
  TerrainOptions o = options(geotiff(plane, 31254));
  std::filesystem::rename(o.file, in_folder("terrain.tif"));
  o.file = in_folder("terrain.tif"), o.size = 4;
  const Elevation slip = [](double x, double y) { return plane(x, y) - 0.01 * (200 - x + east); };
  o.slip_surface = geotiff(slip, 31255);
  expect_words(complaint(o), {"a.tif: has the projection MGI / Austria GK Central, and ",
                              "terrain.tif has MGI / Austria GK West", "gdalwarp -t_srs"});
  o.slip_surface = geotiff(slip, 31254);
  EXPECT_EQ(complaint(o), "");
  o.slip_surface = ascii(slip, "slip.asc");
  EXPECT_EQ(complaint(o), "");
  OGRSpatialReference west;
  west.importFromEPSG(31254), west.morphToESRI();
  char *text = nullptr;
  west.exportToWkt(&text);
  std::ofstream(in_folder("slip.prj")) << text;  // as other programs write it beside ESRI ASCII
  CPLFree(text);
  EXPECT_NE(read_grid(o.slip_surface).projection, "");
  EXPECT_EQ(complaint(o), "");
}

/// Soil and air over a flat base: volumes and areas of a plane are those of the formula.
TEST_F(TerrainFiles, BecomeMeshesOverAFlatBase) {
  const Answer answer = run(ascii(plane) + " -o " + in_folder("m.msh") +
                            " --size 25 --far-size 40 --base 10 --air 30 --window 5000 2000 5100 2080");
  EXPECT_EQ(answer.status, 0) << answer.text;
  EXPECT_NEAR(of_group(answer, "ground"), 100 * 80 * (85 - 10), 5);
  EXPECT_NEAR(of_group(answer, "air"), 100 * 80 * 30, 5);
  EXPECT_NEAR(of_group(answer, "base"), 8000, 0.1);
  EXPECT_NEAR(of_group(answer, "terrain"), 8000 * std::hypot(1, 0.3), 0.1);
  EXPECT_NEAR(of_group(answer, "top"), 8000 * std::hypot(1, 0.3), 0.1);
  EXPECT_NEAR(of_group(answer, "west"), 80 * (100 - 10 + 30), 0.1);
  EXPECT_NEAR(of_group(answer, "east"), 80 * (70 - 10 + 30), 0.1);
  EXPECT_NEAR(of_group(answer, "north"), of_group(answer, "south"), 0.1);
  expect_words(answer.text, {"smallest altitude", " m at (", "quality"});
  expect_words(content(in_folder("m.origin.json")), {"\"origin_m\": [5000, 2000]"});
}

/// The space above the bed: its cells of soil fill what lies between slip surface and ground.
TEST_F(TerrainFiles, BecomeMeshesAboveASlipSurface) {
  const std::string slip = ascii(
      [](double x, double y) { return plane(x, y) - 12 + 0.005 * (std::pow(x - 5080, 2) + std::pow(y - 2080, 2)); },
      "slip.asc");
  const std::string arguments =
      ascii(plane) + " -o " + in_folder("m.msh") + " --size 5 --far-size 15 --air 20 --slip-surface " + slip;
  const Answer answer = run(arguments);
  EXPECT_EQ(answer.status, 0) << answer.text;
  const double pi = 180 * radian, paraboloid = pi * 12 * 12 / (2 * 0.005);
  EXPECT_NEAR(of_group(answer, "slide") / paraboloid, 1, 0.04) << answer.text;
  EXPECT_NEAR((of_group(answer, "slide") + of_group(answer, "air")) / (200. * 160 * 20 + paraboloid), 1, 0.005);
  EXPECT_EQ(of_group(answer, "ground"), 0);
  EXPECT_EQ(of_group(answer, "terrain"), 0);
  EXPECT_GT(of_group(answer, "base"), 200 * 160 * std::hypot(1, 0.3));
  const std::string first = content(in_folder("m.msh"));
  run(arguments);
  EXPECT_EQ(first, content(in_folder("m.msh")));
}

TEST_F(TerrainFiles, AreToldFromSections) {
  const std::string file = ascii(plane), out = " -o " + in_folder("m.msh") + " --size 20 ";
  const Answer layers = run(file + out + "--air 20 --layers 2"), air = run(TALUS_SECTIONS "box.csv" + out + "--air 20");
  EXPECT_EQ(layers.status, 2);
  EXPECT_EQ(air.status, 2);
  expect_words(layers.text, {"--layers belongs to sections"});
  expect_words(air.text, {"--air belongs to terrain"});
  const Answer steep = run(file + out + "--air 20 --ellipsoid 5100 2080 70 30 30 10 95 0");
  EXPECT_EQ(steep.status, 2);
  expect_words(steep.text, {"dip from 0 to 90 degrees"});
}

}  // namespace
}  // namespace talus
