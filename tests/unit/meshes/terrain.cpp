// Terrain as a whole: doubts, layers, ways, and the meshes that talus-mesh makes of it.
#include "tests/unit/meshes/terrain_files.h"

namespace talus::terrain_files {
namespace {

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
  expect_words(content(in_folder("m.origin.json")), {"\"origin_m\":[5000.0,2000.0]"});
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
  EXPECT_NEAR(of_group(answer, "slide") / paraboloid, 1, 0.06) << answer.text;  // 0.96: the rim has no cells
  EXPECT_NEAR((of_group(answer, "slide") + of_group(answer, "air")) / (200. * 160 * 20 + paraboloid), 1, 0.005);
  EXPECT_EQ(of_group(answer, "ground"), 0);
  EXPECT_EQ(of_group(answer, "terrain"), 0);
  EXPECT_GT(of_group(answer, "base"), 200 * 160 * std::hypot(1, 0.3));
  double surface = 0;  // of the slip surface under the slide, by rings
  for (double r = 0.25; r < std::sqrt(12 / 0.005); r += 0.5)
    for (int k = 0; k < 360; ++k)
      surface +=
          0.5 * r * radian * std::hypot(1, -0.3 + 0.01 * r * std::cos(k * radian), 0.01 * r * std::sin(k * radian));
  std::smatch found;
  const std::regex areas("slip surface (\\S+) m2 under the slide; its cells stand on (\\S+) m2");
  ASSERT_TRUE(std::regex_search(answer.text, found, areas)) << answer.text;
  EXPECT_NEAR(std::stod(found[1]) / surface, 1, 0.04);
  EXPECT_NEAR(std::stod(found[2]) / surface, 1, 0.15);  // 0.88: cells whose middle is above the soil do not count
  const std::string first = content(in_folder("m.msh"));
  run(arguments);
  EXPECT_EQ(first, content(in_folder("m.msh")));
}

/// What is wrong stands alone, with no report of a mesh before it.
TEST_F(TerrainFiles, SayOnlyThatTheSlideIsThinnerThanItsCells) {
  const Answer answer = run(ascii(plane) + " -o " + in_folder("m.msh") + " --size 60 --air 60 --depth 0.3 --outline " +
                            outline(east + 100, south + 80, 30, 0, 31254));
  EXPECT_EQ(answer.status, 2);
  EXPECT_TRUE(answer.text.starts_with("talus-mesh: the slide is thinner than its cells")) << answer.text;
  EXPECT_EQ(std::count(answer.text.begin(), answer.text.end(), '\n'), 1) << answer.text;
  EXPECT_FALSE(std::filesystem::exists(in_folder("m.msh")));
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
}  // namespace talus::terrain_files
