/// The consistent tangent of every law, against differences of the update itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

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
                 .norm() /
             scale;
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

bool without_strength(const Law &law) {
  const FrictionalStrength *strength = frictional_strength(law);
  return strength ? strength->cohesion == 0 : comes_apart(law);
}

template <class OneLaw>
class TangentOf : public ::testing::Test {};
TYPED_TEST_SUITE(TangentOf, TypesOf<Laws>::type);

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
/// compression: at a spherical trial beyond its apex a softening law has a kink, since it softens with a norm of
/// strain. Spherical stress of any sign is a kink of soil without strength, whose values are therefore always apart. A
/// spherical strain keeps equal values equal and leads away from the kink that Cam-clay has where torn soil, or soil
/// beyond its p_c, keeps its volume.
TYPED_TEST(TangentOf, bears_equal_and_nearly_equal_principal_stresses) {
  for_all<TypeParam>([]<int dim>(Dim<dim>, const Law &law) {
    Random random;
    Points<dim> points(law, 2000, 0.7);
    for (std::size_t i = 0; i < points.stress.size(); ++i) {
      const double q = i % 3 ? random.between(-2, 2) * scale : 0, p = random.between(-2, i % 3 ? 1 : -0.1) * scale;
      const bool kink = i % 3 == 0 && without_strength(law);
      const double apart = i % 2 || kink ? scale * std::pow(10, random.between(-14, -4)) : 0;
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
  for (const Law &law : {Law(cone), Law(cut), Law(mohr_coulomb(10e3, 30, 30)), Law(mohr_coulomb(10e3, 0, 0)),
                         Law(examples<HoekBrown>()[1]), Law(examples<HoekBrown>()[4])}) {
    EXPECT_LT(worst_asymmetry<2>(law), 1e-12);
    EXPECT_LT(worst_asymmetry<3>(law), 1e-12);
  }
  EXPECT_GT(worst_asymmetry<3>(mohr_coulomb(10e3, 30, 0)), 0.01);
}

/// Newton's and Bingham's fluids flow along their deviator: potential flow too.
TEST(Tangent, of_fluids_is_symmetric) {
  for (const Law &law : {Law(examples<Newtonian>()[1]), Law(examples<Bingham>()[0])}) {
    EXPECT_LT(worst_asymmetry<2>(law), 1e-12);
    EXPECT_LT(worst_asymmetry<3>(law), 1e-12);
  }
}

/// Hyperelasticity has a potential: the derivative of the Kirchhoff stress by the strain is symmetric, at no strain
/// that is J d sigma + tau (x) I. At a finite strain ln U is not conjugate to the turned stress, and symmetry is lost.
/// Flow as well, if it is associated, here at a strain of 1e-9 beyond the cone.
TEST(Tangent, of_hencky_is_symmetric_for_the_kirchhoff_stress) {
  HenckyDruckerPrager cone = examples<HenckyDruckerPrager>()[0];
  cone.cohesion = 5e3, cone.dilation_angle = cone.friction_angle;
  for (const Law &law : {Law(examples<HenckyElastic>()[0]), Law(cone)}) {
    Random random;
    const int n = 500, memory = history_size(law);
    Points<3> points(law, n);
    for (int i = 0; i < n; ++i) {
      points.stress[i] = random.symmetric<3>(scale);
      for (int k = 0; k < 3; ++k) points.stress[i][k] -= scale;
      points.history[i * memory + memory - 1] = random.between(-0.1, 0.1);  // ln J
    }
    points.admit();
    for (auto &increment : points.increment) increment.strain = random.symmetric<3>(1e-9);
    const auto tangent = tangents(points);
    double worst = 0;
    int plastic = 0;
    for (int i = 0; i < n; ++i) {
      const double J = std::exp(points.history[i * memory + memory - 1]);
      Tangent<3> of_tau = J * tangent[i];
      for (int k = 0; k < 6; ++k)
        for (int j = 0; j < 3; ++j) of_tau(k, j) += J * points.stress[i][k];
      worst = std::max(worst, asymmetry<3>(of_tau));
      plastic += memory > 1 && points.history[i * memory] > 0;
    }
    EXPECT_LT(worst, 1e-7);
    if (memory > 1) {
      EXPECT_GT(plastic, n / 10);
    }
  }
}

/// Cam-clay's elasticity has no potential (its G follows p), so its tangent is symmetric only where no deviator is.
TEST(Tangent, of_cam_clay_is_symmetric_where_pressure_is_isotropic) {
  Points<3> points(examples<CamClay>()[0], 2);
  for (int k = 0; k < 3; ++k) points.stress[0][k] = -50e3, points.stress[1][k] = -100e3;
  for (auto &increment : points.increment) increment.strain = {-1e-3, -1e-3, -1e-3, 0, 0, 0};
  for (const auto &tangent : tangents(points)) EXPECT_LT(asymmetry<3>(tangent), 1e-12);
  points.stress[0] = {-50e3, -60e3, -50e3, 10e3, 0, 0};
  points.increment[0].strain = {-4e-3, 1e-3, -1e-3, 4e-3, 0, 0};
  EXPECT_GT(asymmetry<3>(tangents(points)[0]), 0.01);
}

/// Where on the surface a stress has ended, by its principal stresses.
std::string region(const MohrCoulomb &law, const Matrix &stress, double tension) {
  const auto s = principal(stress);
  const double near = 1e-9 * scale;
  const auto same = [&](double a, double b) { return std::abs(a - b) < near; };
  const double sine = std::sin(law.friction_angle);
  const bool sheared = same((s[0] - s[2]) + (s[0] + s[2]) * sine, 2 * law.cohesion * std::cos(law.friction_angle));
  if (same(s[0], tension)) {
    if (same(s[2], tension)) return "corner";
    if (sheared) return same(s[1], s[0]) || same(s[1], s[2]) ? "end of the cut-off" : "cut-off and face";
    return same(s[1], tension) ? "cut-off line" : "cut-off plane";
  }
  if (!sheared) return "inside";
  return same(s[0], s[1]) ? "edge of compression" : same(s[1], s[2]) ? "edge of extension" : "face";
}

/// On every face, edge, apex, cut-off and intersection the remainder is of second order.
TEST(Tangent, leaves_a_remainder_of_second_order_on_edges_and_apex) {
  MohrCoulomb plain = mohr_coulomb(10e3, 30, 10), cut = plain, tresca = mohr_coulomb(20e3, 0);
  cut.tension_cutoff = 5e3;
  for (const MohrCoulomb &law : {plain, cut, tresca}) {
    const double apex = law.friction_angle > 0 ? law.cohesion / std::tan(law.friction_angle) : 1e300;
    const double tension = law.tension_cutoff >= 0 ? law.tension_cutoff : apex;
    for (const bool hencky : {false, true}) {
      Random random;
      const int n = 20000;
      Points<3> points(hencky ? Law(HenckyMohrCoulomb{{{law}}}) : Law(law), n);
      for (int i = 0; i < n; ++i) {
        const double pressure = random.between(-1, 1) * scale;
        points.stress[i] = {-pressure, -pressure, -pressure, 0, 0, 0};
      }
      points.admit();
      for (int i = 0; i < n; ++i) {
        auto &strain = points.increment[i].strain;
        const double whole = i % 8 ? 1 : 0.05;  // of which a part stays elastic
        strain = random.symmetric<3>(4e-3 * whole);
        const double spread = random.between(-2e-3, 4e-3) * whole;
        for (int k = 0; k < 3; ++k) strain[k] += spread;
      }
      std::vector<Components<3>> direction(n);
      for (auto &d : direction) d = random.symmetric<3>(1);
      const auto large = remainders(points, direction, 1e-6), small = remainders(points, direction, 1e-7);
      points.update();
      std::map<std::string, std::pair<int, int>> count;  // all, and those of first order
      const int memory = history_size(points.law);
      for (int i = 0; i < n; ++i) {
        const double J = hencky ? std::exp(points.history[i * memory + memory - 1]) : 1;
        auto &[all, first] = count[region(law, J * matrix<3>(points.stress[i]), tension)];
        ++all, first += !(small[i] < large[i] / 50) && !(small[i] < 1e-11);
      }
      std::vector<std::string> wanted{"inside", "face", "edge of compression", "edge of extension"};
      if (law.friction_angle > 0) wanted.push_back("corner");
      if (law.tension_cutoff >= 0) wanted.insert(wanted.end(), {"cut-off plane", "cut-off line", "cut-off and face"});
      for (const std::string &where : wanted) EXPECT_GT(count[where].first, 50) << where << (hencky ? ", Hencky" : "");
      for (const auto &[where, counted] : count)
        EXPECT_LE(counted.second, 2 + 0.02 * counted.first)
            << where << (hencky ? ", Hencky" : "") << " of " << counted.first;
    }
  }
}

TEST(Tangent, leaves_a_remainder_of_second_order_on_cone_and_apex) {
  for (const Cone kind : {Cone::outer, Cone::inner, Cone::compromise, Cone::plane_strain}) {
    DruckerPrager law = examples<DruckerPrager>()[1];
    law.cone = kind, law.cohesion = 10e3;
    law.prepare();
    Random random;
    const int n = 4000;
    Points<3> points(law, n);
    for (auto &s : points.stress) {
      s = random.symmetric<3>(scale);
      const double tension = random.between(-2, 3) * scale;
      for (int k = 0; k < 3; ++k) s[k] += tension;
    }
    std::vector<Components<3>> direction(n);
    for (auto &d : direction) d = random.symmetric<3>(1);
    const auto large = remainders(points, direction, 1e-6), small = remainders(points, direction, 1e-7);
    points.update();
    const double apex = law.strength(0., {1}).apex;
    std::array<int, 2> all{}, first{};
    for (int i = 0; i < n; ++i) {
      if (points.history[2 * i] == 0) continue;
      const bool torn = (matrix<3>(points.stress[i]) - apex * Matrix::Identity()).norm() < 1e-9 * scale;
      ++all[torn], first[torn] += !(small[i] < large[i] / 50) && !(small[i] < 1e-11);
    }
    for (const bool torn : {false, true}) {
      EXPECT_GT(all[torn], 100);
      EXPECT_LE(first[torn], 2 + all[torn] / 100);
    }
  }
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
