// Soil whose pore water cannot leave, docs/theory/laws/undrained.md: excess pressure of a uniform block by Skempton's A
// and B, its strength from the effective stress before it fails, and what stages and checkpoints do with it.
#include "scene/scene.h"
#include "solved.h"

namespace talus {
namespace {

using Keys = std::vector<std::string>;

constexpr double E = 10e6, nu = 0.3, nu_u = 0.495;
const double K = E / (3 * (1 - 2 * nu)), G = E / (2 * (1 + nu)), K_u = 2 * G * (1 + nu_u) / (3 * (1 - 2 * nu_u));
const double B = (K_u - K) / K_u;

/// Under 30 kPa from above and 10 kPa from the right, on smooth walls.
const std::string pressed = R"(
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
const Keys undrained{"body.soil.drainage=undrained"};

double worst(const Solved &solved, const std::string &name, double exact) {
  return largest(solved, 1, [&](size_t i, int) { return solved.value(name, i) - exact; });
}

/// Plane strain: the mean total stress rises by (1 + nu_u) / 3 of the sum of both, and the effective stress is what the
/// water does not bear.
TEST(Undrained, elastic_soil_has_skemptons_b) {
  for (const char *elements : {"quadratic", "patches"}) {
    const Solved solved = solve(block + pressed, undrained + Keys{std::string("quasi_static.elements=") + elements});
    const double excess = B * (1 + nu_u) / 3 * 40e3;
    EXPECT_LT(worst(solved, "excess_pore_pressure", excess), 1e-12 * 40e3);
    const double out_of_plane = -nu_u * 40e3, total[4] = {-10e3, -30e3, out_of_plane, 0};
    EXPECT_LT(largest(solved, 4,
                      [&](size_t i, int k) { return solved.value("stress", i, k) - total[k] - (k < 3 ? excess : 0); }),
              1e-11 * 40e3);
  }
}

/// 3D: du = B (d sigma_3 + (d sigma_1 - d sigma_3) / 3), A = 1/3 of elastic soil (Skempton 1954).
TEST(Undrained, elastic_soil_has_skemptons_a_in_a_triaxial_test) {
  const std::string all_around = pressed +
                                 "[boundary.front]\nkind = \"traction\"\npressure = 10e3\n"
                                 "[boundary.back]\nkind = \"roller\"\n";
  const Solved solved = solve(block + all_around, undrained + in_3d + Keys{"body.soil.skempton_b=0.9"});
  EXPECT_LT(worst(solved, "excess_pore_pressure", 0.9 * (10e3 + 20e3 / 3)), 1e-11 * 40e3);
}

/// Results show the sum of both pressures.
TEST(Undrained, excess_adds_to_the_pressure_of_the_table) {
  const Solved solved = solve("phases = \"drained\"\n[water]\ntable = 6\nopen_water_load = false\n" + block + pressed,
                              undrained + Keys{"gravity=10"});
  EXPECT_LT(largest(solved, 1,
                    [&](size_t i, int) {
                      const double table = 1e4 * (6 - solved.value("position", i, 1));
                      return solved.value("pore_pressure", i) - solved.value("excess_pore_pressure", i) - table;
                    }),
            1e-3);
}

/// A stage that ignores it is drained; and one that follows lets the excess pressure go.
TEST(Undrained, drains_where_a_stage_ignores_it) {
  const Solved drained = solve(block + pressed);
  const Solved ignored = solve(block + pressed, undrained + Keys{"body.soil.drained_in=load"});
  const Solved later = solve(block + pressed + "[[stage]]\nname = \"later\"\nkind = \"quasi_static\"\nduration = 1\n",
                             undrained + Keys{"body.soil.drained_in=later"});
  for (const Solved *one : {&ignored, &later}) {
    EXPECT_EQ(worst(*one, "excess_pore_pressure", 0), 0);
    EXPECT_LT(
        largest(*one, 4, [&](size_t i, int k) { return one->value("stress", i, k) - drained.value("stress", i, k); }),
        1e-11 * 40e3);
    EXPECT_LT(largest(*one, 2,
                      [&](size_t i, int k) {
                        return one->value("displacement", i, k) - drained.value("displacement", i, k);
                      }),
              1e-12);
  }
}

/// Water and soil are strained alike: the excess pressure is K_w / n over K of the mean effective stress.
TEST(Undrained, water_is_held_in_motion) {
  const Solved solved = solve(box +
                                  "density = 2000\nvelocity = [\"0\", \"-10 * y\"]\n[[stage]]\nname = \"strain\"\n"
                                  "duration = 1e-7\n",
                              undrained);
  const double excess = (K_u - K) * 1e-6;
  EXPECT_LT(worst(solved, "excess_pore_pressure", excess), 0.5 * excess);  // means of cells at the faces strain less
  EXPECT_LT(largest(solved, 1,
                    [&](size_t i, int) {
                      double mean = 0;
                      for (int k = 0; k < 3; ++k) mean -= solved.value("stress", i, k) / 3;
                      return solved.value("excess_pore_pressure", i) - (K_u - K) / K * mean;
                    }),
            1e-9 * excess);
}

/// What elements found goes on in motion, whose loads it bears as a whole.
TEST(Undrained, motion_goes_on_with_the_pressure_of_the_elements) {
  const Solved solved = solve(block + pressed + "[[stage]]\nname = \"motion\"\nduration = 1e-4\nhold_loads = true\n",
                              undrained + Keys{"quasi_static.elements=patches"});
  EXPECT_LT(worst(solved, "excess_pore_pressure", B * (1 + nu_u) / 3 * 40e3), 1e-6 * 40e3);
}

/// A stage without softening remembers the excess pressure all the same: it is a part of the stress.
TEST(Undrained, stages_without_softening_keep_the_pressure) {
  const Keys soft{"body.soil.law=mohr_coulomb", "body.soil.cohesion=1e6",          "body.soil.friction_angle=0",
                  "body.soil.shape_factor=10",  "body.soil.residual_cohesion=1e5", "stage.0.softening=false"};
  EXPECT_LT(worst(solve(block + pressed, undrained + soft), "excess_pore_pressure", B * (1 + nu_u) / 3 * 40e3),
            1e-12 * 40e3);
}

FactorOfSafety factor_of(const std::string &text, const Keys &overrides) {
  Scene scene = parse_scene(text, meshes + "/scene.toml", overrides);
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false;
  return make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety();
}

/// Consolidated under p_0 = 100 kPa and loaded by 20 kPa, while the mean effective stress of the plane changes only by
/// what elastic water leaves: s_u = c cos(phi) + s' sin(phi), and the factor is s_u over the radius of 10 kPa.
TEST(Undrained, fails_at_the_strength_of_its_effective_stress) {
  const std::string scene = R"(
[mesh]
section = "box.csv"
size = 0.3
[body.soil]
region = "soil"
density = 2000
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = 2e3
friction_angle = 20
drainage = "undrained"
stress = [-100e3, -100e3, -100e3, 0]
[boundary.base]
kind = "roller"
[boundary.left]
kind = "roller"
[boundary.surface]
kind = "traction"
pressure = "100e3 + 20e3 * t"
[boundary.right]
kind = "traction"
pressure = 100e3
[[stage]]
name = "load"
kind = "quasi_static"
duration = 1
load_steps = 2
)";
  const double phi = 20 * M_PI / 180;
  for (const double psi : {0., 20.}) {
    const double excess = B * (1 + nu_u) / 3 * 20e3, mean = 100e3 + 10e3 - excess;
    const double exact = (2e3 * std::cos(phi) + mean * std::sin(phi)) / 10e3;
    const FactorOfSafety found = factor_of(scene, {"body.soil.dilation_angle=" + std::to_string(psi)});
    EXPECT_TRUE(found.decided);
    EXPECT_LE(found.lower, exact * (1 + 1e-4));
    EXPECT_GE(found.upper, exact * (1 - 1e-4));
  }
  // the same soil drained: (s' + 10 kPa) sin(phi_F) + c_F cos(phi_F) = 10 kPa
  const FactorOfSafety drained = factor_of(scene, {"body.soil.drainage=drained", "body.soil.dilation_angle=20"});
  double low = 0.1, high = 100;
  for (int k = 0; k < 100; ++k) {
    const double F = std::sqrt(low * high), angle = std::atan(std::tan(phi) / F);
    (110e3 * std::sin(angle) + 2e3 / F * std::cos(angle) > 10e3 ? low : high) = F;
  }
  EXPECT_LE(drained.lower, low * (1 + 1e-4));
  EXPECT_GE(drained.upper, low * (1 - 1e-4));
}

/// c_u as cohesion (Undrained B): the factor is c_u over the radius, whatever the water bears.
TEST(Undrained, fails_at_its_undrained_cohesion) {
  const FactorOfSafety found = factor_of(
      block + pressed,
      undrained + Keys{"body.soil.law=mohr_coulomb", "body.soil.cohesion=14e3", "body.soil.friction_angle=0"});
  EXPECT_LE(found.lower, 1.4 * (1 + 1e-4));
  EXPECT_GE(found.upper, 1.4 * (1 - 1e-4));
}

/// Consolidated under 100 kPa, then loaded: s_u = S sigma'_v OCR^m, and what a stage later makes of more stress.
const std::string lifts = R"(
[mesh]
section = "box.csv"
size = 0.3
[body.soil]
region = "soil"
density = 2000
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = "0.1 kPa"
friction_angle = 30
[body.soil.shansep]
stage = "first"
ratio = 0.25
exponent = 0.8
preconsolidation_stress = 180e3
[boundary.base]
kind = "roller"
[boundary.left]
kind = "roller"
[boundary.surface]
kind = "traction"
pressure = "100e3 * t"
[boundary.right]
kind = "traction"
pressure = "60e3 * t"
[[stage]]
name = "first"
kind = "quasi_static"
duration = 1
)";
const std::string second = R"(
[[stage]]
name = "second"
kind = "quasi_static"
duration = 0.5
)";

TEST(Shansep, takes_its_strength_from_the_consolidation_stress) {
  const double after_first = 0.25 * 100e3 * std::pow(1.8, 0.8), after_second = 0.25 * 150e3 * std::pow(1.2, 0.8);
  EXPECT_LT(worst(solve(lifts), "cohesion", after_first), 1e-9 * after_first);
  EXPECT_LT(worst(solve(lifts), "friction_angle", 0), 1e-12);
  EXPECT_LT(worst(solve(lifts + second), "cohesion", after_first), 1e-9 * after_first);
  const Solved renewed = solve(lifts + second, {"body.soil.shansep.stage=['first', 'second']"});
  EXPECT_LT(worst(renewed, "cohesion", after_second), 1e-9 * after_second);
  EXPECT_LT(worst(solve(lifts, {"body.soil.shansep.minimum=50e3"}), "cohesion", 50e3), 1e-6);
}

/// s_u over the radius of 20 kPa.
TEST(Shansep, has_the_factor_of_that_strength) {
  const double exact = 0.25 * 100e3 * std::pow(1.8, 0.8) / 20e3;
  const FactorOfSafety found = factor_of(lifts, {});
  EXPECT_LE(found.lower, exact * (1 + 1e-4));
  EXPECT_GE(found.upper, exact * (1 - 1e-4));
}

std::string complaint(const Keys &overrides, const std::string &scene = block + pressed) {
  try {
    solve(scene, undrained + overrides);
  } catch (const std::exception &error) {
    return error.what();
  }
  return "";
}

TEST(Undrained, refuses_water_that_makes_soil_softer_or_flows) {
  EXPECT_NE(complaint({"body.soil.undrained_poisson_ratio=0.25"}).find("must be above poisson_ratio, 0.3"),
            std::string::npos);
  const std::string saturated = "phases = \"saturated\"\n[water]\n" + box +
                                "porosity = 0.4\ngrain_density = 2650\npermeability = 1e-12\n" + pressed +
                                "[[stage]]\nname = \"load\"\nkind = \"consolidation\"\nduration = 1\n";
  EXPECT_NE(complaint({}, saturated).find("body.soil.drainage"), std::string::npos) << complaint({}, saturated);
  EXPECT_NE(complaint({"body.soil.drained_in=lod"}).find("there is no \"lod\""), std::string::npos);
}

TEST(Shansep, refuses_what_it_cannot_take_its_strength_from) {
  const auto said = [](const Keys &overrides) -> std::string {
    try {
      solve(lifts, overrides);
    } catch (const std::exception &error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(said({"body.soil.shansep.stage=frist"}).find("must name quasi-static or consolidation stages"),
            std::string::npos);
  EXPECT_NE(said({"body.soil.shansep.ratio=0"}).find("must have a ratio above 0"), std::string::npos);
  EXPECT_NE(said({"body.soil.cohesion=0"}).find("body.soil.cohesion"), std::string::npos);
  EXPECT_NE(said({"body.soil.shansep.overconsolidation_ratio=2"}).find("not both"), std::string::npos);
}

}  // namespace
}  // namespace talus
