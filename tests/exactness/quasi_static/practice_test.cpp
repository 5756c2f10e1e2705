// What practice asks of a slope: earthquakes as a share of gravity, and weights given as unit weights.
#include "solved.h"

namespace talus {
namespace {

const std::string walls = "gravity = 10\n" + box + R"(
[boundary.base]
kind = "roller"
[boundary.left]
kind = "roller"
)";

/// The supports of 1 m2 of soil carry its inertia, and where water fills the pores that of the water too.
TEST(Practice, supports_carry_the_inertia_of_soil_and_water) {
  const std::string stages =
      "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n"
      "[[stage]]\nkind = \"quasi_static\"\nduration = 1\nseismic_coefficient = [0.2, -0.1]\n"
      "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n";
  for (const bool wet : {false, true}) {
    const std::string soil = wet ? "porosity=0.4" : "density=2000";
    std::vector<std::string> overrides{"body.soil." + soil};
    if (wet)
      overrides = overrides + std::vector<std::string>{"body.soil.grain_density=2650", "phases=drained",
                                                       "water.table=[[0, 1], [1, 1]]"};
    const double density = wet ? 0.6 * 2650 + 400 : 2000, uplift = wet ? 1000 * 10 : 0;
    const Solved solved = solve(walls + stages, overrides);
    const std::vector<double> x = solved.history.column("left_force_x_N"), y = solved.history.column("base_force_y_N"),
                              t = solved.history.column("time_s");
    for (size_t i = 0; i < t.size(); ++i) {
      if (t[i] == 0 || t[i] != std::round(t[i])) continue;  // ends of gravity, of the earthquake, and of rest after it
      const double share = t[i] == 2 ? 1 : 0;
      EXPECT_NEAR(x[i], -0.2 * share * density * 10, 1e-8) << wet << " at t = " << t[i];
      EXPECT_NEAR(y[i], (1 + 0.1 * share) * density * 10 - uplift, 1e-8) << wet << " at t = " << t[i];
    }
  }
}

/// Soil in free flight falls with the sum of gravity and the pseudo-static acceleration.
TEST(Practice, soil_in_flight_feels_the_earthquake) {
  const std::string text = R"(
gravity = 10
[mesh]
section = "flight.csv"
size = 0.25
[body.soil]
region = "block"
unit_weight = "20 kN/m3"
law = "linear_elastic"
young_modulus = "1 MPa"
poisson_ratio = 0.3
[output.point.middle]
position = [0.75, 0.75]
[[stage]]
duration = 0.1
seismic_coefficient = [0.5, 0.4]
[integrator]
step = 1e-3
)";
  const Solved solved = solve(text);
  EXPECT_NEAR(solved.history.column("middle_velocity_m_s").back(), 0.1 * std::hypot(5., 6.), 1e-12);
  EXPECT_NEAR(solved.history.column("mass_kg").back(), 2000 * 0.25, 1e-9);
}

/// Unit weights above and below a water table give the weight of each part; so does a density, the same on both sides.
TEST(Practice, unit_weights_give_the_weight_above_and_below_the_water_table) {
  const std::string stage = "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n";
  const std::vector<std::string> wet{"phases=drained", "water.table=[[0, 0.4], [1, 0.4]]"};
  const auto weight = [&](const std::vector<std::string> &soil) {
    return solve(walls + stage, wet + soil).history.column("base_force_y_N").back();
  };
  const double uplift = 0.4 * 10e3;
  EXPECT_NEAR(weight({"body.soil.unit_weight=19 kN/m3"}), 19e3 - uplift, 1e-8);
  EXPECT_NEAR(weight({"body.soil.density=1900"}), 19e3 - uplift, 1e-8);
  // cells that the table cuts count by their Gauss points: within 2 kN/m3 over half a cell of 0.3 m
  EXPECT_NEAR(weight({"body.soil.unit_weight=18 kN/m3", "body.soil.saturated_unit_weight=20 kN/m3"}),
              18e3 * 0.6 + 20e3 * 0.4 - uplift, 300);
}

/// A pore pressure ratio gives that share of the weight above, here of two layers whose interface is at 0.5 m.
TEST(Practice, pore_pressure_is_a_share_of_the_weight_above) {
  const std::string text = R"(
gravity = 10
phases = "drained"
[mesh]
section = "layers.csv"
size = 0.2
[water]
[body.upper]
region = "upper"
unit_weight = "16 kN/m3"
pore_pressure_ratio = 0.3
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
[body.lower]
region = "lower"
unit_weight = "20 kN/m3"
pore_pressure_ratio = 0.3
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
[boundary.walls]
group = ["base", "left", "right"]
kind = "roller"
[[stage]]
kind = "quasi_static"
duration = 1
initial_stress = "k0"
)";
  const Solved solved = solve(text, {"mesh.section=" + std::string(TALUS_LAYERS)});
  const auto total = [&](size_t q) {
    const double y = solved.value("position", q, 1);
    return 16e3 * std::min(1 - y, 0.5) + 20e3 * std::max(0.5 - y, 0.);
  };
  EXPECT_LT(largest(solved, 1, [&](size_t q, int) { return solved.value("pore_pressure", q) - 0.3 * total(q); }), 1e-6);
  EXPECT_LT(largest(solved, 1, [&](size_t q, int) { return solved.value("stress", q, 1) + 0.7 * total(q); }), 1e-6);
}

}  // namespace
}  // namespace talus
