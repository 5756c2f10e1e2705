// What `talus check` says of soil that softens, and of flow far from the normal.
#include <sstream>

#include "check/check.h"

namespace talus {
namespace {

// Sand that softens by 100 in cells of 0.25 m, under the weight of half its height:
// drop = 2000 9.81 0.25 (sin 30 - sin 20) Pa, L = 1.158 sqrt(3) 0.25 2 G / (2 (1 - nu) 100 drop), whatever the cells.
const std::vector<std::string> softening{"body.sand.residual_friction_angle=20", "body.sand.reference_size=0.25",
                                         "body.sand.shape_factor=100"};

std::vector<std::string> with(std::vector<std::string> overrides, const std::string &one) {
  overrides.push_back(one);
  return overrides;
}

TEST(Check, KnowsTheSlipSurfaceThatSpreads) {
  const Folder folder;
  const double degree = M_PI / 180, drop = 2000 * 9.81 * 0.25 * (0.5 - std::sin(20 * degree)), twice_G = 1e6 / 1.3;
  const double length = 1.158 * std::sqrt(3.) * 0.25 * twice_G / (1.4 * 100 * drop);
  EXPECT_NEAR(number(check(folder, softening), "critical_slip_length_m"), length, 1e-9 * length);
  for (const char *other : {"mesh.size=0.17", "body.sand.averaging_length=0.3"})
    EXPECT_NEAR(number(check(folder, with(softening, other)), "critical_slip_length_m"), length, 1e-9 * length)
        << other;
  EXPECT_NEAR(number(check(folder, with(softening, "body.sand.shape_factor=50")), "critical_slip_length_m"), 2 * length,
              1e-9 * length);
  EXPECT_EQ(number(check(folder, {}), "critical_slip_length_m"), 0);
}

TEST(Check, WarnsOfFlowFarFromTheNormal) {
  const Folder folder;
  const char *advice = "a load at failure is then not unique";
  const auto with_angles = [&](const char *phi, const char *psi) {
    return with(with(softening, std::string("body.sand.friction_angle=") + phi),
                std::string("body.sand.dilation_angle=") + psi);
  };
  EXPECT_TRUE(check(folder, with_angles("36", "5")).says(advice));
  EXPECT_TRUE(check(folder, with_angles("36", "5")).says("exceeds its dilation angle by 31 degrees"));
  EXPECT_FALSE(check(folder, with_angles("34", "5")).says(advice));
  EXPECT_FALSE(check(folder, {"body.sand.friction_angle=36"}).says(advice)) << "does not soften";
}

// tan(phi*) / tan(phi) = cos 36 cos 5 / (1 - sin 36 sin 5) = 0.849
TEST(Check, SaysWhatFlowFarFromTheNormalDoesToLoadsAndFactors) {
  const Folder folder;
  const char *load = "finds no more equilibrium is not unique",
             *factor = "a lower estimate, the strength of Davis (1968), 0.85 of its shear strength";
  const std::string gravity = "{name='gravity', kind='quasi_static', duration=1}";
  const auto angles = [](const char *phi, const std::string &last) {
    return std::vector<std::string>{std::string("body.sand.friction_angle=") + phi, "body.sand.dilation_angle=5", last};
  };
  const std::string loads = "stage=[" + gravity + ", {name='load', kind='quasi_static', duration=1}]";
  EXPECT_TRUE(check(folder, angles("36", loads))
                  .says("exceeds its dilation angle by 31 degrees: the load at which stage load finds"));
  EXPECT_FALSE(check(folder, angles("34", loads)).says(load));
  EXPECT_FALSE(check(folder, angles("36", "stage=[" + gravity + ", {name='slide', duration=1}]")).says(load))
      << "asks for no load";
  EXPECT_FALSE(check(folder, angles("36", loads)).says(factor)) << "asks for no factor";
  EXPECT_TRUE(check(folder, angles("36", "factor_of_safety.mechanisms=2")).says(factor));
  EXPECT_FALSE(check(folder, angles("34", "factor_of_safety.mechanisms=2")).says("strength of Davis"));
  const Ending softens =
      check(folder, with(with(with(softening, "body.sand.friction_angle=36"), "body.sand.dilation_angle=5"), loads));
  EXPECT_FALSE(softens.says(load)) << "said of its softening";
}

// the height is 0.5 m: a surface of 1.5 times that, 0.75 m, spreads at a shape factor of 475
TEST(Check, WarnsOfBrittleSoftening) {
  const Folder folder;
  const char *warning = "Softening of sand is brittle: a slip surface of about ";
  EXPECT_FALSE(check(folder, with(softening, "body.sand.shape_factor=450")).says(warning));
  EXPECT_TRUE(check(folder, with(softening, "body.sand.shape_factor=500")).says(warning));
  std::vector<std::string> words{"run", "scene.toml", "-o", "results", "--set"};
  words.insert(words.end(), softening.begin(), softening.end());
  words.insert(words.end(), {"body.sand.shape_factor=500", "output.picture=['displacement']"});
  const Ending ending = talus(folder, words);
  ASSERT_EQ(ending.status, 0) << ending.output;
  for (const char *file : {"results/run.log", "results/report.html"}) {
    std::ostringstream text;
    text << std::ifstream(folder / file).rdbuf();
    EXPECT_NE(text.str().find(warning), std::string::npos) << file;
  }
}

}  // namespace
}  // namespace talus
