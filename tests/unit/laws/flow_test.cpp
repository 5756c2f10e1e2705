/// The fluids and mu(I): rates of flow.
#include <gtest/gtest.h>

#include "examples.h"

namespace talus {
namespace {

constexpr double step = 1e-3;  // [s], of the fixture

/// One point in simple shear at a rate [1/s], under pressure, for so many steps: {shear stress, mean stress}.
std::array<double, 2> sheared(const Law &law, double rate, double pressure, int steps) {
  Points<2> point(law, 1);
  point.stress[0] = {-pressure, -pressure, -pressure, 0};
  point.increment[0].strain = {0, 0, 0, rate * step / 2};
  for (int k = 0; k < steps; ++k) point.update();
  const auto &s = point.stress[0];
  return {s[3], (s[0] + s[1] + s[2]) / 3};
}

/// tau = mu gamma_dot, after some mu / G.
TEST(Newtonian, shears_at_its_viscosity) {
  for (const Newtonian &law : examples<Newtonian>())
    for (const double rate : {1e-3, 1., 20.})
      EXPECT_NEAR(sheared(law, rate, 1e3, 400)[0], law.viscosity * rate, 1e-10 * law.viscosity * rate + 1e-14);
}

TEST(Newtonian, has_the_pressure_of_its_volume_and_no_tension) {
  Newtonian law = examples<Newtonian>()[1];
  Points<3> point(law, 1);
  point.increment[0].strain = {-0.01, -0.02, -0.03, 0, 0, 0};
  for (int k = 0; k < 100; ++k) point.update();
  EXPECT_NEAR(matrix<3>(point.stress[0]).trace() / 3, -law.bulk_modulus() * 6, 1e-9 * law.bulk_modulus());
  point.increment[0].strain = {1, 1, 5, 0, 0, 0};
  point.update();
  EXPECT_NEAR(matrix<3>(point.stress[0]).trace(), 0, 1e-9);
}

/// tau = tau_y + mu gamma_dot without regularisation, at any rate; below the yield stress it rests, elastic.
TEST(Bingham, shears_above_its_yield_stress_and_rests_below) {
  const Bingham law = examples<Bingham>()[0];
  for (const double rate : {1e-3, 1., 20.})
    EXPECT_NEAR(sheared(law, rate, 1e4, 60000)[0], law.yield_stress + law.viscosity * rate, 1e-9 * law.yield_stress);
  const double small = 0.9 * law.yield_stress / (shear_modulus(law) * step);
  EXPECT_NEAR(sheared(law, small, 1e4, 1)[0], 0.9 * law.yield_stress, 1e-10);
  Points<2> still(law, 1);
  still.stress[0] = {-1e3, -1e3, -1e3, 0.9 * law.yield_stress};
  const auto before = still.stress;
  for (int k = 0; k < 100; ++k) still.update();
  EXPECT_EQ(still.stress, before);
}

/// Three dimensions: s = (2 mu + tau_y / sqrt(D:D/2)) D.
TEST(Bingham, flows_along_the_rate_of_deformation) {
  const Bingham law = examples<Bingham>()[0];
  Random random;
  Points<3> points(law, 100);
  for (auto &increment : points.increment) {
    increment.strain = random.symmetric<3>(1e-2);
    const double third = (increment.strain[0] + increment.strain[1] + increment.strain[2]) / 3;
    for (int k = 0; k < 3; ++k) increment.strain[k] -= third;
  }
  for (auto &s : points.stress) s = {-1e5, -1e5, -1e5, 0, 0, 0};
  for (int k = 0; k < 2000; ++k) points.update();
  for (int i = 0; i < 100; ++i) {
    const Matrix rate = matrix<3>(points.increment[i].strain) / step, s = matrix<3>(points.stress[i]);
    const Matrix expected = (2 * law.viscosity + law.yield_stress / (rate.norm() / std::sqrt(2.))) * rate;
    EXPECT_LT((s + 1e5 * Matrix::Identity() - expected).norm(), 1e-9 * expected.norm());
  }
}

/// tau / p = mu_s + (mu_2 - mu_s) / (1 + I_0 / I), I = gamma_dot d sqrt(rho_s / p), from creep to fast flow.
TEST(MuI, shears_at_the_friction_of_its_inertial_number) {
  const MuI law = examples<MuI>()[0];
  for (const double pressure : {1e2, 1e4})
    for (const double rate : {1e-3, 1., 100., 1e4}) {
      const double I = rate * law.grain_size * std::sqrt(law.solid_density / pressure);
      const auto [tau, mean] = sheared(law, rate, pressure, rate < 1 ? 2000 : 200);
      EXPECT_NEAR(mean, -pressure, 1e-9 * pressure);
      EXPECT_NEAR(tau / pressure, 0.38 + 0.26 / (1 + 0.3 / I), 1e-9);
    }
}

TEST(MuI, rests_below_its_static_friction_and_bears_no_tension) {
  const MuI law = examples<MuI>()[0];
  Points<2> points(law, 2);
  points.stress[0] = {-1e4, -1e4, -1e4, 3.7e3};
  points.stress[1] = {1e4, 1e4, 1e4, 3e3};
  const auto before = points.stress;
  for (auto &increment : points.increment) increment.strain = {};
  points.update();
  EXPECT_LT((matrix<2>(points.stress[0]) - matrix<2>(before[0])).norm(), 1e-9);
  EXPECT_EQ(matrix<2>(points.stress[1]).norm(), 0);
}

}  // namespace
}  // namespace talus
