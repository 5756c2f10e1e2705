#include <gtest/gtest.h>

#include "examples.h"

namespace talus {
namespace {

CamClay clay(double attraction = 1) {
  CamClay law = examples<CamClay>()[0];
  law.attraction = attraction;
  law.prepare();
  return law;
}

/// p from -attraction, triaxial q, and what history says, of one point of a set.
struct State {
  template <int dim>
  State(const CamClay &law, const Points<dim> &points, int i) {
    const Matrix s = matrix<dim>(points.stress[i]);
    p = law.attraction - s.trace() / 3;
    q = std::sqrt(1.5) * (s - s.trace() / 3 * Matrix::Identity()).norm();
    const double *h = &points.history[4 * i];
    shear = h[0], expansion = h[1], v = (1 + law.void_ratio) * std::exp(h[2]);
    pc = (law.preconsolidation_pressure + law.attraction) * std::exp(h[3]);
  }
  double yield(const CamClay &law) const { return q * q / (law.M * law.M) + p * (p - pc); }
  double boundary(const CamClay &law) const {
    return v + law.swelling_slope * std::log(p) + (law.compression_slope - law.swelling_slope) * std::log(pc);
  }
  double p, q, v, pc, shear, expansion;
};

/// A million steps of 1e-8 to 10 % from random states: the surface v + kappa ln p + (lambda - kappa) ln p_c that all
/// states lie on is kept, what flows ends on the ellipse, along its normal, and forward.
TEST(CamClay, keeps_to_its_state_boundary_ellipse_and_normal) {
  Random random;
  const int n = 20000;
  double drift = 0, off = 0, oblique = 0, backward = 0;
  for (const CamClay &example : examples<CamClay>()) {
    CamClay law = example;
    law.prepare();
    Points<3> points(law, n);
    for (int i = 0; i < n; ++i) {
      points.stress[i] = random.symmetric<3>(5e4);
      for (int k = 0; k < 3; ++k) points.stress[i][k] -= 6e4;
    }
    points.admit();
    for (int step = 0; step < 25; ++step) {
      const Points<3> before = points;
      for (auto &increment : points.increment)
        increment.strain = random.symmetric<3>(std::pow(10, random.between(-8, -1)));
      points.update();
      for (int i = 0; i < n; ++i) {
        const State was(law, before, i), is(law, points, i);
        const double trial = std::log(was.p) - (is.v - was.v) / law.swelling_slope;
        if (trial < law.log_least + 1e-6 || was.p < 1.0001e-3 * law.attraction)
          continue;  // torn: held at the least pressure
        drift = std::max(drift, std::abs(is.boundary(law) - was.boundary(law)));
        off = std::max(off, is.yield(law) / (is.pc * is.pc));
        if (is.shear == was.shear) continue;
        off = std::max(off, std::abs(is.yield(law)) / (is.pc * is.pc));
        const double shear = is.shear - was.shear, squeeze = was.expansion - is.expansion;
        const double along = 2 * is.q / (law.M * law.M), into = 2 * is.p - is.pc, size = std::hypot(along, into);
        oblique =
            std::max(oblique, std::abs(squeeze * along - shear * into) / (size * (std::hypot(shear, squeeze) + 1e-8)));
        backward = std::min(backward, (is.p * squeeze + is.q * shear) / (is.pc * std::hypot(shear, squeeze)));
      }
    }
  }
  EXPECT_LT(drift, 1e-12);
  EXPECT_LT(off, 1e-12);
  EXPECT_LT(oblique, 1e-7);
  EXPECT_GT(backward, -1e-9);
}

/// Isotropic loading and unloading are integrated exactly: lines of slope lambda and kappa in v and ln p, in one step.
TEST(CamClay, swells_and_is_compressed_along_its_lines) {
  const CamClay law = clay();
  Points<3> point(law, 1);
  const double p = 100e3;
  for (int k = 0; k < 3; ++k) point.stress[0][k] = -p;
  const auto squeeze = [&](double volume_strain) {
    for (int k = 0; k < 3; ++k) point.increment[0].strain[k] = volume_strain / 3;
    point.update();
    return State(law, point, 0);
  };
  const double before = std::log(p + law.attraction);
  const State compressed = squeeze(-0.1), swollen = squeeze(0.05);
  EXPECT_NEAR(std::log(compressed.p) - before, (2 - 2 * std::exp(-0.1)) / 0.2, 1e-13);
  EXPECT_NEAR(std::log(compressed.p) - std::log(swollen.p), (2 * std::exp(-0.05) - 2 * std::exp(-0.1)) / 0.04, 1e-13);
  EXPECT_NEAR(compressed.q, 0, 1e-9);
}

/// Undrained triaxial compression of normally consolidated clay: with Lambda = (lambda -
/// kappa) / lambda, p_0 / p = (1 + (eta / M)^2)^Lambda and plastic shear 2 kappa Lambda / (M v) (artanh(eta / M) -
/// arctan(eta / M)), from the flow rule along that path (Muir Wood 1990, sec. 5.4).
TEST(CamClay, follows_its_undrained_path) {
  const CamClay law = clay();
  Points<3> point(law, 1);
  const double p0 = law.preconsolidation_pressure + law.attraction, slope = (0.2 - 0.04) / 0.2;
  for (int k = 0; k < 3; ++k) point.stress[0][k] = -law.preconsolidation_pressure;
  point.increment[0].strain = {0.5e-5, 0.5e-5, -1e-5, 0, 0, 0};
  for (int step = 1; step <= 20000; ++step) {
    point.update();
    if (step % 1000) continue;
    const State s(law, point, 0);
    const double eta = s.q / s.p;
    EXPECT_NEAR(s.p, p0 * std::pow(1 + eta * eta, -slope), 1e-9 * p0);
    if (step <= 8000) {
      EXPECT_NEAR(s.shear, 2 * 0.04 * slope / 2 * (std::atanh(eta) - std::atan(eta)), 2e-3 * s.shear + 1e-6) << step;
    }
  }
  const State end(law, point, 0);
  EXPECT_NEAR(end.q, end.p, 1e-4 * p0);
  EXPECT_NEAR(end.p, p0 * std::pow(2, -slope), 1e-4 * p0);
}

/// The path of effective stress does not depend on the steps: the same in 5 steps of 2 % as in 20000.
TEST(CamClay, bears_large_steps) {
  const CamClay law = clay();
  Points<3> point(law, 1);
  const double p0 = law.preconsolidation_pressure + law.attraction;
  for (int k = 0; k < 3; ++k) point.stress[0][k] = -law.preconsolidation_pressure;
  point.increment[0].strain = {0.01, 0.01, -0.02, 0, 0, 0};
  for (int step = 0; step < 5; ++step) {
    point.update();
    const State s(law, point, 0);
    EXPECT_NEAR(s.p, p0 * std::pow(1 + s.q * s.q / (s.p * s.p), -0.8), 1e-9 * p0);
  }
}

/// Drained compression at constant lateral stress, to a strain of 2, ends at critical state, p = 3 p_0 / (3 - M), on
/// the critical state line v = v_0 + lambda ln p_0 - (lambda - kappa) ln 2 - lambda ln p. Heavily overconsolidated clay
/// peaks above it.
TEST(CamClay, ends_drained_tests_at_critical_state) {
  const CamClay law = clay();
  for (const double p0 : {100e3, 12e3}) {
    Points<3> point(law, 1);
    for (int k = 0; k < 3; ++k) point.stress[0][k] = -p0;
    double peak = 0;
    const State start(law, point, 0);
    for (int step = 0; step < 4000; ++step) {
      const Points<3> accepted = point;
      double lateral = 2.5e-4;
      for (int iteration = 0; iteration < 20; ++iteration) {
        point = accepted;
        point.increment[0].strain = {lateral, lateral, -5e-4, 0, 0, 0};
        std::array<double, 36> tangent;
        update_stress_with_tangent<3>(point.law, point.view(), tangent.data());
        const double miss = point.stress[0][0] + p0;
        if (std::abs(miss) < 1e-6) break;
        lateral -= miss / (tangent[0] + tangent[1]);
      }
      ASSERT_NEAR(point.stress[0][0], -p0, 1e-5);
      peak = std::max(peak, State(law, point, 0).q);
    }
    const State s(law, point, 0);
    const double P0 = p0 + law.attraction, p = 3 * P0 / (3 - law.M);
    EXPECT_NEAR(s.p, p, 2e-3 * p);
    EXPECT_NEAR(s.q, law.M * p, 2e-3 * p);
    EXPECT_NEAR(s.v, start.boundary(law) - 0.16 * std::log(2) - 0.2 * std::log(p), 2e-3);
    if (p0 < 50e3)
      EXPECT_GT(peak, 1.1 * s.q);
    else
      EXPECT_LE(peak, s.q * (1 + 1e-9));
  }
}

}  // namespace
}  // namespace talus
