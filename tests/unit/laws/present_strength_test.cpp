// What results say of the strength of a point: the friction angle that its stress mobilises, and its state.
#include "physics/laws/present_strength.h"

#include "examples.h"

namespace talus {
namespace {

constexpr Surroundings around{0.7};

/// c = 10 kPa, phi = 30 degrees, which fall to 2 kPa and 20 degrees.
MohrCoulomb softening_clay() {
  MohrCoulomb clay;
  clay.young_modulus = 20e6, clay.poisson_ratio = 0.3;
  clay.cohesion = 10e3, clay.friction_angle = 30 * degree.si;
  clay.residual_cohesion = 2e3, clay.residual_friction_angle = 20 * degree.si, clay.shape_factor = 100;
  return clay;
}

Mobilised of(const Law &law, const Stress<2> &stress, double plastic_strain = 0, const Surroundings &where = around) {
  return PresentStrength(law)(stress, plastic_strain, where);
}

/// Degrees of a circle from s3 to s1 [kPa] under an envelope with this c [kPa] and phi [degrees].
double angle(double s1, double s3, double c, double phi) {
  return std::asin((s1 - s3) / (2 * c / std::tan(phi * degree.si) - s1 - s3)) / degree.si;
}

TEST(PresentStrength, mobilises_the_angle_of_the_circle_under_the_present_envelope) {
  const Law clay = softening_clay();
  const Stress<2> stress{-75e3, -75e3, -60e3, 25e3};  // principal -50, -60 and -100 kPa
  EXPECT_NEAR(of(clay, stress).friction_angle / degree.si, 15.712, 1e-3);
  EXPECT_NEAR(of(clay, stress).friction_angle / degree.si, angle(-50, -100, 10, 30), 1e-9);
  // half of the fall is over: c = 6 kPa, phi = 25 degrees
  EXPECT_NEAR(of(clay, stress, std::log(2.) / 100).friction_angle / degree.si, angle(-50, -100, 6, 25), 1e-6);
  EXPECT_NEAR(of(clay, stress, 1).friction_angle / degree.si, angle(-50, -100, 2, 20), 1e-6);
}

TEST(PresentStrength, is_that_of_place_and_suction) {
  MohrCoulomb soil = softening_clay();
  soil.suction_cohesion = 15e3, soil.suction_cohesion_rate = 7e-6, soil.suction_friction_rate = 1e-7 * degree.si;
  soil.reads_shares = true;
  const Stress<2> stress{-75e3, -75e3, -60e3, 25e3};
  const double c = 0.5 * 10 + 15 * (1 - std::exp(-7e-6 * 200e3)), phi = 0.8 * 30 + 0.02;
  EXPECT_NEAR(
      of(soil, stress, 0, {.size = 0.7, .suction = 200e3, .cohesion = 0.5, .friction = 0.8}).friction_angle / degree.si,
      angle(-50, -100, c, phi), 1e-6);
}

TEST(PresentStrength, softens_with_the_size_of_the_cell_as_the_law_does) {
  MohrCoulomb clay = softening_clay();
  clay.reference_size = 0.7;
  const double half = std::log(2.) / 100;
  EXPECT_EQ(of(clay, {-1e4, -1e4, -1e4, 0}, 0.05 * half).state, StrengthState::elastic);
  EXPECT_EQ(of(clay, {-1e4, -1e4, -1e4, 0}, half).state, StrengthState::softening);
  EXPECT_EQ(of(clay, {-1e4, -1e4, -1e4, 0}, half, {14}).state, StrengthState::residual);
  EXPECT_EQ(of(clay, {-1e4, -1e4, -1e4, 0}, half, {0.014}).state, StrengthState::elastic);
}

/// Stress that a law has brought back to its yield surface is at the peak and mobilises phi, wherever on the surface it
/// is; two thirds of its deviator are elastic. On a cone the angle depends on the place, the state does not.
template <class OneLaw>
void expect_peak_at_the_yield_surface(OneLaw law) {
  law.residual_cohesion = law.residual_friction_angle = -1, law.shape_factor = 0, law.tension_cutoff = -1;
  const PresentStrength strength{Law(law)};
  Random random;
  constexpr int count = 200;
  Points<3> points(law, count, 0.7);
  for (int i = 0; i < count; ++i) {
    points.stress[i] = random.symmetric<3>(60e3);
    for (int k = 0; k < 3; ++k) points.stress[i][k] -= 40e3;
  }
  const auto trial = points.stress;
  points.admit();
  int yielded = 0;
  for (int i = 0; i < count; ++i) {
    if (trial[i] == points.stress[i]) continue;
    ++yielded;
    Stress<3> s;
    std::memcpy(&s, points.stress[i].data(), sizeof s);
    const Mobilised found = strength(s, 0, around);
    EXPECT_EQ(found.state, StrengthState::peak) << i;
    EXPECT_NEAR(found.friction_angle, law.friction_angle, 1e-5) << i;
    const Invariants<3> invariants(s);
    invariants.take_off(s, 1. / 3, 1e3);
    EXPECT_EQ(strength(s, 0, around).state, StrengthState::elastic) << i;
    EXPECT_LT(strength(s, 0, around).friction_angle, law.friction_angle) << i;
  }
  EXPECT_GT(yielded, count / 4);
}
TEST(PresentStrength, is_at_its_peak_on_the_surface_of_mohr_and_coulomb) {
  expect_peak_at_the_yield_surface(softening_clay());
}

TEST(PresentStrength, is_at_its_peak_on_the_cone) {
  DruckerPrager clay;
  clay.young_modulus = 20e6, clay.poisson_ratio = 0.3, clay.cohesion = 10e3, clay.friction_angle = 30 * degree.si;
  // triaxial compression, which the outer cone matches: s1 = 10 kPa
  const double s1 = -10e3, s3 = (s1 * 1.5 - 2 * 10e3 * std::cos(30 * degree.si)) / 0.5;
  EXPECT_NEAR(of(clay, {s1, s3, s1, 0}).friction_angle / degree.si, 30, 1e-6);
  EXPECT_EQ(of(clay, {s1, s3, s1, 0}).state, StrengthState::peak);
  EXPECT_EQ(of(clay, {s1, 0.9 * s3, s1, 0}).state, StrengthState::elastic);
}

TEST(PresentStrength, at_the_cut_off_is_the_peak) {
  MohrCoulomb clay = softening_clay();
  clay.tension_cutoff = 3e3;
  EXPECT_EQ(of(clay, {3e3, 1e3, 2e3, 0}).state, StrengthState::peak);
  EXPECT_EQ(of(clay, {2e3, 1e3, 2e3, 0}).state, StrengthState::elastic);
}

TEST(PresentStrength, has_limits_where_the_angle_has_none) {
  MohrCoulomb soil = softening_clay();
  const double apex = 10e3 / std::tan(30 * degree.si);
  EXPECT_NEAR(of(soil, {apex, apex, apex, 0}).friction_angle / degree.si, 30, 1e-6);  // the whole of it, not 0 / 0
  EXPECT_EQ(of(soil, {0, 0, 0, 0}).friction_angle, 0);
  soil.cohesion = soil.residual_cohesion = 0;
  EXPECT_EQ(of(soil, {0, 0, 0, 0}).friction_angle, 0);
  EXPECT_EQ(of(soil, {0, 0, 0, 0}).state, StrengthState::elastic) << "sand without stress";
  EXPECT_EQ(of(soil, {-1e-13, -7e-13, -3e-13, 2e-13}).friction_angle, 0) << "nor with round-off of stress";
  EXPECT_GT(of(soil, {-1, -1.5, -1.2, 0}).friction_angle, 0);
  soil.cohesion = 10e3, soil.friction_angle = soil.residual_friction_angle = 0;
  EXPECT_TRUE(std::isnan(of(soil, {-1e3, -9e3, -5e3, 0}).friction_angle));
  EXPECT_EQ(of(soil, {-1e3, -9e3, -5e3, 0}).state, StrengthState::elastic);
  EXPECT_EQ(of(soil, {-1e3, -21e3, -11e3, 0}).state, StrengthState::peak);
}

TEST(PresentStrength, is_that_of_frictional_laws) {
  EXPECT_TRUE(PresentStrength(HenckyMohrCoulomb{}).known());
  EXPECT_TRUE(PresentStrength(DruckerPrager{}).known());
  EXPECT_FALSE(PresentStrength(LinearElastic{}).known());
  EXPECT_FALSE(PresentStrength(CamClay{}).known());
}

}  // namespace
}  // namespace talus
