// Files of elevations: what is read, cut out and refused.
#include "tests/unit/meshes/terrain_files.h"

namespace talus::terrain_files {
namespace {

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
  expect_words(terrain.origin_document(), {"\"origin_m\":[5020.0,2030.0]", "\"spacing_m\":10.0,", "a.asc"});
}

/// The extent that gdalinfo prints is that of the cells, half a spacing wider than their centres; it begins in the
/// north.
TEST_F(TerrainFiles, GiveTheWindowThatGdalinfoPrints) {
  TerrainOptions o = options(ascii(plane));
  for (const std::vector<double> &window : {std::vector<double>{east - 5, south - 5, east + 205, south + 165},
                                            {east - 5, south + 165, east + 205, south - 5}}) {
    o.window = window;
    const Terrain terrain(o);
    EXPECT_EQ(terrain.columns(), columns);
    EXPECT_EQ(terrain.rows(), rows);
    EXPECT_DOUBLE_EQ(terrain.ground_at(200, 0), 40);
  }
}

/// Places without data are left out beside the slide and its way, with their volume; in it or on its way they are
/// refused.
TEST_F(TerrainFiles, MayHaveHolesBesideTheSlide) {
  const auto with_hole = [&](double x0, double x1, double y0, double y1) {
    return ascii([=](double x, double y) {
      return x >= east + x0 && x <= east + x1 && y >= south + y0 && y <= south + y1 ? -9999. : plane(x, y);
    });
  };
  const std::string file = with_hole(120, 150, 20, 50),
                    corner = " --size 8 --far-size 12 --air 20 -o " + in_folder("m.msh");
  const Answer answer = run(file + corner + " --ellipsoid 5050 2110 84.5 25 20 9 17 90");
  EXPECT_EQ(answer.status, 0) << answer.text;
  expect_words(answer.text,
               {"warning: ", "no data at 16 of 357 places, the first at (5120, 2020): cells", "group void"});
  EXPECT_NEAR((of_group(answer, "slide") + of_group(answer, "air")) / (20. * (200 * 160 - 50 * 50) + 10149), 1, 0.01)
      << answer.text;
  EXPECT_NEAR(of_group(answer, "void") / (4 * 50 * 20), 1.5, 0.5) << "its walls are as rough as cells";
  const Answer solid = run(file + corner + " --base 10");
  EXPECT_EQ(solid.status, 0) << solid.text;
  EXPECT_NEAR(of_group(solid, "ground") / (60 * 200 * 160 - 50 * 50 * (100 - 0.3 * 135 - 10)), 1, 0.01) << solid.text;
  TerrainOptions o = options(file);
  o.size = 5, o.ellipsoid = Ellipsoid{{east + 50, south + 110, 84.5}, {25, 20, 9}, 17 * radian, 90 * radian};
  EXPECT_EQ(complaint(o), "");
  o.way = {east + 50, south + 110, east + 135, south + 25}, o.way_width = 20;
  expect_words(complaint(o),
               {"a.asc: the window has no data at 16 of 357 places, and that at (5120, 2020) lies on the way",
                "gdal_fillnodata.py", "--window"});
  o.way = {east + 50, south + 110, east + 200, south + 110};
  EXPECT_EQ(complaint(o), "");
  o.file = with_hole(30, 40, 90, 100);
  expect_words(complaint(o), {"no data at 4 of 357 places, and that at (5040, 2090) lies in the slide or beside it"});
  expect_words(complaint(options(with_hole(-1, 1000, -1, 1000))), {"no data at 357 of 357 places, and nowhere at"});
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

/// Whose rows are longer or more than the header says: each row would begin where the one before ends.
TEST_F(TerrainFiles, AreRefusedWithMoreValuesThanTheirHeaderNames) {
  const std::string rows = "3\nxllcenter 0\nyllcenter 0\ncellsize 10\n90 80 70 60\n90 80 70 60\n90 80 70 60\n";
  for (const auto &[size, words] :
       {std::pair{"ncols 3\nnrows ", "3 rows of 3, 9 values"}, std::pair{"ncols 4\nnrows ", ""}}) {
    std::ofstream(in_folder("rows.asc")) << size << rows;
    std::string said;
    try {
      read_grid(in_folder("rows.asc"));
    } catch (const std::invalid_argument &refusal) {
      said = refusal.what();
    }
    if (*words)
      expect_words(said, {"rows.asc: holds 12 values, of up to 4 in a line", words});
    else
      EXPECT_EQ(said, "");
  }
}

/// At once, however many rows are missing, and wherever the grid is read: GDAL's search for a row that is not there
/// doubles with each of them.
TEST_F(TerrainFiles, AreRefusedAtOnceWhenMostOfThemIsMissing) {
  std::ofstream(in_folder("begun.asc")) << "ncols 3\nnrows 500\nxllcenter " << east << "\nyllcenter " << south
                                        << "\ncellsize 10\n90 80 70\n90 80 70\n";
  const std::string begun = in_folder("begun.asc"), mesh = " -o " + in_folder("m.msh"), cells = " --size 20 --air 20";
  for (const std::string &arguments :
       {begun + mesh + cells, "--values " + begun + mesh, ascii(plane) + mesh + cells + " --slip-surface " + begun}) {
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
  const Elevation high = [](double x, double y) { return y < south + 30 ? 65535 : plane(x, y); };
  expect_words(
      complaint(options(ascii(high))),
      {"the elevation 65535 m at (5200, 2020), which 63 places have, is 65495 m higher than the place beside it",
       "if 65535 stands for a place without data"});
  TerrainOptions o = options(ascii(plane));
  o.slip_surface = ascii([](double x, double y) { return x > east + 100 ? -9998 : plane(x, y) - 5; }, "slip.asc");
  expect_words(complaint(o), {"slip.asc: the elevation -9998 m"});
}

/// Walls that turn, as cliffs do: a mesa, a wavy edge, a corner of a plateau and of a quarry, a spur. Half of the
/// places around one at their edge are as low as it is; a spur ends in one place.
TEST_F(TerrainFiles, MayHaveCliffs) {
  const double x0 = east + 100, y0 = south + 80;
  const Elevation walls[] = {
      [=](double x, double y) { return std::hypot(x - x0, y - y0) < 55 ? 60. : 0.; },
      [=](double x, double y) { return x > x0 + 16 * std::sin(y / 30) + 8 * std::sin(y / 10) ? 60. : 0.; },
      [=](double x, double y) { return x > x0 && y > y0 ? 60. : 0.; },
      [=](double x, double y) { return x > x0 && y > y0 ? -60. : 0.; },
      [=](double x, double y) { return x >= x0 - 50 && std::abs(y - y0) <= 0.25 * (x - x0 + 50) ? 60. : 0.; }};
  const auto with = [&](const Elevation &wall) {
    return options(
        ascii([=](double x, double y) { return 300 + plane(x, y) + std::sin(x) * std::cos(y) + wall(x, y); }));
  };
  for (const Elevation &wall : walls) EXPECT_EQ(complaint(with(wall)), "") << &wall - walls;
  TerrainOptions fine = with(walls[0]);
  fine.size = 5, fine.file = ascii([&](double x, double y) { return 2 * walls[0](x, y); });
  expect_words(complaint(fine),
               {"is 120 m lower than the place beside it", "If this is a cliff, take a --size of 12.6 m"});
}

/// Wherever they are: at an edge, in a corner, two side by side, a few without data, at the edge of a cliff.
TEST_F(TerrainFiles, AreRefusedWithSpikesWhereverTheyAre) {
  using Places = std::vector<std::array<int, 2>>;
  const Places places[] = {{{0, 0}},           {{columns - 1, 7}},      {{columns - 1, rows - 1}}, {{6, 5}, {7, 5}},
                           {{6, 5}, {7, 6}},   {{0, 5}, {0, 6}},        {{0, 0}, {1, 0}},          {{10, 8}},
                           {{10, 8}, {11, 8}}, {{9, 3}, {9, 4}, {9, 5}}};
  for (const Places &wrong : places)
    for (const double value : {0., -32768., 9999.}) {
      if (wrong.size() > 2 && value > 0) continue;
      TerrainOptions o = options(ascii([&](double x, double y) {
        for (const auto &[i, j] : wrong)
          if (x == east + i * spacing && y == south + j * spacing) return value;
        return plane(x, y) + (x > east + 95 ? 60 : 0);
      }));
      expect_words(complaint(o), {"the elevation ", " stands ", "all places around it, as no ground does"});
    }
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

/// Web Mercator counts in metres that are longer than those on the ground the farther north they are: by 1 /
/// cos(latitude) on a sphere, 48.2 degrees here.
TEST_F(TerrainFiles, DoubtLengthsThatAreNotThoseOfTheGround) {
  const auto at = [&](int projection, double west, double bottom) {
    return options(geotiff([=](double x, double) { return 500 - 0.3 * (x - west); }, projection, 10, west, bottom));
  };
  const TerrainOptions mercator = at(3857, 1.5e6, 6.14e6);
  EXPECT_TRUE(doubts(mercator, "in the middle of the window they are 1.5 times as long"));
  EXPECT_TRUE(doubts(mercator, "areas and volumes 2.25 times theirs. Project it to metres, such as by gdalwarp"));
  const double latitude = (2 * std::atan(std::exp(6.14008e6 / 6378137)) * 180 / (180 * radian) - 90) * radian;
  const auto [east_west, south_north] = map_scale(location_of(read_grid(mercator.file)));
  const double e2 = 0.00669438, w = 1 - e2 * std::pow(std::sin(latitude), 2);
  EXPECT_NEAR(east_west, std::sqrt(w) / std::cos(latitude), 1e-5);
  EXPECT_NEAR(south_north, w * std::sqrt(w) / (1 - e2) / std::cos(latitude), 1e-5);
  const TerrainOptions plate = at(32662, 1.5e6, 5.3e6);  // degrees times a constant
  EXPECT_TRUE(doubts(plate, " times as long from west to east and "));
  for (const auto &[projection, west, bottom] : {std::tuple{32633, 4.12e5, 5.253e6},
                                                 {32633, 1.7e5, 5.3e6},
                                                 {2154, 9.6e5, 6.45e6},
                                                 {31287, 4e5, 4.5e5},
                                                 {31254, 5000., 2000.},
                                                 {2056, 2.6e6, 1.2e6},
                                                 {32633, 9e12, 9e12}})
    EXPECT_FALSE(doubts(at(projection, west, bottom), "lengths of its projection")) << projection;
  EXPECT_FALSE(doubts(options(ascii(plane)), "lengths of its projection"));
  EXPECT_TRUE(std::isnan(map_scale({"", "no projection", {0, 0}, 0})[0]));
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

}  // namespace
}  // namespace talus::terrain_files
