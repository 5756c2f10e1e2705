#include <gtest/gtest.h>

#include "examples.h"
#include "tests/unit/exponential.h"

namespace talus {
namespace {

template <int dim>
Strain<dim> tensor(const Components<dim> &c) {
  if constexpr (dim == 2)
    return {c[0], c[1], c[2], c[3]};
  else
    return {c[0], c[1], c[2], c[3], c[4], c[5]};
}
template <int dim>
Matrix matrix(const Strain<dim> &e) {
  if constexpr (dim == 2)
    return talus::matrix<2>(Components<2>{e.xx, e.yy, e.zz, e.xy});
  else
    return talus::matrix<3>(Components<3>{e.xx, e.yy, e.zz, e.xy, e.yz, e.xz});
}

template <int dim>
void compare_functions() {
  Random random;
  double worst = 0, worst_log = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto a = random.symmetric<dim>(std::pow(10, random.between(-6, -0.4)));
    const Matrix exact = exponential(talus::matrix<dim>(a));
    const Strain<dim> power = exponential_of<dim, double>(tensor<dim>(a));
    worst = std::max(worst, (matrix<dim>(power) - exact).norm());
    worst_log = std::max(worst_log, (matrix<dim>(logarithm_of<dim, double>(power)) - talus::matrix<dim>(a)).norm());
  }
  EXPECT_LT(worst, 2e-14);
  EXPECT_LT(worst_log, 2e-14);
}

TEST(Hencky, functions_of_tensors_are_exact_to_round_off) { compare_functions<2>(), compare_functions<3>(); }

/// Soil that has come apart and closes again is as stiff and strong as it was: gaps are no part of J.
template <class LawType>
void opens_and_closes() {
  LawType law;
  law.young_modulus = 20e6, law.poisson_ratio = 0.3, law.cohesion = 0, law.friction_angle = 35 * degree.si;
  law.dilation_angle = 5 * degree.si;
  Points<3> closed(law, 1), opened(law, 1);
  const auto strain = [](Points<3> &point, double e) {
    point.increment[0].strain = {e, e, e, 0, 0, 0};
    point.update();
  };
  for (int k = 0; k < 50; ++k) strain(opened, 0.01);
  EXPECT_NEAR(opened.history.back(), 0, 1e-13);
  for (int k = 0; k < 10; ++k) strain(opened, -0.001), strain(closed, -0.001);
  EXPECT_LT(closed.stress[0][0], -4e5);
  for (int s = 0; s < 6; ++s) EXPECT_NEAR(opened.stress[0][s], closed.stress[0][s], 1e-6);
  closed.increment[0].strain = opened.increment[0].strain = {0, 0, 0, 0.02, 0, 0};
  for (int k = 0; k < 5; ++k) closed.update(), opened.update();
  for (int s = 0; s < 6; ++s) EXPECT_NEAR(opened.stress[0][s], closed.stress[0][s], 1e-6);
  EXPECT_GT(opened.history[1], 1e-3) << "dilation";
  const double J = std::exp(opened.history.back()), p = -talus::matrix<3>(opened.stress[0]).trace() / 3;
  EXPECT_NEAR(std::log(J), opened.history[1] - J * p / law.bulk_modulus(), 1e-12);
}
TEST(Hencky, gaps_do_not_soften_the_soil) {
  opens_and_closes<HenckyMohrCoulomb>();
  opens_and_closes<HenckyDruckerPrager>();
}

/// A homogeneous deformation in steps: dF_k = F_{k+1} F_k^-1, each decomposed into R and ln U.
class Deformed {
 public:
  explicit Deformed(const Law &law) : point(law, 1) {}
  void go(const Matrix &F) {
    const Matrix dF = F * F_.inverse();
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(dF.transpose() * dF);
    const Matrix axes = eigen.eigenvectors(), stretch = eigen.eigenvalues().cwiseSqrt().asDiagonal();
    const Matrix log_u = axes * eigen.eigenvalues().cwiseSqrt().array().log().matrix().asDiagonal() * axes.transpose();
    point.increment[0].strain = components<3>(log_u);
    point.turn(0, dF * axes * stretch.inverse() * axes.transpose());
    point.update();
    F_ = F;
  }
  Matrix stress() const { return talus::matrix<3>(point.stress[0]); }
  Points<3> point;

 private:
  Matrix F_ = Matrix::Identity();
};

/// On the way and at the end tau = C : 1/2 ln F F^T, whatever the steps.
TEST(Hencky, stress_follows_from_the_deformation_alone) {
  const HenckyElastic law = examples<HenckyElastic>()[0];
  Random random;
  Deformed body(law);
  for (int step = 0; step < 200; ++step) {
    const Matrix F = Matrix::Identity() +
                     0.35 * random.between(0, 1) * Matrix::NullaryExpr([&]() { return random.between(-1, 1) / 2; });
    const Eigen::SelfAdjointEigenSolver<Matrix> b(F * F.transpose());
    const Matrix eps =
        b.eigenvectors() * (b.eigenvalues().array().log() / 2).matrix().asDiagonal() * b.eigenvectors().transpose();
    body.go(F);
    const Matrix tau = 2 * law.shear_modulus() * eps +
                       (law.bulk_modulus() - 2 * law.shear_modulus() / 3) * eps.trace() * Matrix::Identity();
    EXPECT_LT((body.stress() * F.determinant() - tau).norm(), 1e-10 * law.young_modulus);
  }
}

/// Stress left and work spent, over E, by ten closed cycles of extension and shear, 20 % each, in steps of 0.1 %.
std::array<double, 2> cycled(const Law &law) {
  Deformed body(law);
  const int steps = 1600;
  Matrix last = Matrix::Identity();
  double work = 0;
  for (int cycle = 0; cycle < 10; ++cycle)
    for (int k = 1; k <= steps; ++k) {
      const double angle = 2 * M_PI * k / steps;
      Matrix F = Matrix::Identity();
      F(0, 0) += 0.2 * (1 - std::cos(angle)) / 2, F(0, 1) = 0.2 * std::sin(angle);
      const Matrix before = body.stress() * last.determinant();
      body.go(F);
      const Matrix rate = (F - last) * ((F + last) / 2).inverse();
      work += (before + body.stress() * F.determinant()).cwiseProduct(rate).sum() / 2;
      last = F;
    }
  return {body.stress().norm() / 20e6, work / 20e6};
}

/// Nothing is left and nothing spent, but what the quadrature of the work errs by; the hypoelastic update leaves both.
TEST(Hencky, closed_cycles_dissipate_nothing) {
  const auto [stress, work] = cycled(examples<HenckyElastic>()[0]);
  const auto [hypo_stress, hypo_work] = cycled(examples<LinearElastic>()[0]);
  EXPECT_LT(stress, 1e-11);
  EXPECT_LT(std::abs(work), 1e-7);
  EXPECT_GT(hypo_stress, 1e-3);
  RecordProperty("hypoelastic_stress_over_E", std::to_string(hypo_stress));
  RecordProperty("hypoelastic_work_over_E", std::to_string(hypo_work));
  std::printf("hypoelastic: stress %.3e, work %.3e; hencky: stress %.1e, work %.1e (over E)\n", hypo_stress, hypo_work,
              stress, work);
}

/// The yield surface holds for the Kirchhoff stress.
TEST(Hencky, returns_kirchhoff_stress_onto_the_surface) {
  HenckyDruckerPrager law = examples<HenckyDruckerPrager>()[1];
  law.prepare();
  const auto m = law.strength(0., {1});
  Random random;
  const int n = 5000;
  Points<3> points(law, n);
  for (auto &s : points.stress) s = random.symmetric<3>(scale), s[0] -= scale, s[1] -= scale, s[2] -= scale;
  points.admit();
  double worst = 0;
  for (int step = 0; step < 5; ++step) {
    for (auto &increment : points.increment) increment.strain = random.symmetric<3>(0.02);
    points.update();
    for (int i = 0; i < n; ++i) {
      const Matrix tau = std::exp(points.history[3 * i + 2]) * talus::matrix<3>(points.stress[i]);
      const double p = tau.trace() / 3, q = (tau - p * Matrix::Identity()).norm() / std::sqrt(2.);
      worst = std::max(worst, (q + m.eta * p - m.limit) / (tau.norm() + law.cohesion));
    }
  }
  EXPECT_LT(worst, 1e-12);
}

}  // namespace
}  // namespace talus
