/// The UMATs of docs/guide/umat at a point, against the laws that they write anew.
#include <gtest/gtest.h>

#include "examples.h"
#include "physics/laws/element_test.h"

namespace talus {
namespace {

#ifdef UMAT_FORTRAN

/// Props of mohr_coulomb.f90.
std::vector<double> props_of(const MohrCoulomb &m, bool tangent = false) {
  return {m.young_modulus,
          m.poisson_ratio,
          m.cohesion,
          m.friction_angle,
          m.dilation_angle,
          m.residual_cohesion < 0 ? m.cohesion : m.residual_cohesion,
          m.residual_friction_angle < 0 ? m.friction_angle : m.residual_friction_angle,
          m.shape_factor,
          tangent ? 1. : 0.};
}

template <int dim>
void expect_the_same(const MohrCoulomb &built_in, const Umat &own) {
  Random random;
  Points<dim> a(built_in, 4000), b(own, 4000);
  for (std::size_t i = 0; i < a.stress.size(); ++i) {
    a.stress[i] = random.symmetric<dim>(scale);
    for (int k = 0; k < 3; ++k) a.stress[i][k] -= scale;
    a.increment[i].strain = random.symmetric<dim>(std::pow(10, random.between(-6, -1.5)));
    const Matrix R = random.rotation<dim>();
    a.turn(i, R), b.turn(i, R);
    b.stress[i] = a.stress[i], b.increment[i].strain = a.increment[i].strain;
    a.history[2 * i] = b.history[2 * i] = random.between(0, 0.01);
  }
  a.update(), b.update();
  double stress = 0, strain = 0;
  for (std::size_t i = 0; i < a.stress.size(); ++i)
    for (int k = 0; k < stress_size<dim>; ++k) stress = std::max(stress, std::abs(a.stress[i][k] - b.stress[i][k]));
  for (std::size_t k = 0; k < a.history.size(); ++k) strain = std::max(strain, std::abs(a.history[k] - b.history[k]));
  EXPECT_LT(stress, 1e-9 * scale);  // 1e-13 of the largest trial stresses, which are of 1 MPa
  EXPECT_LT(strain, 1e-12);
}

TEST(Umat, mohr_coulomb_in_fortran_is_the_built_in_law) {
  MohrCoulomb softening = mohr_coulomb(20e3, 30, 10);
  softening.residual_cohesion = 1e3, softening.residual_friction_angle = 20 * degree.si, softening.shape_factor = 100;
  for (const MohrCoulomb &law : {mohr_coulomb(5e3, 35), mohr_coulomb(15e3, 0), mohr_coulomb(10e3, 25, 25), softening}) {
    const Umat own = umat("mohr_coulomb", props_of(law), {"plastic_strain", "dilation"});
    EXPECT_EQ(own.problem_in(2), "");
    EXPECT_EQ(own.problem_in(3), "");
    expect_the_same<2>(law, own);
    expect_the_same<3>(law, own);
    EXPECT_EQ(own.trouble().text, "");
  }
}

/// DDSDDE by difference quotients of width 1e-7, against the exact derivative.
TEST(Umat, ddsdde_is_the_tangent) {
  const MohrCoulomb law = mohr_coulomb(5e3, 30, 5);
  Random random;
  Points<3> a(law, 200), b(umat("mohr_coulomb", props_of(law, true), {"plastic_strain", "dilation"}), 200);
  for (int i = 0; i < 200; ++i) {
    a.stress[i] = b.stress[i] = {-1e5, -1e5, -1e5, 0, 0, 0};
    a.increment[i].strain = b.increment[i].strain = random.symmetric<3>(0.01);
    const Matrix R = random.rotation<3>();
    a.turn(i, R), b.turn(i, R);
  }
  std::vector<double> exact(200 * 36), own(200 * 36);
  update_stress_with_tangent<3>(a.law, a.view(), exact.data());
  update_stress_with_tangent<3>(b.law, b.view(), own.data());
  int far = 0;
  for (int i = 0; i < 200; ++i) {
    double worst = 0;
    for (int k = 0; k < 36; ++k) worst = std::max(worst, std::abs(exact[36 * i + k] - own[36 * i + k]));
    far += worst > 1e-4 * law.young_modulus;
  }
  EXPECT_LE(far, 4);  // points within 1e-7 of an edge or of yield
}

TEST(Umat, goes_through_the_triaxial_test) {
  const MohrCoulomb law = mohr_coulomb(5e3, 35, 5);
  ElementTest test;
  test.name = "claim", test.cell_pressure = 50e3, test.strain = {0.05};
  const auto built_in = drive(law, test),
             own = drive(umat("mohr_coulomb", props_of(law), {"plastic_strain", "dilation"}), test);
  for (const int k : {50, 100, 200}) EXPECT_NEAR(own[k].deviator(), built_in[k].deviator(), 1e-3);
  EXPECT_NEAR(-own.back().stress[1], 203.7e3, 0.05e3);
}

TEST(Umat, the_template_of_the_guide_compiles_and_is_elastic) {
  const double lambda = 11.5e6, G = 7.7e6;
  Umat law = umat("template", {20e6, 0.3});
  law.props = {lambda, G};
  ASSERT_EQ(law.problem(), "");
  Points<3> points(law, 1);
  points.increment[0].strain = {1e-3, 0, 0, 1e-3, 0, 2e-3};
  points.update();
  const Components<3> expected{(lambda + 2 * G) * 1e-3, lambda * 1e-3, lambda * 1e-3, 2 * G * 1e-3, 0, 2 * G * 2e-3};
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(points.stress[0][k], expected[k], 1e-6);
}

#endif

/// Shear strain arrives as the angle, in the order 12, 13, 23, and turned: work in STATEV(1) is s : e.
TEST(Umat, hands_over_shear_as_the_angle_and_keeps_state) {
  const Umat law = umat("linear_elastic", {20e6, 0.3}, {"work"});
  Random random;
  Points<3> points(law, 500);
  std::vector<double> work(500);
  for (int i = 0; i < 500; ++i) {
    points.stress[i] = random.symmetric<3>(scale), points.increment[i].strain = random.symmetric<3>(1e-3);
    const Matrix e = matrix<3>(points.increment[i].strain), s = matrix<3>(points.stress[i]);
    const double K = bulk_modulus(points.law), G = shear_modulus(points.law);
    const Matrix rise = 2 * G * e + (K - 2 * G / 3) * e.trace() * Matrix::Identity();
    work[i] = ((s + rise / 2).cwiseProduct(e)).sum();
    points.turn(i, random.rotation<3>());
  }
  points.update();
  for (int i = 0; i < 500; ++i) EXPECT_NEAR(points.history[i], work[i], 1e-10 * scale);
}

TEST(Umat, says_what_goes_wrong) {
  const Umat broken = umat("broken", {1, 0});
  EXPECT_EQ(broken.problem_in(2), "");
  EXPECT_NE(umat("broken", {0, 0}).problem_in(3).find("STRESS(2) = nan"), std::string::npos);
  EXPECT_NE(umat("broken", {0, 2}, {"a"}).problem_in(3).find("beyond its 1"), std::string::npos);
}

}  // namespace
}  // namespace talus
