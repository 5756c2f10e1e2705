// Tension cracks in the search for a factor of safety, docs/theory/finite_elements.md section 5.3.
#include "scene/scene.h"
#include "solved.h"

namespace talus {
namespace {

using Keys = std::vector<std::string>;

/// A block of Tresca soil under 30 kPa from above and 10 kPa from the right: its factor is 14 kPa over a radius of 10
/// kPa. Gravity is so small, and water stands so high, that its pressure is the same everywhere.
const std::string pressed_block = "gravity = 1e-3\n" + block + R"(
[boundary.base]
kind = "roller"
[boundary.left]
kind = "roller"
[boundary.surface]
kind = "traction"
pressure = 30e3
[boundary.right]
kind = "traction"
pressure = 10e3
)";
const Keys soil{"body.soil.law=mohr_coulomb", "body.soil.cohesion=14e3", "body.soil.friction_angle=0"};
/// Water of 1 Pa per metre in cracks all over the block.
Keys crack_with(double pressure) {
  return {"factor_of_safety.tension_crack=[[0,-1],[1,-1]]", "factor_of_safety.crack_water=" + std::to_string(pressure)};
}

struct Found {
  FactorOfSafety factor;
  Snapshot points;
};
Found search(const Keys &overrides) {
  Scene scene = parse_scene(pressed_block, meshes + "/scene.toml", soil + overrides);
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const FactorOfSafety factor = simulation->factor_of_safety();
  return {factor, simulation->snapshot()};
}

void expect_factor(const FactorBracket &found, double exact) {
  EXPECT_TRUE(found.decided);
  EXPECT_LE(found.lower, exact * (1 + 1e-4));
  EXPECT_GE(found.upper, exact * (1 - 1e-4));
}

/// The soil bears what the water presses as long as something presses back: 10 kPa from the right.
TEST(TensionCrack, is_pushed_by_its_water) {
  expect_factor(search(crack_with(9.95e3)).factor, 1.4);
  EXPECT_ANY_THROW(search(crack_with(10.05e3)));
}

/// Dry cracks bear no tension: with a pull in place of the pressure the soil has no factor, and without a crack it has
/// one, 14 kPa over a radius of 20 kPa.
TEST(TensionCrack, bears_no_tension) {
  const Keys pull{"boundary.right.pressure=-10e3"};
  expect_factor(search(pull).factor, 0.7);
  EXPECT_ANY_THROW(search(pull + Keys{"factor_of_safety.tension_crack=[[0,-1],[1,-1]]"}));
}

/// Below the line soil keeps its tensile strength, with friction and without: where the foot of the block is pulled and
/// its head is pressed, cracks in the head change nothing, and cracks in all of it leave no factor.
TEST(TensionCrack, ends_at_its_line) {
  for (const char *phi : {"0", "20"}) {
    const Keys bent{"boundary.right.pressure=20e3*(y-0.5)", std::string("body.soil.friction_angle=") + phi};
    const FactorOfSafety whole = search(bent).factor;
    const FactorOfSafety head = search(bent + Keys{"factor_of_safety.tension_crack=[[0,0.7],[1,0.7]]"}).factor;
    EXPECT_NEAR(head.lower, whole.lower, 0.02 * whole.lower) << phi;
    EXPECT_ANY_THROW(search(bent + crack_with(0))) << phi;
  }
}

/// Rock of Hoek and Brown too, and soil that holds its water.
TEST(TensionCrack, opens_in_rock_and_in_undrained_soil) {
  const Keys rock{"body.soil.law=hoek_brown", "body.soil.intact_strength=30e6", "body.soil.geological_strength_index=5",
                  "body.soil.intact_constant=2", "body.soil.dilation_angle=90"};
  const auto search_in = [](const Keys &law, const Keys &more) {
    Scene scene = parse_scene(pressed_block, meshes + "/scene.toml", law + more);
    scene.add_factor_stage();
    RunOptions options;
    options.pictures = options.screen = false;
    return make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety();
  };
  EXPECT_GT(search_in(rock, crack_with(5e3)).lower, 1);
  EXPECT_ANY_THROW(search_in(rock, crack_with(10.05e3)));
  const Keys undrained = soil + Keys{"body.soil.drainage=undrained"};
  expect_factor(search_in(undrained, crack_with(9.95e3)), 1.4);
  EXPECT_ANY_THROW(search_in(undrained, crack_with(10.05e3)));
}

TEST(TensionCrack, is_refused_where_its_line_is_none) {
  const auto complaint = [](const Keys &overrides) -> std::string {
    try {
      search(overrides);
    } catch (const std::exception &error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint({"factor_of_safety.crack_water=3"}).find("has no effect without the line"), std::string::npos);
  EXPECT_NE(complaint({"factor_of_safety.tension_crack=[[1,0.25],[0,0.25]]"}).find("whose x rises"), std::string::npos);
  EXPECT_NE(complaint({"factor_of_safety.tension_crack=[[0,2],[1,2]]"}).find("must have soil above it"),
            std::string::npos);
  const Keys cone = soil + Keys{"body.soil.law=drucker_prager"};
  EXPECT_NE(complaint(cone + crack_with(5e3)).find("must know a tension cut-off"), std::string::npos);
}

}  // namespace
}  // namespace talus
