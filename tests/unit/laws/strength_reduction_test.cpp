/// Claims of reduce_strength: what docs/theory/finite_elements.md (5.1) says of each law, or the reason why a law is
/// not reduced.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "examples.h"

namespace talus {
namespace {

template <class OneLaw>
class StrengthReduction : public ::testing::Test {};
TYPED_TEST_SUITE(StrengthReduction, TypesOf<Laws>::type);

TYPED_TEST(StrengthReduction, is_there_or_says_why_not) {
  for (const TypeParam &law : examples<TypeParam>()) {
    const std::string reason = no_strength_reduction(law);
    constexpr bool reducible = requires(TypeParam l) { l.reduce_strength(2.); };
    EXPECT_EQ(reason.empty(), reducible);
    constexpr bool frictional = std::is_base_of_v<FrictionalStrength, TypeParam>;
    EXPECT_EQ(reducible, (frictional || std::is_same_v<TypeParam, HoekBrown>));
    constexpr bool elastic = std::is_same_v<TypeParam, LinearElastic> || std::is_same_v<TypeParam, HenckyElastic>;
    EXPECT_EQ(never_fails(law), elastic);
  }
}

/// Strength over shear stress, (c - sigma tan(phi)) / tau, of the plane where it is least: the definition of a factor
/// of safety. 4,000 planes between those of the greatest and the least principal stress come within 1e-6 of the
/// minimum.
double least_factor(const std::array<double, 3> &s, double c, double phi) {
  const double mean = (s[0] + s[2]) / 2, radius = (s[0] - s[2]) / 2;
  double least = 1e300;
  for (int k = 1; k < 4000; ++k) {
    const double angle = M_PI * k / 4000;
    least = std::min(least, (c - (mean + radius * std::cos(angle)) * std::tan(phi)) / (radius * std::sin(angle)));
  }
  return least;
}

constexpr double factor = 1.7;

/// Compressed soil under random shear, brought back to the strength divided by `factor`: soil that was beyond it has
/// this factor of safety by the strength c, phi [Pa, rad].
template <class OneLaw>
void expect_factor(const OneLaw &law, double plastic_strain, double c, double phi) {
  Random random;
  Points<3> points(with_reduced_strength(law, factor), 200);
  for (auto &s : points.stress) {
    s = random.symmetric<3>(scale);
    for (int k = 0; k < 3; ++k) s[k] -= 3 * scale;
  }
  const auto fields = history_fields(points.law);
  for (std::size_t k = 0; k < points.history.size(); ++k)
    if (std::string(fields[k % fields.size()].name) == "plastic_strain") points.history[k] = plastic_strain;
  const auto before = points.stress;
  points.admit();
  int yielded = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double found = least_factor(principal(matrix<3>(points.stress[i])), c, phi);
    const bool changed = (matrix<3>(points.stress[i]) - matrix<3>(before[i])).norm() > 1e-9 * scale;
    yielded += changed;
    if (changed)
      EXPECT_NEAR(found, factor, 1e-5);
    else
      EXPECT_GT(found, factor - 1e-5);
  }
  EXPECT_GT(yielded, 50);
}

template <class OneLaw>
class FrictionReduction : public ::testing::Test {};
using FrictionalLaws = ::testing::Types<MohrCoulomb, HenckyMohrCoulomb>;
TYPED_TEST_SUITE(FrictionReduction, FrictionalLaws);

TYPED_TEST(FrictionReduction, gives_the_factor_of_safety_by_which_strength_was_divided) {
  constexpr double c = 20e3, residual_c = 8e3, phi = 30 * degree.si, residual_phi = 20 * degree.si;
  TypeParam law;
  static_cast<MohrCoulomb &>(law) = mohr_coulomb(c, 30, 10);
  expect_factor(law, 0, c, phi);
  law.residual_cohesion = residual_c, law.residual_friction_angle = residual_phi, law.shape_factor = 300;
  expect_factor(law, 1e3, residual_c, residual_phi);
}

TYPED_TEST(FrictionReduction, divides_what_suction_adds_to_the_cohesion) {
  TypeParam law;
  static_cast<MohrCoulomb &>(law) = mohr_coulomb(2e3, 25, 5);
  law.suction_cohesion = 20e3, law.suction_cohesion_rate = 1e-5;
  const double of_suction = 20e3 * (1 - std::exp(-1e-5 * 30e3));  // Points are under 30 kPa
  expect_factor(law, 0, 2e3 + of_suction, 25 * degree.si);
}

TYPED_TEST(FrictionReduction, divides_the_tension_that_soil_bears) {
  TypeParam law;
  static_cast<MohrCoulomb &>(law) = mohr_coulomb(20e3, 30);
  law.tension_cutoff = 5e3;
  Points<3> points(with_reduced_strength(law, factor), 1);
  points.stress[0] = {scale, 0, 0, 0, 0, 0};
  points.admit();
  EXPECT_NEAR(principal(matrix<3>(points.stress[0]))[0], 5e3 / factor, 1e-9 * scale);
  law.tension_cutoff = -1;  // none: the apex is the limit, which stays where it is: c / tan(phi)
  points.law = with_reduced_strength(law, factor);
  points.stress[0] = {scale, scale, scale, 0, 0, 0};
  points.admit();
  EXPECT_NEAR(principal(matrix<3>(points.stress[0]))[0], 20e3 / std::tan(30 * degree.si), 1e-9 * scale);
}

/// The outer cone meets the Mohr-Coulomb strength in triaxial compression, the inner one in extension.
template <class OneLaw>
void expect_cone_factor(Cone cone, double axial) {
  OneLaw law;
  static_cast<DruckerPrager &>(law) = examples<DruckerPrager>()[0];
  law.cone = cone, law.cohesion = 20e3;
  Points<3> points(with_reduced_strength(law, factor), 1);
  points.stress[0] = {-3 * scale, -3 * scale, -3 * scale + axial, 0, 0, 0};
  points.admit();
  EXPECT_NEAR(least_factor(principal(matrix<3>(points.stress[0])), 20e3, 35 * degree.si), factor, 1e-5);
}
TEST(ConeReduction, gives_the_factor_of_safety_by_which_strength_was_divided) {
  expect_cone_factor<DruckerPrager>(Cone::outer, -20 * scale);
  expect_cone_factor<HenckyDruckerPrager>(Cone::outer, -20 * scale);
  expect_cone_factor<DruckerPrager>(Cone::inner, 2.5 * scale);
}

TYPED_TEST(StrengthReduction, holds_dilation_at_the_reduced_friction) {
  if constexpr (std::is_base_of_v<FrictionalStrength, TypeParam>) {
    TypeParam law = examples<TypeParam>()[1];
    law.friction_angle = law.dilation_angle = 35 * degree.si;
    law.reduce_strength(factor);
    EXPECT_NEAR(std::tan(law.friction_angle), std::tan(35 * degree.si) / factor, 1e-14);
    EXPECT_EQ(law.dilation_angle, law.friction_angle);
    law.dilation_angle = 5 * degree.si;
    law.reduce_strength(1.1);
    EXPECT_EQ(law.dilation_angle, 5 * degree.si) << "which is below it";
  }
}

}  // namespace
}  // namespace talus
