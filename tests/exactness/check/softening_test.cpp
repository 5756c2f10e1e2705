// What `talus check` says of soil that softens.
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
