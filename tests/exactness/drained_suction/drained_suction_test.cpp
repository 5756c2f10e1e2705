// Prescribed pore pressure below zero is suction, from which soil takes cohesion, docs/theory (2.10) and
// laws/mohr_coulomb: a block without friction, sheared until it yields, bears the shear stress
// c + suction_cohesion (1 - exp(-suction_cohesion_rate s)) in every point, in motion as in equilibrium.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

/// Four cells whose outer nodes move as prescribed: the shear strain is 2 %, five times that of yield.
const std::string block = R"(
phases = "drained"
[mesh]
section = "box.csv"
size = 1
[body.soil]
region = "soil"
porosity = 0.3
grain_density = 2600
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = "2 kPa"
friction_angle = 0
suction_cohesion = "20 kPa"
suction_cohesion_rate = 2e-5
[boundary.all]
group = ["base", "left", "right", "surface"]
kind = "velocity"
velocity = ["0.2 * y", "0"]
[[stage]]
name = "shear"
duration = 0.1
)";

/// Stress of the particles at the end, four components each [Pa].
std::vector<double> stress_after(const std::vector<std::string> &overrides) {
  Scene scene = parse_scene(block, std::string(TALUS_MESHES) + "/scene.toml", overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  const Snapshot end = simulation->snapshot();
  EXPECT_GT(end.id.size(), 0u);
  return std::find_if(end.columns.begin(), end.columns.end(), [](const Column &c) { return c.name == "stress"; })
      ->values;
}

void expect_shear_stress(double expected, const std::vector<std::string> &overrides) {
  const std::vector<double> stress = stress_after(overrides);
  for (std::size_t i = 0; i < stress.size(); i += 4)
    EXPECT_NEAR(std::hypot((stress[i] - stress[i + 1]) / 2, stress[i + 3]), expected, 1e-9 * expected);
}

constexpr double cohesion = 2e3;  // [Pa]
double from_suction(double suction) { return 20e3 * (1 - std::exp(-2e-5 * suction)); }

TEST(DrainedSuction, adds_cohesion_in_motion) {
  expect_shear_stress(cohesion + from_suction(50e3), {"water.excess=-50000"});
  expect_shear_stress(cohesion + from_suction(20e3), {"water.excess=-20000"});
}

TEST(DrainedSuction, adds_cohesion_in_equilibrium) {
  expect_shear_stress(cohesion + from_suction(50e3), {"stage.0.kind=quasi_static", "water.excess=-50000"});
}

TEST(DrainedSuction, is_none_where_pressure_is_above_zero) {
  expect_shear_stress(cohesion, {"water.excess=50000"});
  expect_shear_stress(cohesion, {"stage.0.kind=quasi_static", "water.excess=50000"});
}

/// Suction that differs from place to place pulls at nothing; pressure above zero pushes.
TEST(DrainedSuction, is_no_stress) {
  for (const char *open : {"true", "false"})
    for (const char *sign : {"-", ""}) {
      const std::vector<double> stress =
          stress_after({"boundary.all.velocity=[0, 0]", std::string("water.excess=") + sign + "50000 * y",
                        std::string("water.open_water_load=") + open});
      double largest = 0;
      for (const double s : stress) largest = std::max(largest, std::abs(s));
      if (*sign) {
        EXPECT_EQ(largest, 0) << open;
      } else {
        EXPECT_GT(largest, 100) << open;
      }
    }
}

}  // namespace
}  // namespace talus
