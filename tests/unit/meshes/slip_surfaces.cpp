// Slip surfaces on terrain, from ellipsoids, grids and outlines: where they lie, how much slides, what is refused.
#include "tests/unit/meshes/terrain_files.h"

namespace talus::terrain_files {
namespace {

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

/// The lip of a scarp is as sharp with elevations 10 m apart as cells of 4 m can show it: bilinear between them the bed
/// would be up to 5 m above the ellipsoid.
TEST_F(TerrainFiles, HaveTheSlipSurfaceBetweenTheirPlacesToo) {
  TerrainOptions o = options(ascii(plane));
  o.size = 4;
  o.ellipsoid = Ellipsoid{{east + 101, south + 82, 69}, {43, 31, 12}, 17 * radian, 90 * radian};
  const Terrain terrain(o);
  double worst = 0, deepest = 0;
  for (double x = 0.7; x < 200; x += 1.3)
    for (double y = 0.4; y < 160; y += 1.1) {
      const double bottom = o.ellipsoid->bottom(east + x, south + y), ground = plane(east + x, 0);
      const double bed = bottom < ground ? bottom : ground;
      deepest = std::max(deepest, ground - bed), worst = std::max(worst, std::abs(terrain.bed_at(x, y) - bed));
    }
  EXPECT_GT(deepest, 11);
  EXPECT_LT(worst, 2.5);  // 1.8 m at the rim, where the ellipsoid is as steep as a wall
  const Ellipsoid small{{east + 50, south + 40, 84.5}, {25, 20, 9}, 17 * radian, 90 * radian};
  double volume = 0;
  for (double x = 0.25; x < 100; x += 0.5)
    for (double y = 0.25; y < 80; y += 0.5)
      if (const double depth = plane(east + x, 0) - small.bottom(east + x, south + y); depth > 0)
        volume += 0.25 * depth;
  const auto areas = [&](double spacing) {
    const Answer answer = run(ascii(plane, "a.asc", spacing) + " -o " + in_folder("m.msh") +
                              " --size 4 --far-size 12 --air 20 --ellipsoid 5050 2040 84.5 25 20 9 17 90");
    EXPECT_EQ(answer.status, 0) << answer.text;
    const double extent = 320 * spacing * spacing;
    EXPECT_NEAR((of_group(answer, "slide") + of_group(answer, "air") - 20 * extent) / volume, 1, 0.03) << spacing;
    EXPECT_NEAR(of_group(answer, "slide") / volume, 1, 0.03) << spacing;
    return of_group(answer, "base") - extent * std::hypot(1, 0.3);
  };
  EXPECT_NEAR(areas(10) / areas(5), 1, 0.1);
}

/// The wall behind an ellipsoid that dips into a steep slope is no spike: what is wrong is the dip, or the elevation.
TEST_F(TerrainFiles, DoubtTheEllipsoidAndNotTheGround) {
  TerrainOptions o = options(ascii([](double x, double) { return 1000 - 0.8 * (x - east); }));
  o.size = 5;
  o.ellipsoid = Ellipsoid{{east + 100, south + 80, 920}, {80, 60, 15}, 39 * radian, 270 * radian};
  EXPECT_EQ(complaint(o), "");
  EXPECT_TRUE(doubts(o, "dips towards 270 degrees from north, into the slope, which falls towards 90 degrees"));
  o.ellipsoid->dip_direction = 90 * radian;
  EXPECT_FALSE(doubts(o, "the slip surface dips"));
  for (const double direction : {145., 35.}) {
    o.ellipsoid->dip_direction = direction * radian;
    EXPECT_FALSE(doubts(o, "the slip surface dips")) << direction;
  }
  for (const double direction : {0., 180., 205.}) {
    o.ellipsoid->dip_direction = direction * radian;
    EXPECT_TRUE(doubts(o, "degrees from north, across the slope, which falls towards 90 degrees")) << direction;
    EXPECT_FALSE(doubts(o, "into the slope")) << direction;
  }
  o.ellipsoid->dip_direction = 215 * radian;
  EXPECT_TRUE(doubts(o, "dips towards 215 degrees from north, into the slope"));
  o.file = ascii([](double x, double y) { return 920 + 0.1 * std::sin(x + y); });  // which falls nowhere
  EXPECT_FALSE(doubts(o, "the slip surface dips"));
  o.file = ascii([](double x, double) { return 1000 - 0.8 * (x - east); });
  o.ellipsoid->dip_direction = 90 * radian;
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
  expect_words(complaint(o), {"depth.asc reaches up to 12 m only", "thick", "Are these depths?", "--calc=\"A-B\""});
  const auto slip = [&](const Elevation &hides) {
    return ascii([&](double x, double y) { return hides(x, y) > 0 ? -9999 : high(x, y) - bowl(x, y); }, "slip.asc");
  };
  o.slip_surface = slip([](double, double) { return 0; });
  EXPECT_FALSE(doubts(o, "wall"));
  o.slip_surface = slip([](double x, double) { return x - east - 80; });  // ends in the middle
  EXPECT_TRUE(doubts(o, "slip.asc ends 12 m below the ground at (5080, 2080), and it is 12 m deep at most"));
  o.slip_surface = slip([](double x, double y) { return x == east + 70 && y == south + 80; });  // a hole
  expect_words(complaint(o), {"slip.asc has no elevation at (5070, 2080), in the middle of the slide"});
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

/// Depths in place of elevations are told where they are far below the ground at all places, also in low country; a
/// slip surface at and below the level of the sea is one.
TEST_F(TerrainFiles, DoNotTakeDepthsForElevations) {
  const Elevation bowl = [](double x, double y) {
    return std::max(0., 12 - 0.005 * (std::pow(x - 5080, 2) + std::pow(y - 2080, 2)));
  };
  const Elevation hill = [](double x, double y) { return plane(x, y) - 25; };  // 75 to 15 m
  TerrainOptions o = options(ascii(hill));
  o.size = 4;
  for (const double sign : {1, -1}) {
    o.slip_surface = ascii([&](double x, double y) { return sign * bowl(x, y); }, "depth.asc");
    expect_words(complaint(o), {"depth.asc reaches up to ", " m only", "Are these depths?"});
  }
  const auto shore = [&](double level) {  // of the lowest ground
    o.file = ascii([&](double x, double y) { return plane(x, y) - 40 + level; });
    o.slip_surface = ascii([&](double x, double y) { return plane(x, y) - 40 + level - bowl(x, y); }, "slip.asc");
    return complaint(o);
  };
  for (const double level : {0., -30., -61., 5.}) EXPECT_EQ(shore(level), "") << level;
  o.file = ascii([](double x, double) { return 3 + 0.045 * (x - east); });  // a plain, and loose soil on all of it
  o.slip_surface = ascii([](double x, double) { return 0.0125 * (x - east); }, "slip.asc");
  EXPECT_EQ(complaint(o), "");
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
  testing::internal::CaptureStderr();
  expect_words(complaint(o), {"outline.gpkg: has a polygon that crosses itself at (5012, 2012)", "makevalid"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "GDAL speaks in our sentence";
}

/// Polygons that the places of the terrain, or the cells, are too far apart for are named.
TEST_F(TerrainFiles, DoubtOutlinesSmallerThanTheirSpacing) {
  TerrainOptions o = options(ascii([](double, double) { return 500; }));
  o.depth = 4;
  const std::string small = "outline.gpkg: the polygon around (5101, 2081), 28.3 m2, holds ";
  o.size = 12, o.outline = outline(east + 101, south + 81, 3, 0, 31254);
  EXPECT_TRUE(doubts(o, small + "3 places of the slip surface, which are 3.33 m apart, and cells of 12 m"));
  EXPECT_TRUE(doubts(o, "Take a --size of 2 m or less"));
  o.size = 2;
  EXPECT_FALSE(doubts(o, small));
  EXPECT_NEAR(Terrain(o).slide_volume() / (180 * radian * 3 * 3 * 4 / 2), 1, 0.03);
  o.bowl = false;  // a wall needs the spacing of the terrain
  EXPECT_TRUE(doubts(o, small + "1 place of the slip surface, which are 10 m apart: "));
  EXPECT_TRUE(doubts(o, "Take finer terrain"));
  o.outline = outline(east + 105, south + 85, 3, 0, 31254);
  expect_words(complaint(o), {"outline.gpkg has no elevation of ", "in it, which are 10 m apart", "closer together"});
  const auto box = [](double x, double y, double wide, double high) {
    return Ring{{east + x, south + y},
                {east + x + wide, south + y},
                {east + x + wide, south + y + high},
                {east + x, south + y + high}};
  };
  const Ring large = box(22, 22, 60, 60);
  o.size = 5, o.outline = package_of({{large}, {box(104, 31, 4, 90)}}, 31254);
  EXPECT_TRUE(doubts(o, "the polygon around (5106, 2076), 360 m2, holds no place of the slip surface"));
  o.outline = package_of({{large}, {box(104, 31, 28, 90)}}, 31254);
  EXPECT_FALSE(doubts(o, "the polygon around"));
  o.outline = package_of({{large}, {box(404, 31, 28, 90)}}, 31254);
  EXPECT_TRUE(doubts(o, "the polygon around (5418, 2076), 2520 m2, does not lie in the window"));
  o.bowl = true, o.size = 2, o.outline = package_of({{large}, {box(104, 31, 4, 9)}}, 31254);
  EXPECT_FALSE(doubts(o, "the polygon around")) << "between the places of the terrain, and asked there";
  ASSERT_EQ(Terrain(o).parts().size(), 2u);
  EXPECT_GT(Terrain(o).parts()[1].places, 9);
}

/// The volume of the slide is that of one polygon, though another one, which is shallow, has no cells.
TEST_F(TerrainFiles, NameThePolygonWithoutCells) {
  const std::string file = ascii([](double, double) { return 500; });
  const auto ring = [](double x, double radius) {
    Ring places;
    for (int k = 0; k < 60; ++k)
      places.push_back({east + x + radius * std::cos(6 * k * radian), south + 80 + radius * std::sin(6 * k * radian)});
    return places;
  };
  const auto with = [&](double radius, const std::string &size) {
    return run(file + " -o " + in_folder("m.msh") + " --air 20 --depth 15 --size " + size + " --outline " +
               package_of({{ring(65, 55)}, {ring(160, radius)}}, 31254));
  };
  const Answer coarse = with(18, "12");
  EXPECT_EQ(coarse.status, 0);
  expect_words(coarse.text, {"outline.gpkg: the polygon around (5160, 2080), ", ", has no cells, and "});
  EXPECT_EQ(coarse.text.find("around (5065"), std::string::npos) << coarse.text;
  EXPECT_EQ(with(30, "6").text.find("the polygon around"), std::string::npos);
}

/// GDAL gives a GeoPackage without a projection one of degrees.
TEST_F(TerrainFiles, TakeAnOutlineBeyondDegreesAsOneWithoutProjection) {
  TerrainOptions o = options(geotiff(plane, 31254));
  o.depth = 6, o.outline = outline(east + 100, south + 80, 45, 0, 4326);
  EXPECT_EQ(complaint(o), "");
  EXPECT_EQ(read_outline(o.outline).location.projection, "");
  o.outline = outline(10, 47, 1, 0, 4326);
  expect_words(complaint(o), {"outline.gpkg: has coordinates in degrees"});
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

}  // namespace
}  // namespace talus::terrain_files
