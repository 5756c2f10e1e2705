#include <gtest/gtest.h>

#include "fixtures.h"

namespace talus {
namespace {

DruckerPrager drucker_prager(double cohesion, double phi_degrees, double psi_degrees, Cone cone = Cone::outer) {
  DruckerPrager law;
  law.young_modulus = 20e6, law.poisson_ratio = 0.3, law.cone = cone;
  law.cohesion = cohesion, law.friction_angle = phi_degrees * degree.si, law.dilation_angle = psi_degrees * degree.si;
  law.prepare();
  return law;
}

/// sqrt(J2) + eta p - xi c.
double excess(const DruckerPrager &law, const Matrix &s) {
  const double p = s.trace() / 3;
  return (s - p * Matrix::Identity()).norm() / std::sqrt(2.) + law.eta * p - law.xi * law.cohesion;
}

template <class D>
class DruckerPragerIn : public ::testing::Test {};
TYPED_TEST_SUITE(DruckerPragerIn, Dims);

/// One million trial states in all. Past the apex no stress but the apex itself is left.
TYPED_TEST(DruckerPragerIn, returns_onto_its_cone) {
  constexpr int dim = TypeParam::value, n = 10000;
  Random random;
  double worst = 0;
  for (int number = 0; number < 100; ++number) {
    const double phi = number % 7 == 0 ? 0 : random.between(0, 45);
    const DruckerPrager law = drucker_prager(number % 5 ? random.between(0, 1e4) : 0, phi, random.between(0, phi),
                                             static_cast<Cone>(number % 4));
    Points<dim> points(law, n);
    for (auto &s : points.stress) s = random.symmetric<dim>(std::pow(10, random.between(2, 6)));
    const auto trial = points.stress;
    points.admit();
    for (int i = 0; i < n; ++i) {
      const Matrix before = matrix<dim>(trial[i]), after = matrix<dim>(points.stress[i]);
      const double size = before.norm() + law.cohesion;
      const bool elastic = excess(law, before) <= 0;
      worst = std::max(worst, (elastic ? (after - before).norm() : std::abs(excess(law, after))) / size);
    }
  }
  EXPECT_LT(worst, 1e-14);
}

/// On the cone the stress falls along D : flow, flow = deviator / (2 sqrt J2) + eta_bar / 3 I; at the apex it is
/// spherical.
TEST(DruckerPrager, flows_along_its_potential) {
  Random random;
  const DruckerPrager law = drucker_prager(5e3, 30, 12);
  const double apex = law.xi * law.cohesion / law.eta;
  for (int i = 0; i < 2000; ++i) {
    Points<3> point(law, 1);
    point.stress[0] = random.symmetric<3>(3e4);
    const Matrix before = matrix<3>(point.stress[0]);
    point.admit();
    const Matrix drop = before - matrix<3>(point.stress[0]);
    if (drop.norm() == 0) continue;
    const double p = before.trace() / 3, q = (before - p * Matrix::Identity()).norm() / std::sqrt(2.);
    const double slip = excess(law, before) / (law.shear_modulus() + law.bulk_modulus() * law.eta * law.eta_bar);
    if (q > law.shear_modulus() * slip) {
      const Matrix flow = (before - p * Matrix::Identity()) / (2 * q) + law.eta_bar / 3 * Matrix::Identity();
      EXPECT_LT((elastic_strain(law, drop) - slip * flow).norm(), 1e-13 * slip);
      EXPECT_NEAR(point.history[1], slip * law.eta_bar, 1e-13);
    } else {
      EXPECT_LT((matrix<3>(point.stress[0]) - apex * Matrix::Identity()).norm(), 1e-9);
    }
    const Matrix plastic = elastic_strain(law, drop);
    const Matrix deviator = plastic - plastic.trace() / 3 * Matrix::Identity();
    EXPECT_NEAR(point.history[0], std::sqrt(2. / 3) * deviator.norm(), 1e-15);
  }
}

/// The cones touch Mohr-Coulomb where they say: outer in triaxial compression, inner in extension.
TEST(DruckerPrager, cones_match_mohr_coulomb) {
  const double phi = 33 * degree.si, c = 8e3, sine = std::sin(phi), cosine = std::cos(phi), least = -2e5;
  const double greatest = (least * (1 - sine) + 2 * c * cosine) / (1 + sine);
  const Matrix compression = Eigen::Vector3d(greatest, greatest, least).asDiagonal(),
               extension = Eigen::Vector3d(greatest, least, least).asDiagonal();
  EXPECT_NEAR(excess(drucker_prager(c, 33, 0, Cone::outer), compression), 0, 1e-9);
  EXPECT_NEAR(excess(drucker_prager(c, 33, 0, Cone::inner), extension), 0, 1e-9);
  const DruckerPrager middle = drucker_prager(c, 33, 0, Cone::compromise);
  EXPECT_NEAR(middle.eta, (drucker_prager(c, 33, 0, Cone::outer).eta + drucker_prager(c, 33, 0, Cone::inner).eta) / 2,
              1e-15);
}

/// With associated flow the plane-strain cone carries in plane strain what Mohr-Coulomb carries; the strain follows the
/// flow of both, so that stress comes to rest.
TEST(DruckerPrager, plane_strain_cone_matches_mohr_coulomb_in_plane_strain) {
  const double phi = 20 * degree.si, c = 8e3;
  Points<2> point(drucker_prager(c, 20, 20, Cone::plane_strain), 1);
  point.stress[0] = {-1e5, -1e5, -1e5, 0};
  point.increment[0].strain = {1e-4 * (1 + std::sin(phi)), -1e-4 * (1 - std::sin(phi)), 0, 0};
  for (int step = 0; step < 5000; ++step) point.update();
  const auto &s = point.stress[0];
  EXPECT_NEAR((s[0] - s[1]) + (s[0] + s[1]) * std::sin(phi), 2 * c * std::cos(phi), 1e-6 * std::abs(s[1]));
}

}  // namespace
}  // namespace talus
