/// The laboratory tests of `talus soil` against closed forms.
#include "physics/laws/element_test.h"

#include <gtest/gtest.h>

#include "fixtures.h"
#include "scene/quantity.h"
#include "scene/reader.h"

namespace talus {
namespace {

constexpr double E = 20e6, nu = 0.3;  // [Pa], of the soils below
constexpr double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), G = E / (2 * (1 + nu));

LinearElastic elastic() {
  LinearElastic law;
  law.young_modulus = E, law.poisson_ratio = nu;
  return law;
}

ElementTest test_of(TestType type, double cell_pressure, double strain) {
  ElementTest test;
  test.name = "claim", test.type = type, test.cell_pressure = cell_pressure, test.strain = {strain};
  return test;
}

double failure_ratio(double phi) { return std::pow(std::tan(std::atan(1.) + phi / 2), 2); }  // N

struct Strength {
  double phi_degrees, cohesion, sigma_1;  ///< [deg], [Pa], [Pa] at sigma_3 = 50 kPa
};

/// The four soils of the verification ladder (sigma_1 = sigma_3 N + 2 c sqrt(N), to the digits that are given there).
TEST(ElementTest, triaxial_compression_reaches_mohr_coulomb_strength) {
  for (const Strength &soil : {Strength{35, 5e3, 203.7e3}, {47, 3e3, 337.5e3}, {30, 3e3, 160.4e3}, {40, 1e3, 234.2e3}})
    for (const double psi : {0., soil.phi_degrees}) {
      const auto states = drive(mohr_coulomb(soil.cohesion, soil.phi_degrees, psi),
                                test_of(TestType::triaxial_compression, 50e3, 0.05));
      const ElementState &end = states.back();
      const double N = failure_ratio(soil.phi_degrees * degree.si);
      EXPECT_NEAR(-end.stress[1], soil.sigma_1, 0.05e3 + 1e-9);
      EXPECT_NEAR(-end.stress[1], 50e3 * N + 2 * soil.cohesion * std::sqrt(N), 1e-9 * soil.sigma_1);
      EXPECT_NEAR(end.stress[0], -50e3, 1e-5);
      EXPECT_NEAR(end.stress[2], -50e3, 1e-5);
      // dilation: d eps_v / d eps_1 = 2 sin psi / (1 - sin psi) in compression, elasticity at rest
      const ElementState &before = states[states.size() - 20];
      const double sine = std::sin(psi * degree.si);
      const double axial = before.strain[1] - end.strain[1];
      EXPECT_NEAR((before.compression() - end.compression()) / axial, 2 * sine / (1 - sine), 1e-6);
    }
}

TEST(ElementTest, triaxial_extension_reaches_mohr_coulomb_strength) {
  const auto states = drive(mohr_coulomb(5e3, 35), test_of(TestType::triaxial_extension, 100e3, 0.05));
  const double N = failure_ratio(35 * degree.si);
  EXPECT_NEAR(-states.back().stress[1] * N + 2 * 5e3 * std::sqrt(N), 100e3, 1e-4);
  EXPECT_NEAR(states.back().stress[0], -100e3, 1e-5);
}

TEST(ElementTest, biaxial_follows_plane_strain_elasticity_and_strength) {
  const ElementState soft = drive(elastic(), test_of(TestType::biaxial, 100e3, 0.01)).back();
  const double axial = -0.01;
  EXPECT_NEAR(soft.stress[1] + 100e3, E / (1 - nu * nu) * axial, 1e-6 * E * 0.01);
  EXPECT_NEAR(soft.strain[0], -nu / (1 - nu) * axial, 1e-8);
  EXPECT_NEAR(soft.stress[2] + 100e3, nu * (soft.stress[1] + 100e3), 1e-6 * E * 0.01);
  EXPECT_EQ(soft.strain[2], 0);
  const ElementState failed = drive(mohr_coulomb(5e3, 35, 5), test_of(TestType::biaxial, 50e3, 0.05)).back();
  EXPECT_NEAR(-failed.stress[1], 203.7e3, 0.05e3);
}

TEST(ElementTest, oedometer_loads_and_unloads_with_the_constrained_modulus) {
  ElementTest test = test_of(TestType::oedometer, 50e3, 0.02);
  test.strain = {0.02, 0.01, 0.04};
  const auto states = drive(elastic(), test);
  ASSERT_EQ(states.size(), 601u);
  for (const int k : {200, 400, 600}) {
    const double driven = test.strain[k / 200 - 1];
    EXPECT_NEAR(states[k].strain[1], -driven, 1e-12);
    EXPECT_NEAR(states[k].stress[1], -50e3 - (lambda + 2 * G) * driven, 1e-6 * E * driven);
    EXPECT_NEAR(states[k].stress[0], -50e3 - lambda * driven, 1e-6 * E * driven);
  }
}

TEST(ElementTest, isotropic_compression_follows_the_bulk_modulus) {
  const ElementState end = drive(elastic(), test_of(TestType::isotropic_compression, 50e3, 0.03)).back();
  EXPECT_NEAR(end.mean_pressure(), 50e3 + (lambda + 2 * G / 3) * 0.03, 1e-6 * E * 0.03);
  EXPECT_NEAR(end.deviator(), 0, 1e-6);
}

/// dp' = (1 - B) dp, and dp = dq / 3 as the cell pressure stays; B = 1 / (1 + n K / K_l).
TEST(ElementTest, undrained_path_of_elastic_soil_leans_by_skempton_b) {
  const double K = lambda + 2 * G / 3;
  for (const double B : {0.3, 0.9, 1.})
    for (const bool stiffness : {false, true}) {
      if (stiffness && B == 1) continue;
      ElementTest test = test_of(TestType::triaxial_compression, 100e3, 0.005);
      test.undrained = true, test.pore_pressure = 20e3;
      (stiffness ? test.pore_stiffness : test.skempton_b) = stiffness ? K * B / (1 - B) : B;
      for (const ElementState &s : drive(elastic(), test)) {
        const double total_rise = s.deviator() / 3;
        EXPECT_NEAR(s.mean_pressure() - 100e3, (1 - B) * total_rise, 1e-3);
        EXPECT_NEAR(s.pore_pressure - 20e3, B * total_rise, 1e-3);
        EXPECT_NEAR(s.stress[0] - s.pore_pressure, -120e3, 1e-4);
      }
    }
}

/// A soil without dilation that keeps its volume keeps p': it fails where its path meets the strength.
TEST(ElementTest, undrained_shear_strength_of_mohr_coulomb_follows_from_the_mean_pressure) {
  ElementTest test = test_of(TestType::triaxial_compression, 100e3, 0.05);
  test.undrained = true;
  const double phi = 30 * degree.si, c = 4e3;
  const ElementState end = drive(mohr_coulomb(c, 30), test).back();
  // a step of 2.5e-4 loses a share of 1e-8 of its volume to the midpoint rule, theory (3.4)
  EXPECT_NEAR(end.mean_pressure(), 100e3, 0.01);
  EXPECT_NEAR(end.deviator(), 6 * (c * std::cos(phi) + 100e3 * std::sin(phi)) / (3 - std::sin(phi)), 0.01);
  EXPECT_NEAR(end.pore_pressure, end.deviator() / 3, 0.01);
  EXPECT_NEAR(end.compression(), 0, 1e-12);
}

/// With the elastic rate of this code, which turns with the material: s_xy = G sin gamma, s_xx = -s_yy = G (1 - cos
/// gamma). A step turns its own increment too, by d gamma / 2, where its middle would by half of that: first order,
/// gamma d gamma / 2.
TEST(ElementTest, simple_shear_of_given_strain_turns_the_stress) {
  ElementTest test;
  test.name = "claim", test.type = TestType::controlled, test.cell_pressure = 0;
  test.control.strain[3] = Function("0.5 * t", 1);
  const ElementState end = drive(elastic(), test).back();
  const double late = 1.05 * 0.5 * (0.5 / test.steps) / 2;
  EXPECT_NEAR(end.stress[3], G * std::sin(0.5), late * G);
  EXPECT_NEAR(end.stress[0], G * (1 - std::cos(0.5)), late * G);
  EXPECT_NEAR(end.stress[1], -end.stress[0], 1e-9 * G);
}

TEST(ElementTest, simple_shear_under_constant_load_reaches_the_strength_of_its_plane) {
  const ElementState end = drive(mohr_coulomb(0, 30), test_of(TestType::simple_shear, 100e3, 0.2)).back();
  EXPECT_NEAR(end.stress[1], -100e3, 1e-4);
  const double ratio = end.stress[3] / 100e3, sine = std::sin(30 * degree.si), cosine = std::cos(30 * degree.si);
  // without dilation stress and strain increment become coaxial: s_xx = s_yy, tau = sin(phi) times the centre of the
  // circle
  EXPECT_NEAR(ratio, sine, 0.02);
  EXPECT_LT(ratio, sine / cosine);
}

TEST(ElementTest, stress_and_strain_can_be_given_component_by_component) {
  ElementTest test;
  test.name = "claim", test.type = TestType::controlled, test.cell_pressure = 100e3;
  test.control.stress[0] = Function("-100e3 - 30e3 * t", 1);
  test.control.stress[1] = Function("-100e3 - 60e3 * t", 1);
  test.control.stress[3] = Function("10e3 * t", 1);
  const ElementState end = drive(elastic(), test).back();
  EXPECT_NEAR(end.stress[0], -130e3, 1e-3);
  EXPECT_NEAR(end.stress[1], -160e3, 1e-3);
  EXPECT_NEAR(end.stress[3], 10e3, 1e-3);
  EXPECT_NEAR(end.stress[2], -100e3 - nu * 90e3, 100);  // plane strain, but for the small rotation
  EXPECT_NEAR(end.strain[3], 10e3 / G, 1e-2 * 10e3 / G);
}

/// c = c' + dc_max (1 - exp(-B s)), phi = phi' + A s: stronger by what the suction at that point of the test adds;
/// wetting takes it away again.
TEST(ElementTest, suction_gives_strength_and_wetting_takes_it) {
  MohrCoulomb soil = mohr_coulomb(1e3, 23);
  soil.suction_cohesion = 15e3, soil.suction_cohesion_rate = 7e-7, soil.suction_friction_rate = 1e-7 * degree.si;
  const auto strength = [&](double s) {
    const double c = 1e3 + 15e3 * (1 - std::exp(-7e-7 * s)), N = failure_ratio((23 + 1e-7 * s) * degree.si);
    return 50e3 * N + 2 * c * std::sqrt(N);
  };
  ElementTest test = test_of(TestType::triaxial_compression, 50e3, 0.05);
  for (const double s : {0., 100e3, 800e3}) {
    test.suction = s;
    const ElementState end = drive(soil, test).back();
    EXPECT_NEAR(-end.stress[1], strength(s), 1e-9 * strength(s));
    EXPECT_EQ(end.suction, s);
  }
  test.suction = Function("8e5 * (1 - t)", 1);
  const auto states = drive(soil, test);
  for (const int k : {100, 150, 200}) {
    EXPECT_NEAR(states[k].suction, 8e5 * (1 - k / 200.), 1e-6);
    EXPECT_NEAR(-states[k].stress[1], strength(states[k].suction), 1e-9 * strength(0));
  }
}

/// A strain of 1 in `duration` is a rate: tau = mu gamma_dot, tau = tau_y + mu gamma_dot, tau = mu(I) p.
TEST(ElementTest, duration_sets_the_rate_of_laws_that_flow) {
  ElementTest test = test_of(TestType::simple_shear, 10e3, 1);
  test.duration = 0.1;  // gamma_dot = 10 / s
  Newtonian fluid;
  fluid.young_modulus = 1e6, fluid.poisson_ratio = 0.4, fluid.viscosity = 100;
  const ElementState flown = drive(fluid, test).back();
  EXPECT_NEAR(flown.time, 0.1, 1e-12);
  EXPECT_NEAR(flown.stress[3], 1e3,
              0.02e3);  // a step turns its strain with itself: first order, as in simple shear above
  Bingham mud;
  mud.young_modulus = 1e6, mud.poisson_ratio = 0.4, mud.viscosity = 100, mud.yield_stress = 500;
  EXPECT_NEAR(drive(mud, test).back().stress[3], 1.5e3, 0.03e3);
  MuI sand;
  sand.young_modulus = 20e6, sand.poisson_ratio = 0.3, sand.static_friction = 0.38, sand.limiting_friction = 0.64,
  sand.grain_size = 1e-2;
  const ElementState end = drive(sand, test).back();
  const double p = end.mean_pressure(), I = 10 * 1e-2 * std::sqrt(2650 / p), mu = 0.38 + 0.26 / (1 + 0.3 / I);
  EXPECT_NEAR(end.deviator() / std::sqrt(3.), mu * p, 2e-3 * mu * p);
}

TEST(ElementTest, refuses_tests_that_do_not_suit_the_law) {
  const auto refusal = [](const Law &law, const ElementTest &test) -> std::string {
    try {
      drive(law, test);
    } catch (const std::invalid_argument &error) {
      return error.what();
    }
    return "";
  };
  ElementTest test = test_of(TestType::simple_shear, 10e3, 1);
  Bingham mud;
  mud.young_modulus = 1e6, mud.poisson_ratio = 0.4, mud.viscosity = 100, mud.yield_stress = 500;
  EXPECT_NE(refusal(mud, test).find("test.claim: the law bingham flows with time; give the test a duration"),
            std::string::npos);
  test.suction = 1e5;
  EXPECT_NE(refusal(elastic(), test).find("linear_elastic takes no strength from suction"), std::string::npos);
}

CamClay clay() {
  CamClay law;
  law.compression_slope = 0.2, law.swelling_slope = 0.04, law.critical_stress_ratio = 1, law.poisson_ratio = 0.3;
  law.void_ratio = 1, law.preconsolidation_pressure = 100e3, law.attraction = 1;
  return law;
}

/// Lines of slope lambda and kappa in v and ln p, to what a step loses of its volume to the midpoint rule, theory
/// (3.4). The ladder has the drained and undrained triaxial paths.
TEST(ElementTest, cam_clay_is_compressed_and_swells_along_its_lines) {
  ElementTest test = test_of(TestType::isotropic_compression, 100e3, 0);
  test.strain = {0.1, 0.05};
  const auto states = drive(clay(), test);
  const auto log_p = [&](int k) { return std::log(states[k].mean_pressure() + 1); };
  EXPECT_NEAR(log_p(200) - log_p(0), 2 * (1 - std::exp(-0.1)) / 0.2, 1e-8);
  EXPECT_NEAR(log_p(200) - log_p(400), 2 * (std::exp(-0.05) - std::exp(-0.1)) / 0.04, 1e-8);
}

/// One-dimensional compression comes to the constant eta = q / p at which eps_q / eps_v = 2 / 3: the flow rule for the
/// share Lambda of the volume that is plastic, and d eps_q = dq / (3 G) with dq / q = dp / p for the rest (Muir Wood
/// 1990, sec. 10.3): 2 eta / (M^2 - eta^2) Lambda + (1 - Lambda) eta K / (3 G) = 2 / 3.
TEST(ElementTest, cam_clay_in_the_oedometer_comes_to_its_k0) {
  ElementTest test = test_of(TestType::oedometer, 100e3, 0.25);
  test.steps = 1000;
  const CamClay law = clay();
  const ElementState end = drive(law, test).back();
  const double Lambda = 0.8, K_over_3G = 1 / (3 * law.shear_over_bulk());
  double low = 0, high = 0.999;
  for (int k = 0; k < 60; ++k) {
    const double eta = (low + high) / 2, ratio = 2 * eta / (1 - eta * eta) * Lambda + 0.2 * eta * K_over_3G;
    (ratio > 2. / 3 ? high : low) = eta;
  }
  EXPECT_NEAR(end.deviator() / (end.mean_pressure() + 1), low, 2e-3);
}

TEST(ElementTest, says_where_a_soil_softens_faster_than_it_unloads) {
  MohrCoulomb clay = mohr_coulomb(13e3, 24.5);
  clay.residual_cohesion = 4.7e3, clay.residual_friction_angle = 13.5 * degree.si, clay.shape_factor = 500;
  ElementTest test = test_of(TestType::biaxial, 100e3, 0.1);
  try {
    drive(clay, test);
    FAIL() << "the stress snaps back: no step of the axial strain has an answer near by";
  } catch (const ElementTestError &error) {
    EXPECT_NE(std::string(error.what()).find("test claim"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("element_size"), std::string::npos);
  }
  clay.reference_size = 0.7, test.element_size = 0.1;  // eta = 71
  const double N = failure_ratio(13.5 * degree.si);
  EXPECT_NEAR(-drive(clay, test).back().stress[1], 100e3 * N + 2 * 4.7e3 * std::sqrt(N),
              500);  // all but exp(-71 * 0.1) of the way
}

std::string complaint(const std::string &text) {
  SoilFile file;
  try {
    TableReader::from_text(
        "[material]\nlaw = \"linear_elastic\"\nyoung_modulus = 1e7\npoisson_ratio = 0.3\n[test.a]\n" + text,
        "soil.toml")
        .fill(file);
  } catch (const SceneError &error) {
    return error.what();
  }
  return "";
}

TEST(ElementTest, reads_tests_and_refuses_those_that_contradict_themselves) {
  EXPECT_EQ(complaint("undrained = true\nskempton_b = 0.9\ncell_pressure = \"80 kPa\"\nstrain = [0.1, 0.05]"), "");
  EXPECT_EQ(complaint("type = \"controlled\"\ncontrol.stress_yy = \"-1e5 * (1 + t)\""), "");
  const std::pair<const char *, const char *> faults[] = {
      {"type = \"triaxal\"", "did you mean"},
      {"cell_pressure = \"80 m\"", "Pa"},
      {"cell_presure = 1", "did you mean `cell_pressure`?"},
      {"stress = [1, 2]", "3 components"},
      {"strain = []", "needs strain"},
      {"control.strain_xx = 0.1", "controlled"},
      {"type = \"controlled\"", "needs a table control"},
      {"type = \"controlled\"\ncontrol = { strain_xx = 0.1, stress_xx = 3 }", "either strain_xx or stress_xx"},
      {"skempton_b = 0.5", "undrained"},
      {"undrained = true\nskempton_b = 0.5\npore_stiffness = 1e9", "either"},
      {"type = \"oedometer\"\nundrained = true", "keeps its volume"},
      {"steps = 0", "steps"},
      {"suction = -1", "suction"},
      {"undrained = true\nsuction = 1e5", "either undrained or suction"},
      {"duration = \"1 m\"", "s"},
  };
  for (const auto &[text, word] : faults) {
    SCOPED_TRACE(text);
    EXPECT_NE(complaint(text).find(word), std::string::npos) << complaint(text);
    EXPECT_NE(complaint(text).find("soil.toml"), std::string::npos);
  }
}

}  // namespace
}  // namespace talus
