/// Hoek-Brown against its closed form, docs/theory/laws/hoek_brown.md.
#include <gtest/gtest.h>

#include "examples.h"
#include "physics/laws/element_test.h"
#include "physics/laws/present_strength.h"

namespace talus {
namespace {

HoekBrown prepared(HoekBrown law) {
  law.prepare();
  return law;
}
HoekBrown weak() { return prepared(examples<HoekBrown>()[0]); }

/// sigma_1 of (HB.1), positive in compression [Pa].
double strength(const HoekBrown &law, double sigma_3) {
  return sigma_3 + law.intact_strength * std::pow(law.m_b * sigma_3 / law.intact_strength + law.s, law.a);
}

/// Hammah et al. (2005), example 1: m_b = 0.067, s = 2.5e-5 (2.6e-5 by (HB.2)), a = 0.619.
TEST(HoekBrown, has_the_constants_that_are_published) {
  const HoekBrown law = weak();
  EXPECT_NEAR(law.m_b, 0.067, 5e-4);
  EXPECT_NEAR(law.s, 2.6e-5, 5e-7);
  EXPECT_NEAR(law.a, 0.619, 5e-4);
  HoekBrown intact = law;
  intact.geological_strength_index = 100, intact.prepare();
  EXPECT_DOUBLE_EQ(intact.m_b, 2);
  EXPECT_DOUBLE_EQ(intact.s, 1);
  EXPECT_NEAR(intact.a, 0.5, 1e-12);
}

TEST(HoekBrown, reaches_its_strength_in_triaxial_tests) {
  for (const HoekBrown &law : examples<HoekBrown>()) {
    if (law.divisor != 1) continue;
    const HoekBrown own = prepared(law);
    for (const double cell : {0., 50e3, 500e3}) {
      ElementTest test;
      test.cell_pressure = cell, test.strain = {0.2};
      EXPECT_NEAR(-drive(law, test).back().stress[1], strength(own, cell), 1e-8 * strength(own, cell));
      test.type = TestType::triaxial_extension, test.strain = {0.2};
      const double axial = -drive(law, test).back().stress[1];
      if (cell > 100e3) EXPECT_NEAR(cell, strength(own, axial), 1e-8 * cell);
    }
  }
}

TEST(HoekBrown, tears_at_its_apex_or_at_its_cut_off) {
  for (const double cutoff : {-1., 4e3}) {
    HoekBrown law = weak();
    law.tension_cutoff = cutoff;
    Points<3> points(law, 2);
    points.stress[0] = {1e6, 1e6, 1e6, 0, 0, 0};
    points.stress[1] = {1e6, -2e4, -2e4, 0, 0, 0};
    points.admit();
    const double limit = cutoff < 0 ? law.s * law.intact_strength / law.m_b : cutoff;
    EXPECT_NEAR(points.stress[0][0], limit, 1e-9 * limit);
    EXPECT_NEAR(points.stress[1][0], limit, 1e-9 * limit);
  }
}

/// Hammah et al. (2005): the envelope with tau / F at each normal stress. The plane of least factor of a stress on the
/// reduced surface has the factor F by the whole envelope.
TEST(HoekBrown, gives_the_factor_of_safety_by_which_strength_was_divided) {
  const HoekBrown law = weak();
  constexpr double factor = 1.7;
  const auto least = [&](double high, double low) {
    double found = 1e300;
    const double centre = (high + low) / 2, radius = (high - low) / 2;
    for (double x = law.least * 10; x < 1; x *= 1.0005) {  // Balmer's points of the envelope
      const double d = law.intact_strength * std::pow(x, law.a), rise = law.a * law.m_b * std::pow(x, law.a - 1);
      const double normal = (x - law.s) * law.scale + d / (2 + rise), tau = d * std::sqrt(1 + rise) / (2 + rise);
      const double room = radius * radius - (normal - centre) * (normal - centre);
      if (room > 0) found = std::min(found, tau / std::sqrt(room));
    }
    return found;
  };
  Random random;
  Points<3> points(with_reduced_strength(law, factor), 100);
  for (auto &s : points.stress) {
    s = random.symmetric<3>(3e5);
    for (int k = 0; k < 3; ++k) s[k] -= 2e5;
  }
  const auto before = points.stress;
  points.admit();
  int yielded = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (points.stress[i] == before[i]) continue;
    const auto s = principal(matrix<3>(points.stress[i]));
    if (s[0] > 0) continue;  // torn, or nearly
    ++yielded;
    EXPECT_NEAR(least(-s[2], -s[0]), factor, 1e-5);
  }
  EXPECT_GT(yielded, 30);
}

TEST(HoekBrown, has_a_share_of_its_strength_by_place) {
  HoekBrown law = weak();
  law.reads_shares = true;
  const std::vector<double> share{1 / 1.4, 1};
  Points<3> points(law, 2), whole(examples<HoekBrown>()[0], 1), divided(with_reduced_strength(weak(), 1.4), 1);
  const Components<3> beyond{-1e5, -1.2e5, -9e5, 1e4, 0, 2e4};
  points.stress[0] = points.stress[1] = whole.stress[0] = divided.stress[0] = beyond;
  StressPoints<3> view = points.view();
  view.cohesion_share = share.data();
  admit_stress<3>(points.law, view);
  whole.admit(), divided.admit();
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(points.stress[0][k], divided.stress[0][k], 1e-6);
    EXPECT_NEAR(points.stress[1][k], whole.stress[0][k], 1e-6);
  }
}

TEST(HoekBrown, says_what_of_its_strength_a_stress_takes) {
  const HoekBrown law = weak();
  const PresentStrength strength_of(law);
  ASSERT_TRUE(strength_of.known());
  const double sigma_1 = strength(law, 50e3);
  const Stress<2> yields{-50e3, -sigma_1, -60e3, 0}, rests{-50e3, -0.5 * (50e3 + sigma_1), -60e3, 0};
  EXPECT_EQ(strength_of(yields, 0, {1}).state, StrengthState::peak);
  EXPECT_EQ(strength_of(rests, 0, {1}).state, StrengthState::elastic);
  EXPECT_NEAR(law.share_of_strength(yields, 0, {1}), 1, 1e-9);
  const auto line = law.line_at(-50e3);
  EXPECT_NEAR((1 + std::sin(line.phi)) * 50e3 - (1 - std::sin(line.phi)) * sigma_1, -2 * line.c * std::cos(line.phi),
              1e-6);
  EXPECT_NEAR(law.radius_at((50e3 + sigma_1) / 2), (sigma_1 - 50e3) / 2, 1e-6);
}

}  // namespace
}  // namespace talus
