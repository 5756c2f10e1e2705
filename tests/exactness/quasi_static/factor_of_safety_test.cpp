// The factor of safety: laws that it refuses, and soil that it leaves as it is.
#include "solved.h"

namespace talus {
namespace {

struct Reduced {
  FactorOfSafety factor;
  std::vector<Event> events;
};
Reduced reduce(const std::string &text, const std::vector<std::string> &overrides = {}) {
  Scene scene = parse_scene(text, meshes + "/scene.toml", overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const FactorOfSafety factor = simulation->factor_of_safety();
  return {factor, simulation->events()};
}

/// The law, and why its strength cannot be divided, before anything is solved.
TEST(FactorOfSafety, refuses_laws_without_strength_to_divide) {
  using Words = std::vector<std::string>;
  for (const Words &overrides :
       {Words{"body.soil.law=linear_elastic"}, Words{"body.soil.law=newtonian", "body.soil.viscosity=1"},
        Words{"body.soil.law=bingham", "body.soil.viscosity=1", "body.soil.yield_stress=1000"},
        Words{"body.soil.law=mu_i", "body.soil.static_friction=0.4", "body.soil.limiting_friction=0.6",
              "body.soil.grain_size=0.001"}}) {
    const std::string law = overrides[0].substr(overrides[0].find('=') + 1);
    try {
      reduce(block + "[boundary.base]\nkind = \"fixed\"\n", overrides);
      ADD_FAILURE() << law;
    } catch (const std::invalid_argument &error) {
      const std::string said = error.what();
      EXPECT_NE(said.find("body.soil.law"), std::string::npos) << said;
      EXPECT_NE(said.find("but " + law + " "), std::string::npos) << said;
    }
  }
}

/// A cut of clay on elastic rock: the clay fails, and the log says that the rock was left as it is.
TEST(FactorOfSafety, leaves_elastic_soil_beside_other_soil_as_it_is) {
  const std::string layer = "density = 2000\nyoung_modulus = \"10 MPa\"\npoisson_ratio = 0.3\n";
  const Reduced cut = reduce("gravity = 10\n[mesh]\nsection = \"" + std::string(TALUS_LAYERS) +
                             "\"\nsize = 0.25\n[body.rock]\nregion = \"lower\"\nlaw = \"linear_elastic\"\n" + layer +
                             "[body.clay]\nregion = \"upper\"\nlaw = \"mohr_coulomb\"\nfriction_angle = 0\n"
                             "cohesion = \"4 kPa\"\n" +
                             layer +
                             "[boundary.base]\nkind = \"fixed\"\n[boundary.left]\nkind = \"roller\"\n"
                             "[[stage]]\nname = \"gravity\"\nkind = \"quasi_static\"\nduration = 1\n");
  // 3.77 c / (rho g h) of a vertical cut, h = 0.5 m; four cells over its height are stiffer
  EXPECT_GT(cut.factor.value(), 1.4);
  EXPECT_LT(cut.factor.value(), 1.9);
  const auto says = [](const Event &event) {
    return event.text.find("body.rock is not reduced: linear_elastic is elastic") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(cut.events.begin(), cut.events.end(), says), 1);
}

}  // namespace
}  // namespace talus
