// Tension cracks in the search for a factor of safety, docs/theory/finite_elements.md section 5.3.
#include "scene/scene.h"
#include "solved.h"

namespace talus {
namespace {

using Keys = std::vector<std::string>;

/// Strong rock on a seam that fails in shear under the thrust of the water behind it.
const std::string block_on_seam = R"(
gravity = 10
[mesh]
section = "../tests/exactness/quasi_static/seam.csv"
size = 0.5
[body.block]
region = "block"
density = 2000
law = "mohr_coulomb"
young_modulus = "1 GPa"
poisson_ratio = 0.3
cohesion = "10 MPa"
friction_angle = 0
reduce_strength = false
[body.seam]
region = "seam"
density = 2000
law = "mohr_coulomb"
young_modulus = "100 MPa"
poisson_ratio = 0.3
cohesion = "10 kPa"
friction_angle = 0
[boundary.base]
kind = "fixed"
[boundary.walls]
group = ["left", "toe"]
kind = "roller"
[[stage]]
name = "weight"
kind = "quasi_static"
duration = 1
)";

struct Found {
  FactorOfSafety factor;
  std::vector<Event> events;
};
Found search(const Keys &overrides) {
  Scene scene = parse_scene(block_on_seam, meshes + "/scene.toml", overrides);
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const FactorOfSafety factor = simulation->factor_of_safety();
  return {factor, simulation->events()};
}

const Keys crack{"factor_of_safety.tension_crack=[[0,0.25],[1,0.25]]", "factor_of_safety.crack_water=3.25"};

/// The crack opens where it leaves the shortest seam: c L / (gamma_w h^2 / 2) = 10 * 9 / 45. Elements of 0.5 m that
/// shear in one row are a few per cent too strong.
TEST(TensionCrack, is_pushed_open_by_its_water) {
  const FactorOfSafety full = search(crack).factor;
  EXPECT_NEAR(full.value(), 2, 0.1);
  const FactorOfSafety lower = search(crack + Keys{"factor_of_safety.crack_water=2.75"}).factor;
  EXPECT_NEAR(lower.value() / full.value(), 9 / (2.5 * 2.5), 0.03);
}

/// Without water in it nothing moves: there is no factor, and the soil is as it was.
TEST(TensionCrack, pushes_nothing_where_it_is_dry) {
  EXPECT_ANY_THROW(search({"factor_of_safety.tension_crack=[[0,0.25],[1,0.25]]"}));
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
}

}  // namespace
}  // namespace talus
