// Claims of doubts/doubts.h.
#include "doubts/doubts.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <cmath>

#include "doubts/needs.h"
#include "scene/scene.h"
#include "simulation/scene_keys.h"

namespace talus {
namespace {

TEST(Doubts, TensionOfMoreThanAnAtmosphereIsDoubted) {
  Snapshot state;
  Column pressure{"pore_pressure", "Pa", "", 1, {}}, volume{"volume", "m3", "", 1, {}};
  std::vector<BodyReport> bodies(1);
  bodies[0].name = "clay";
  state.body.assign(200, 0), volume.values.assign(200, 0.1), pressure.values.assign(200, -94e3);
  const auto said = [&] {
    Scene scene;
    scene.phases = PhaseModel::saturated;
    state.columns = {pressure, volume};
    return doubts_about_end(scene, PETSC_COMM_WORLD, bodies, state);
  };
  pressure.values[0] = -100e3;
  EXPECT_TRUE(said().empty()) << "a single particle";
  for (const int i : {1, 2, 3}) pressure.values[i] = -98e3;
  const std::vector<std::string> found = said();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].find("the water in 2 % of body.clay cavitates at the end, at -100 kPa"), 0u) << found[0];
}

/// What is said of a heap 3 m high with a face of `slope` degrees below 4 m of level ground, in cells of `size` [m] and
/// with a cohesion [Pa].
std::vector<std::string> doubts_about_heap(double slope, double size, double cohesion) {
  const double rad = slope * M_PI / 180;
  Scene scene;
  scene.dimension = 2, scene.gravity = {0, -9.81};
  const auto face = [](std::array<double, 3> from, std::array<double, 3> to) {
    SoilFace made;
    const double x = to[0] - from[0], y = to[1] - from[1];
    made.corner = {from, to}, made.area = std::hypot(x, y), made.normal = {-y / made.area, x / made.area, 0};
    return made;
  };
  const double run = 3 / std::tan(rad);
  const std::vector<SoilFace> surface{face({0, 0}, {run, 3}), face({run, 3}, {run + 4, 3}), face({run + 4, 0}, {0, 0})};
  BodyReport heap;
  heap.name = "heap", heap.particles = 100, heap.volume = 12 + 1.5 * run, heap.mass = 1600 * heap.volume;
  heap.cell_size = size;
  heap.high = {run + 4, 3, 0};
  heap.strength.friction_angle = {0.6, 0.6}, heap.strength.cohesion = {cohesion, cohesion};
  Doubts doubts(scene);
  doubt_before_run(Start(scene, {heap}, surface), {}, doubts);
  return doubts.sentences();
}

/// A bowl of soil on rock that is 200 m deep is no deeper than twice its mean.
TEST(Doubts, ABodyHasItsOwnDepth) {
  SoilFace ground;
  ground.body = 1, ground.area = 100, ground.normal = {0, 0, 1};
  BodyReport slide;
  slide.volume = 500;
  Scene scene;
  scene.dimension = 3, scene.up = Up::z;
  const Start start(scene, {slide, slide}, {ground});
  EXPECT_DOUBLE_EQ(start.depth_of(1, 200), 10);
  EXPECT_DOUBLE_EQ(start.depth_of(1, 8), 8);
  EXPECT_DOUBLE_EQ(start.depth_of(0, 200), 200) << "below other soil";
}

TEST(Doubts, SandThatIsTooSteepIsDoubtedInFewCells) {
  const std::vector<std::string> found = doubts_about_heap(50, 0.5, 0);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("% of the free surface of body.heap is steeper than its friction angle by more than 5 deg"),
            std::string::npos)
      << found[0];
  EXPECT_TRUE(doubts_about_heap(35, 0.5, 0).empty()) << "not steeper than its friction angle of 34 degrees";
  EXPECT_TRUE(doubts_about_heap(50, 0.5, 2e3).empty()) << "with cohesion";
  EXPECT_TRUE(doubts_about_heap(50, 0.25, 0).empty()) << "12 cells over its depth";
  ASSERT_EQ(doubts_about_heap(50, 1, 0).size(), 1u);
  EXPECT_NE(doubts_about_heap(50, 1, 0)[0].find("fewer than 4 over the depth"), std::string::npos)
      << "one sentence is enough";
}

/// What a key is doubted by can be acknowledged.
TEST(Doubts, HaveAKnownName) {
  const Describer keys = scene_keys();
  for (const Describer::Block &block : keys.blocks())
    for (const Describer::Key &key : block.keys) {
      const bool doubted = key.allowed.find("usual") != std::string::npos;
      EXPECT_TRUE(!doubted || is_doubt_name(key.path.substr(key.path.rfind('.') + 1))) << key.path;
    }
}

TEST(Doubts, AreSilentWhereTheSceneAcknowledgesThem) {
  Scene scene;
  scene.acknowledge = {"film"};
  Doubts doubts(scene);
  doubts.say({{"film", true, "meant"},
              {"open_water", true, "not meant"},
              {"void", false, "not so"},
              unusual("strength", "a ratio", 3, one, {5, 10})});
  EXPECT_EQ(doubts.sentences(),
            (std::vector<std::string>{"not meant [open_water]", "a ratio = 3; usual 5 to 10 [strength]"}));
}

}  // namespace
}  // namespace talus
