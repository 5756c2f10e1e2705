/// The consistent tangent of every law, against differences of the update itself.
#include <gtest/gtest.h>

#include "examples.h"

namespace talus {
namespace {

template <int dim>
using Tangent = Eigen::Matrix<double, stress_size<dim>, stress_size<dim>, Eigen::RowMajor>;
template <int dim>
using Column = Eigen::Matrix<double, stress_size<dim>, 1>;

template <int dim>
Column<dim> column(const Components<dim> &c) {
  return Eigen::Map<const Column<dim>>(c.data());
}

/// Tangents of all points; the points are updated.
template <int dim>
std::vector<Tangent<dim>> tangents(Points<dim> &points) {
  std::vector<Tangent<dim>> all(points.stress.size());
  update_stress_with_tangent<dim>(points.law, points.view(), all[0].data());
  return all;
}

/// | s(e + h d) - s(e) - h T d | of all points, over scale.
template <int dim>
std::vector<double> remainders(const Points<dim> &from, const std::vector<Components<dim>> &direction, double h) {
  Points<dim> base = from, moved = from;
  const auto tangent = tangents(base);
  const std::size_t n = from.stress.size();
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < stress_size<dim>; ++k) moved.increment[i].strain[k] += h * direction[i][k];
  moved.update();
  std::vector<double> all(n);
  for (std::size_t i = 0; i < n; ++i)
    all[i] = (column<dim>(moved.stress[i]) - column<dim>(base.stress[i]) - h * tangent[i] * column<dim>(direction[i]))
                 .norm() / scale;
  return all;
}

/// Share of points whose remainder does not fall with the square of the step.
template <int dim>
double first_order(const Points<dim> &points, Random &random) {
  std::vector<Components<dim>> direction(points.stress.size());
  for (auto &d : direction) d = random.symmetric<dim>(1);
  const auto large = remainders(points, direction, 1e-6), small = remainders(points, direction, 1e-7);
  int count = 0;
  for (std::size_t i = 0; i < large.size(); ++i) count += !(small[i] < large[i] / 50) && !(small[i] < 1e-11);
  return static_cast<double>(count) / static_cast<double>(large.size());
}

template <class OneLaw>
class TangentOf : public ::testing::Test {};
TYPED_TEST_SUITE(TangentOf, TypesOf<Law>::type);

/// From admissible stress, with strains of 1e-4 to 10 %, turned as well. A share of the points has a kink of the law
/// between e and e + h d: with h = 1e-6 some in a thousand.
TYPED_TEST(TangentOf, leaves_a_remainder_of_second_order) {
  for_all<TypeParam>([]<int dim>(Dim<dim>, const Law &law) {
    Random random;
    Points<dim> points(law, 2000, 0.7);
    for (std::size_t i = 0; i < points.stress.size(); ++i) {
      points.stress[i] = random.symmetric<dim>(scale);
      for (int k = 0; k < 3; ++k) points.stress[i][k] -= scale;
    }
    points.admit();
    for (std::size_t i = 0; i < points.stress.size(); ++i) {
      points.increment[i].strain = random.symmetric<dim>(std::pow(10, random.between(-4, -1)));
      points.turn(i, random.rotation<dim>());
    }
    EXPECT_LT(first_order(points, random), 0.01);
  });
}

/// Trial stresses with two or three equal principal values, and values 1e-4 to 1e-14 apart; three equal ones are in
/// compression: at a spherical trial beyond its apex a softening law has a kink, since it softens with a norm of strain.
/// Spherical stress of any sign is a kink of soil without strength, a few in a hundred of the points here. A spherical
/// strain keeps equal values equal and leads away from the kink that Cam-clay has where torn soil, or soil beyond its
/// p_c, keeps its volume.
TYPED_TEST(TangentOf, bears_equal_and_nearly_equal_principal_stresses) {
  for_all<TypeParam>([]<int dim>(Dim<dim>, const Law &law) {
    Random random;
    Points<dim> points(law, 2000, 0.7);
    for (std::size_t i = 0; i < points.stress.size(); ++i) {
      const double q = i % 3 ? random.between(-2, 2) * scale : 0, p = random.between(-2, i % 3 ? 1 : -0.1) * scale;
      const double apart = i % 2 ? scale * std::pow(10, random.between(-14, -4)) : 0;
      const Matrix Q = random.rotation<dim>();
      const Eigen::Vector3d s(p + apart, i % 5 ? p : p - q, i % 5 ? p - q : p);
      points.stress[i] = components<dim>(Q * s.asDiagonal() * Q.transpose());
      points.increment[i].strain = components<dim>(random.between(-1e-4, 1e-4) * Matrix::Identity());
    }
    EXPECT_LT(first_order(points, random), 0.04);
  });
}

TYPED_TEST(TangentOf, comes_with_the_same_update) {
  for_all<TypeParam>([]<int dim>(Dim<dim>, const Law &law) {
    Random random;
    Points<dim> points(law, 100);
    for (std::size_t i = 0; i < points.stress.size(); ++i) {
      points.stress[i] = random.symmetric<dim>(scale), points.increment[i].strain = random.symmetric<dim>(0.01);
      points.turn(i, random.rotation<dim>());
    }
    Points<dim> with = points;
    points.update(), tangents(with);
    EXPECT_EQ(points.stress, with.stress);
    EXPECT_EQ(points.history, with.history);
  });
}

/// Asymmetry of a tangent by engineering strains (shear columns halved), over its size.
template <int dim>
double asymmetry(Tangent<dim> tangent) {
  for (int k = 3; k < stress_size<dim>; ++k) tangent.col(k) /= 2;
  return (tangent - tangent.transpose()).norm() / tangent.norm();
}

template <int dim>
double worst_asymmetry(const Law &law) {
  Random random;
  Points<dim> points(law, 2000);
  for (auto &s : points.stress) s = random.symmetric<dim>(scale), s[0] -= scale, s[1] -= scale, s[2] -= scale;
  double worst = 0;
  for (const auto &tangent : tangents(points))
    if (tangent.norm() > 1) worst = std::max(worst, asymmetry<dim>(tangent));  // that of an apex is 0
  return worst;
}

TEST(Tangent, is_symmetric_where_flow_is_associated) {
  DruckerPrager cone;
  cone.young_modulus = 20e6, cone.poisson_ratio = 0.3, cone.cohesion = 5e3;
  cone.friction_angle = cone.dilation_angle = 30 * degree.si;
  MohrCoulomb cut = mohr_coulomb(10e3, 30, 30);
  cut.tension_cutoff = 2e3;
  for (const Law &law : {Law(cone), Law(cut), Law(mohr_coulomb(10e3, 30, 30)), Law(mohr_coulomb(10e3, 0, 0))}) {
    EXPECT_LT(worst_asymmetry<2>(law), 1e-12);
    EXPECT_LT(worst_asymmetry<3>(law), 1e-12);
  }
  EXPECT_GT(worst_asymmetry<3>(mohr_coulomb(10e3, 30, 0)), 0.01);
}

TEST(Tangent, is_elastic_inside_and_nothing_at_the_apex) {
  Points<3> points(mohr_coulomb(10e3, 30), 2);
  points.stress[0] = {-1e5, -1e5, -1e5, 0, 0, 0};
  points.stress[1] = {1e6, 1e6, 1e6, 0, 0, 0};
  const auto tangent = tangents(points);
  const double G = shear_modulus(points.law), K = bulk_modulus(points.law);
  Tangent<3> elastic = 2 * G * Tangent<3>::Identity();
  elastic.topLeftCorner<3, 3>().array() += K - 2 * G / 3;
  EXPECT_LT((tangent[0] - elastic).norm(), 1e-14 * elastic.norm());
  EXPECT_EQ(tangent[1].norm(), 0);
}

}  // namespace
}  // namespace talus
