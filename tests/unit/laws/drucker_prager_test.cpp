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
double excess(const DruckerPrager &law, const Matrix &s, double plastic_strain = 0) {
  const double p = s.trace() / 3;
  const auto m = law.strength(plastic_strain, {1});
  return (s - p * Matrix::Identity()).norm() / std::sqrt(2.) + m.eta * p - m.limit;
}

template <class D>
class DruckerPragerIn : public ::testing::Test {};
TYPED_TEST_SUITE(DruckerPragerIn, Dims);

/// Past the apex no stress but the apex itself is left. random_states_test.cpp has the million.
TYPED_TEST(DruckerPragerIn, returns_onto_its_cone) {
  constexpr int dim = TypeParam::value, n = 1000;
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
  const auto [eta, eta_bar, limit, apex] = law.strength(0., {1});
  for (int i = 0; i < 2000; ++i) {
    Points<3> point(law, 1);
    point.stress[0] = random.symmetric<3>(3e4);
    const Matrix before = matrix<3>(point.stress[0]);
    point.admit();
    const Matrix drop = before - matrix<3>(point.stress[0]);
    if (drop.norm() == 0) continue;
    const double p = before.trace() / 3, q = (before - p * Matrix::Identity()).norm() / std::sqrt(2.);
    const double slip = excess(law, before) / (law.shear_modulus() + law.bulk_modulus() * eta * eta_bar);
    if (q > law.shear_modulus() * slip) {
      const Matrix flow = (before - p * Matrix::Identity()) / (2 * q) + eta_bar / 3 * Matrix::Identity();
      EXPECT_LT((elastic_strain(law, drop) - slip * flow).norm(), 1e-13 * slip);
      EXPECT_NEAR(point.history[1], slip * eta_bar, 1e-13);
    } else {
      EXPECT_LT((matrix<3>(point.stress[0]) - apex * Matrix::Identity()).norm(), 1e-9);
      EXPECT_EQ(point.history[1], 0) << "what opens is no dilation";
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
  const auto eta = [](const DruckerPrager &law) { return law.strength(0., {1}).eta; };
  EXPECT_NEAR(eta(middle),
              (eta(drucker_prager(c, 33, 0, Cone::outer)) + eta(drucker_prager(c, 33, 0, Cone::inner))) / 2, 1e-15);
  EXPECT_NEAR(eta(middle), 18 * sine / (std::sqrt(3.) * (9 - sine * sine)), 1e-15);
  EXPECT_NEAR(eta(drucker_prager(c, 33, 0, Cone::plane_strain)),
              3 * std::tan(phi) / std::sqrt(9 + 12 * std::tan(phi) * std::tan(phi)), 1e-15);
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

/// With associated flow the return is the point of the cone that is nearest in elastic energy, found here by trying:
/// over its mean stress and the direction of its deviator in principal space.
TEST(DruckerPrager, with_associated_flow_returns_to_the_closest_point) {
  using Triple = Eigen::Vector3d;
  Random random;
  const Triple across = Triple(1, -1, 0) / std::sqrt(2.), along = Triple(1, 1, -2) / std::sqrt(6.);
  double worst = 0;
  int at_apex = 0;
  for (int number = 0; number < 400; ++number) {
    const double phi = random.between(5, 45);
    const DruckerPrager law = drucker_prager(random.between(1e3, 1e4), phi, phi, static_cast<Cone>(number % 4));
    const auto m = law.strength(0., {1});
    const Triple s(random.between(-3e4, 3e4), random.between(-3e4, 3e4), random.between(-3e4, 3e4));
    if (excess(law, s.asDiagonal()) <= 0) continue;
    const auto on_cone = [&](double p, double angle) {  // sqrt(J2) is norm / sqrt(2)
      return Triple(p * Triple::Ones() +
                    std::sqrt(2.) * (m.limit - m.eta * p) * (std::cos(angle) * across + std::sin(angle) * along));
    };
    const auto energy = [&](double p, double angle) {
      const Matrix gap = (on_cone(p, angle) - s).asDiagonal();
      return gap.cwiseProduct(elastic_strain(law, gap)).sum();
    };
    const auto least = [](double low, double high, auto f) {  // golden section
      const double golden = (std::sqrt(5.) - 1) / 2;
      for (int k = 0; k < 60; ++k) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        f(a) < f(b) ? high = b : low = a;
      }
      return (low + high) / 2;
    };
    double best_angle = 0;
    for (int k = 0; k < 36; ++k)
      if (energy(m.apex - 1e4, k * M_PI / 18) < energy(m.apex - 1e4, best_angle)) best_angle = k * M_PI / 18;
    const double angle =
        least(best_angle - M_PI / 18, best_angle + M_PI / 18, [&](double a) { return energy(m.apex - 1e4, a); });
    const double p = least(-3e5, m.apex, [&](double x) { return energy(x, angle); });
    Points<3> point(law, 1);
    point.stress[0] = {s[0], s[1], s[2], 0, 0, 0};
    point.admit();
    const Triple end(point.stress[0][0], point.stress[0][1], point.stress[0][2]);
    at_apex += m.apex - p < 1;
    worst = std::max(worst, (end - on_cone(p, angle)).norm() / s.norm());
  }
  EXPECT_LT(worst, 1e-6);  // the root of round-off is what a search for a minimum sees
  EXPECT_GT(at_apex, 10);
}

/// Alonso et al. (2015), eqs. (18), (19), in each cone: the surface is that of c and phi of the plastic strain.
TEST(DruckerPrager, softens_in_every_cone) {
  for (const Cone cone : {Cone::outer, Cone::inner, Cone::compromise, Cone::plane_strain}) {
    DruckerPrager law = drucker_prager(30e3, 28, 10, cone);
    law.residual_cohesion = 4e3, law.residual_friction_angle = 15 * degree.si, law.residual_dilation_angle = 0,
    law.shape_factor = 40;
    law.prepare();
    Points<3> point(law, 1);
    point.stress[0] = {-1e5, -1e5, -1e5, 0, 0, 0};
    point.increment[0].strain = {0, 0, 0, 1e-6, 0, 0};
    for (int step = 0; step < 20000; ++step) point.update();
    const double left = std::exp(-40 * point.history[0]);
    EXPECT_GT(left, 0.1);
    EXPECT_LT(left, 0.7);
    const DruckerPrager now = drucker_prager(4e3 + 26e3 * left, 15 + 13 * left, 0, cone);
    EXPECT_NEAR(excess(now, matrix<3>(point.stress[0])), 0, 1e-5 * law.cohesion);
    EXPECT_NEAR(
        law.strength(point.history[0], {1}).eta_bar,
        drucker_prager(0, 60, std::asin(left * std::sin(10 * degree.si)) / degree.si, cone).strength(0., {1}).eta_bar,
        1e-12);
    point.increment[0].strain = {0, 0, 0, 0.01, 0, 0};
    for (int step = 0; step < 200; ++step) point.update();
    EXPECT_NEAR(excess(drucker_prager(4e3, 15, 0, cone), matrix<3>(point.stress[0])), 0, 1e-6);
  }
}

/// eta h / h_ref, as in Mohr-Coulomb.
TEST(DruckerPrager, scales_softening_with_element_size) {
  DruckerPrager law = drucker_prager(30e3, 28, 0), twice = law;
  law.residual_cohesion = twice.residual_cohesion = 4e3, law.shape_factor = 40, twice.shape_factor = 80;
  DruckerPrager scaled = law;
  scaled.reference_size = 0.5;
  const auto sheared = [](const DruckerPrager &soil, double size) {
    Points<2> point(soil, 1, size);
    point.stress[0] = {-1e5, -1e5, -1e5, 0};
    point.increment[0].strain = {0, 0, 0, 1e-3};
    for (int step = 0; step < 50; ++step) point.update();
    return point.stress[0];
  };
  EXPECT_EQ(sheared(scaled, 0.5), sheared(law, 1));
  EXPECT_EQ(sheared(scaled, 1), sheared(twice, 1));
}

}  // namespace
}  // namespace talus
