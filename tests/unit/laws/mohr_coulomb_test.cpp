#include <gtest/gtest.h>

#include "fixtures.h"

namespace talus {
namespace {

using Triple = Eigen::Vector3d;  // principal stresses, greatest first

/// Strength at the peak, computed afresh.
struct Surface {
  explicit Surface(const MohrCoulomb &law)
      : sin_phi(std::sin(law.friction_angle)),
        c_cos_phi(law.cohesion * std::cos(law.friction_angle)),
        sin_psi(std::sin(law.dilation_angle)) {
    tension = sin_phi > 0 ? c_cos_phi / sin_phi : 1e300;
    if (law.tension_cutoff >= 0) tension = std::min(tension, law.tension_cutoff);
  }
  double excess(const std::array<double, 3> &s) const {
    return std::max((s[0] - s[2]) + (s[0] + s[2]) * sin_phi - 2 * c_cos_phi, s[0] - tension);
  }
  double sin_phi, c_cos_phi, sin_psi, tension;
};

/// One plane a . s <= limit with its flow direction.
struct Plane {
  Triple normal, flow;
  double limit;
};

/// All planes of the surface, without regard to the order of principal stresses.
std::vector<Plane> planes(const Surface &surface) {
  std::vector<Plane> all;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      Plane plane{Triple::Zero(), Triple::Zero(), 2 * surface.c_cos_phi};
      plane.normal[i] = 1 + surface.sin_phi, plane.normal[j] = -(1 - surface.sin_phi);
      plane.flow[i] = 1 + surface.sin_psi, plane.flow[j] = -(1 - surface.sin_psi);
      all.push_back(plane);
    }
  if (surface.tension < 1e200)
    for (int i = 0; i < 3; ++i) all.push_back({Triple::Unit(i), Triple::Unit(i), surface.tension});
  return all;
}

Eigen::Matrix3d stiffness(const MohrCoulomb &law) {
  const double G = law.shear_modulus(), K = law.bulk_modulus();
  return 2 * G * Eigen::Matrix3d::Identity() + (K - 2 * G / 3) * Eigen::Matrix3d::Ones();
}

/// Calls `use` on each set of up to three planes.
template <class Use>
void for_sets(const std::vector<Plane> &all, Use use) {
  const int n = static_cast<int>(all.size());
  for (int i = 0; i < n; ++i) {
    use(std::vector<Plane>{all[i]});
    for (int j = i + 1; j < n; ++j) {
      use(std::vector<Plane>{all[i], all[j]});
      for (int k = j + 1; k < n; ++k) use(std::vector<Plane>{all[i], all[j], all[k]});
    }
  }
}

/// The point of the surface nearest to s in elastic energy, by trying the intersections of all sets of planes.
Triple closest_point(const Triple &s, const std::vector<Plane> &all, const Eigen::Matrix3d &D, double tolerance) {
  const Eigen::Matrix3d C = D.inverse();
  Triple best = s;
  double least = 1e300;
  const auto consider = [&](const Triple &x) {
    for (const Plane &plane : all)
      if (plane.normal.dot(x) > plane.limit + tolerance) return;
    const double distance = (x - s).dot(C * (x - s));
    if (distance < least) least = distance, best = x;
  };
  consider(s);
  for_sets(all, [&](const std::vector<Plane> &set) {
    const int m = static_cast<int>(set.size());
    Eigen::MatrixXd A(3, m);
    Eigen::VectorXd excess(m);
    for (int k = 0; k < m; ++k) A.col(k) = set[k].normal, excess[k] = set[k].normal.dot(s) - set[k].limit;
    const Eigen::MatrixXd H = A.transpose() * D * A;
    if (H.fullPivLu().rank() < m) return;
    consider(s - D * A * H.fullPivLu().solve(excess));
  });
  return best;
}

MohrCoulomb random_law(Random &random, int number) {
  const double phi = number % 6 == 0 ? 0 : random.between(0, 45);
  MohrCoulomb law = mohr_coulomb(number % 5 == 0 ? 0 : random.between(0, 1e4), phi, random.between(0, phi));
  law.poisson_ratio = random.between(0, 0.49);
  if (number % 3 == 0) law.tension_cutoff = number % 2 ? 0 : random.between(0, 5e3);
  return law;
}

template <class D>
class MohrCoulombIn : public ::testing::Test {};
TYPED_TEST_SUITE(MohrCoulombIn, Dims);

/// Trial states with axes of their own; what was plastic ends on the surface. random_states_test.cpp has the million.
TYPED_TEST(MohrCoulombIn, returns_onto_its_surface) {
  constexpr int dim = TypeParam::value, n = 4000;
  Random random;
  double worst = 0, worst_angle = 0;
  for (int number = 0; number < 50; ++number) {
    const MohrCoulomb law = random_law(random, number);
    const Surface surface(law);
    Points<dim> points(law, n);
    for (auto &s : points.stress) {
      s = random.symmetric<dim>(std::pow(10, random.between(2, 6)));
      const double pressure = random.between(-1, 1) * std::abs(s[0]);
      for (int k = 0; k < 3; ++k) s[k] -= pressure;
    }
    const auto trial = points.stress;
    points.admit();
    for (int i = 0; i < n; ++i) {
      const Matrix before = matrix<dim>(trial[i]), after = matrix<dim>(points.stress[i]);
      const double size = before.norm() + law.cohesion, f = surface.excess(principal(after)) / size;
      const bool elastic = surface.excess(principal(before)) <= 0;
      worst = std::max(worst, elastic ? (after - before).norm() / size : std::abs(f));
      worst_angle = std::max(worst_angle, (after * before - before * after).norm() / (size * size));
    }
  }
  EXPECT_LT(worst, 1e-13);
  EXPECT_LT(worst_angle, 1e-14) << "the axes turned";
}

/// Gaps between principal stresses from 1e-18 to 1 of their size, on all sides of the surface.
TEST(MohrCoulomb, bears_equal_and_nearly_equal_principal_stresses) {
  Random random;
  double worst = 0;
  for (int number = 0; number < 60; ++number) {
    const MohrCoulomb law = random_law(random, number);
    const Surface surface(law);
    const int n = 2000;
    Points<3> points(law, n);
    for (int i = 0; i < n; ++i) {
      const double a = random.between(-3e4, 1e4), gap = 1e4 * std::pow(10, random.between(-18, 0));
      Triple s(a, a + gap, i % 3 == 0 ? random.between(-3e4, 1e4) : i % 3 == 1 ? a : a - gap * random.between(0, 1));
      const Matrix Q = random.rotation<3>();
      points.stress[i] = components<3>(Q * s.asDiagonal() * Q.transpose());
    }
    const auto trial = points.stress;
    points.admit();
    for (int i = 0; i < n; ++i) {
      const double size = matrix<3>(trial[i]).norm() + law.cohesion;
      const bool elastic = surface.excess(principal(matrix<3>(trial[i]))) <= -1e-13 * size;
      const double f = surface.excess(principal(matrix<3>(points.stress[i]))) / size;
      worst =
          std::max(worst, elastic ? (matrix<3>(points.stress[i]) - matrix<3>(trial[i])).norm() / size : std::abs(f));
    }
  }
  EXPECT_LT(worst, 1e-13);
}

TEST(MohrCoulomb, with_associated_flow_returns_to_the_closest_point) {
  Random random;
  double worst = 0;
  for (int number = 0; number < 1000; ++number) {
    MohrCoulomb law = random_law(random, number);
    law.dilation_angle = law.friction_angle;
    Triple s(random.between(-3e4, 3e4), random.between(-3e4, 3e4), random.between(-3e4, 3e4));
    std::sort(s.begin(), s.end(), std::greater<>());
    law.prepare();
    const Principal<> x = law.admissible({s[0], s[1], s[2]}, law.strength(0., {1}));
    const Triple exact = closest_point(s, planes(Surface(law)), stiffness(law), 1e-6);
    worst = std::max(worst, (Triple(x.s1, x.s2, x.s3) - exact).norm() / (s.norm() + law.cohesion));
  }
  EXPECT_LT(worst, 1e-9);
}

/// The nearest to x of all stresses that s could return to: those that some set of up to three planes, each slipping
/// forward along its own flow (Koiter), leaves on these planes and on the good side of all others. By trying all sets.
class Returns {
 public:
  explicit Returns(const MohrCoulomb &law) : planes_(planes(Surface(law))) {
    const Eigen::Matrix3d D = stiffness(law);
    const int n = static_cast<int>(planes_.size());
    drop_.resize(n);
    rise_.assign(n, std::vector<double>(n));
    for (int k = 0; k < n; ++k) drop_[k] = D * planes_[k].flow;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) rise_[i][k] = planes_[i].normal.dot(drop_[k]) / D(0, 0);
    stiffness_ = D(0, 0);
    for (auto &drop : drop_) drop /= stiffness_;
  }

  double distance(const Triple &s, const Triple &x, double tolerance) const {
    const int n = static_cast<int>(planes_.size());
    double excess[9], least = 1e300;
    bool inside = true;
    for (int i = 0; i < n; ++i)
      excess[i] = planes_[i].normal.dot(s) - planes_[i].limit, inside &= excess[i] <= tolerance;
    if (inside) least = (x - s).norm();
    const auto consider = [&](int i, int j, int k, double a, double b, double c) {
      if (!(std::min({a, b, c}) > -tolerance)) return;  // of slips times stiffness
      Triple y = s - a * drop_[i];
      if (j >= 0) y -= b * drop_[j];
      if (k >= 0) y -= c * drop_[k];
      for (const Plane &plane : planes_)
        if (plane.normal.dot(y) > plane.limit + tolerance) return;
      least = std::min(least, (x - y).norm());
    };
    for (int i = 0; i < n; ++i) {
      consider(i, -1, -1, excess[i] / rise_[i][i], 0, 0);
      for (int j = i + 1; j < n; ++j) {
        const double det = rise_[i][i] * rise_[j][j] - rise_[i][j] * rise_[j][i];
        if (std::abs(det) > 1e-9)
          consider(i, j, -1, (excess[i] * rise_[j][j] - excess[j] * rise_[i][j]) / det,
                   (excess[j] * rise_[i][i] - excess[i] * rise_[j][i]) / det, 0);
        for (int k = j + 1; k < n; ++k) {
          Eigen::Matrix3d H;
          const int set[3] = {i, j, k};
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) H(r, c) = rise_[set[r]][set[c]];
          if (std::abs(H.determinant()) < 1e-9) continue;
          const Triple slip = H.inverse() * Triple(excess[i], excess[j], excess[k]);
          consider(i, j, k, slip[0], slip[1], slip[2]);
        }
      }
    }
    return least;
  }

 private:
  std::vector<Plane> planes_;
  std::vector<Triple> drop_;               ///< stress that a unit slip takes off, over D(0, 0)
  std::vector<std::vector<double>> rise_;  ///< of excess on plane i by slip on plane k, over D(0, 0)
  double stiffness_ = 1;
};

/// 200,000 states: face, edges, apex, cut-off and intersections are the right ones with any dilation. A million would
/// take five times as long, some 3 s, and show no more.
TEST(MohrCoulomb, with_any_dilation_returns_where_brute_force_does) {
  Random random;
  double worst = 0;
  for (int number = 0; number < 200; ++number) {
    MohrCoulomb law = random_law(random, number);
    law.prepare();
    const auto strength = law.strength(0., {1});
    const Returns returns(law);
    for (int i = 0; i < 1000; ++i) {
      Triple s(random.between(-3e4, 3e4), random.between(-3e4, 3e4), random.between(-3e4, 3e4));
      std::sort(s.begin(), s.end(), std::greater<>());
      const Principal<> x = law.admissible({s[0], s[1], s[2]}, strength);
      const double distance = returns.distance(s, Triple(x.s1, x.s2, x.s3), 1e-5);
      if (distance > worst) worst = distance;
      ASSERT_LT(distance, 1e-3) << number << ": from " << s.transpose() << " to " << x.s1 << " " << x.s2 << " " << x.s3
                                << ", phi " << law.friction_angle << ", psi " << law.dilation_angle << ", c "
                                << law.cohesion << ", T " << law.tension_cutoff << ", nu " << law.poisson_ratio;
    }
  }
  EXPECT_LT(worst, 1e-4);  // [Pa], of 3e4; a set that is nearly dependent costs the brute force digits
}

/// sigma_1 of a drained triaxial test at sigma_3 = 50 kPa: the axis shortens, the lateral strain keeps the lateral
/// stress.
double triaxial_strength(const Law &law) {
  const double lateral_stress = -50e3;
  Points<3> point(law, 1);
  point.stress[0] = {lateral_stress, lateral_stress, lateral_stress, 0, 0, 0};
  for (int step = 0; step < 40; ++step) {
    const auto accepted = point.stress[0];
    const auto history = point.history;
    const auto miss = [&](double lateral) {
      point.stress[0] = accepted, point.history = history;
      point.increment[0].strain = {lateral, lateral, -1e-3, 0, 0, 0};
      point.update();
      return point.stress[0][0] - lateral_stress;
    };
    double a = 0, b = 1e-3, at_a = miss(a), at_b = miss(b);
    for (int iteration = 0; iteration < 50 && std::abs(at_b) > 1e-9 && a != b; ++iteration) {
      const double c = b - at_b * (b - a) / (at_b - at_a);
      a = b, at_a = at_b, b = c, at_b = miss(c);
    }
    EXPECT_LT(std::abs(at_b), 1e-6);
  }
  return -point.stress[0][2];
}

/// sigma_1 = sigma_3 N + 2 c sqrt(N), N = tan^2(45 deg + phi / 2).
TEST(MohrCoulomb, fails_in_triaxial_compression_as_in_the_textbook) {
  struct Case {
    double phi, c, sigma1;  // [deg], [kPa], [kPa] to four digits
  };
  for (const Case &test : {Case{35, 5, 203.7}, Case{47, 3, 337.5}, Case{30, 3, 160.4}, Case{40, 1, 234.2}})
    for (const double psi : {0., test.phi / 2, test.phi}) {
      const double tangent = std::tan(45 * degree.si + test.phi * degree.si / 2);
      const double exact = 50e3 * tangent * tangent + 2e3 * test.c * tangent;
      const double computed = triaxial_strength(mohr_coulomb(test.c * 1e3, test.phi, psi));
      EXPECT_NEAR(computed, exact, 1e-10 * exact);
      EXPECT_NEAR(computed / 1e3, test.sigma1, 0.05);
    }
}

TEST(MohrCoulomb, without_friction_is_tresca) {
  const double c = 25e3;
  EXPECT_NEAR(triaxial_strength(mohr_coulomb(c, 0)), 50e3 + 2 * c, 1e-5);
  Points<2> shear(mohr_coulomb(c, 0), 1);
  shear.stress[0] = {3e5, 3e5, 3e5, 0};  // tension does not weaken it
  shear.increment[0].strain = {0, 0, 0, 0.05};
  shear.update();
  EXPECT_NEAR(shear.stress[0][3], c, 1e-9);
  EXPECT_NEAR(shear.stress[0][0], 3e5, 1e-9);
}

TEST(MohrCoulomb, tears_at_its_tension_cutoff) {
  MohrCoulomb law = mohr_coulomb(20e3, 30, 10);
  law.tension_cutoff = 4e3;
  Points<3> point(law, 3);
  point.increment[0].strain = {1e-2, 0, 0, 0, 0, 0};        // a plane opens
  point.increment[1].strain = {1e-2, 1e-2, 0, 0, 0, 0};     // a line
  point.increment[2].strain = {1e-2, 1e-2, 1e-2, 0, 0, 0};  // a corner
  point.update();
  EXPECT_NEAR(point.stress[0][0], 4e3, 1e-8);
  EXPECT_NEAR(point.stress[1][1], 4e3, 1e-8);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(point.stress[2][k], 4e3, 1e-8);
}

/// What shear adds to the volume, sin(psi) times the shear strain of a plane, and none of what opens.
TEST(MohrCoulomb, dilates_by_shear_and_not_by_opening) {
  MohrCoulomb law = mohr_coulomb(20e3, 30, 10);
  law.tension_cutoff = 4e3;
  const auto dilation = [&](const Components<2> &strain) {
    Points<2> point(law, 1);
    point.stress[0] = {-1e5, -1e5, -1e5, 0};
    point.increment[0].strain = strain;
    point.update();
    return point.history[1];
  };
  // under constant volume the pressure rises by K times the dilation, and with it the shear stress
  const double sine = std::sin(10 * degree.si), sheared = dilation({0, 0, 0, 0.01});
  const double K = law.bulk_modulus() + law.shear_modulus() / 3, rise = std::sin(30 * degree.si) * K * sheared;
  const double shear_stress = 20e3 * std::cos(30 * degree.si) + std::sin(30 * degree.si) * 1e5 + rise;
  EXPECT_NEAR(sheared, sine * (0.02 - shear_stress / law.shear_modulus()), 1e-12);
  EXPECT_EQ(dilation({1e-2, 0, 0, 0}), 0) << "a plane opens";
  EXPECT_EQ(dilation({1e-2, 1e-2, 0, 0}), 0) << "a line";
  EXPECT_EQ(dilation({1e-2, 1e-2, 1e-2, 0}), 0) << "a corner";
  EXPECT_EQ(dilation({1e-2, 0, 0, 1e-2}), 0) << "a plane opens and slides";
  law.tension_cutoff = -1;
  EXPECT_EQ(dilation({1e-2, 1e-2, 1e-2, 1e-3}), 0) << "the apex";
}

TEST(MohrCoulomb, without_cutoff_bears_tension_up_to_its_apex) {
  const MohrCoulomb law = mohr_coulomb(20e3, 30);
  Points<2> point(law, 1);
  point.increment[0].strain = {1e-2, 1e-2, 1e-2, 0};
  point.update();
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(point.stress[0][k], 20e3 / std::tan(30 * degree.si), 1e-8);
}

/// In simple shear without dilation d gamma_p / sqrt(3) is the equivalent strain; expansion follows the dilation angle.
TEST(MohrCoulomb, measures_plastic_strain) {
  Points<2> tresca(mohr_coulomb(10e3, 0), 1);
  tresca.increment[0].strain = {0, 0, 0, 0.01};
  tresca.update();
  const double plastic = 0.01 - 10e3 / (2 * shear_modulus(tresca.law));
  EXPECT_NEAR(tresca.history[0], 2 * plastic / std::sqrt(3.), 1e-14);
  EXPECT_NEAR(tresca.history[1], 0, 1e-16);

  Points<2> dilatant(mohr_coulomb(10e3, 30, 12), 1);
  dilatant.stress[0] = {-1e6, -1e6, -1e6, 0};
  dilatant.increment[0].strain = {0, 0, 0, 0.1};
  dilatant.update();
  const double volume = dilatant.history[1], sin_psi = std::sin(12 * degree.si);
  const double shear = dilatant.history[0];  // of a face: sqrt(2/3 de:de), e_p ~ (1 + sin psi, 0, -1 + sin psi)
  EXPECT_NEAR(volume / shear, 2 * sin_psi / std::sqrt(2. / 3 * (2 + 2 * sin_psi * sin_psi - 4 * sin_psi * sin_psi / 3)),
              1e-10);
}

MohrCoulomb softening_law() {
  MohrCoulomb law = mohr_coulomb(30e3, 28, 10);
  law.residual_cohesion = 4e3, law.residual_friction_angle = 15 * degree.si, law.shape_factor = 40;
  return law;
}

/// Stress and plastic strain after shear of 8 % under constant normal strain, in equal steps.
std::array<double, 3> sheared(const MohrCoulomb &law, int steps, double size = 1) {
  Points<2> point(law, 1, size);
  point.stress[0] = {-1e5, -1e5, -1e5, 0};
  point.increment[0].strain = {0, 0, 0, 0.04 / steps};
  for (int step = 0; step < steps; ++step) point.update();
  return {point.stress[0][3], point.stress[0][1], point.history[0]};
}

TEST(MohrCoulomb, softens_to_its_residual_strength) {
  const MohrCoulomb law = softening_law();
  Points<2> point(law, 1);
  point.stress[0] = {-1e5, -1e5, -1e5, 0};
  point.increment[0].strain = {0, 0, 0, 0.01};
  for (int step = 0; step < 200; ++step) point.update();
  MohrCoulomb residual = mohr_coulomb(4e3, 15);
  EXPECT_NEAR(Surface(residual).excess(principal(matrix<2>(point.stress[0]))), 0, 1e-6);
}

TEST(MohrCoulomb, softens_to_a_ratio_of_its_peak) {
  MohrCoulomb law = mohr_coulomb(30e3, 28, 10), written_out = law;
  law.residual_ratio = 0.4, law.shape_factor = 40;
  written_out.shape_factor = 40, written_out.residual_cohesion = 0.4 * 30e3;
  written_out.residual_friction_angle = std::atan(0.4 * std::tan(28 * degree.si));
  EXPECT_EQ(law.problem(), "");
  const auto one = sheared(law, 50), other = sheared(written_out, 50);
  for (int k = 0; k < 3; ++k) EXPECT_DOUBLE_EQ(one[k], other[k]);
  law.residual_cohesion = 1e3;
  EXPECT_NE(law.problem().find("residual_ratio must not stand beside"), std::string::npos);
  MohrCoulomb hard = mohr_coulomb(30e3, 28);
  hard.residual_ratio = 0.4;
  EXPECT_NE(hard.problem().find("shape_factor"), std::string::npos);
}

/// Alonso et al. (2015), eqs. (18), (19): c' = c_r + (c_p - c_r) exp(-eta eps_p), phi' likewise.
TEST(MohrCoulomb, softens_by_the_exponential_law) {
  const MohrCoulomb law = softening_law();
  Points<2> point(law, 1);
  point.stress[0] = {-1e5, -1e5, -1e5, 0};
  point.increment[0].strain = {0, 0, 0, 1e-6};
  for (int step = 0; step < 20000; ++step) point.update();
  const double left = std::exp(-40 * point.history[0]);
  const MohrCoulomb now = mohr_coulomb(4e3 + 26e3 * left, 15 + 13 * left);
  EXPECT_GT(left, 0.1);
  EXPECT_LT(left, 0.7);
  EXPECT_NEAR(Surface(now).excess(principal(matrix<2>(point.stress[0]))), 0, 1e-5 * law.cohesion);
}

TEST(MohrCoulomb, softening_converges_at_first_order_in_the_step) {
  const auto exact = sheared(softening_law(), 1 << 16);
  double last = 0;
  for (int steps = 32; steps <= 512; steps *= 2) {
    const double error = std::abs(sheared(softening_law(), steps)[0] - exact[0]);
    if (last > 0) {
      EXPECT_NEAR(last / error, 2, 0.3) << steps;
    }
    last = error;
  }
  EXPECT_LT(last, 2e-3 * exact[0]);
}

/// eta h / h_ref: an element of twice the size softens at twice the rate, so that slip does the same to both.
TEST(MohrCoulomb, scales_softening_with_element_size) {
  MohrCoulomb law = softening_law(), scaled = law, twice = law;
  scaled.reference_size = 0.5;
  twice.shape_factor *= 2;
  EXPECT_EQ(sheared(scaled, 50, 0.5), sheared(law, 50));
  EXPECT_EQ(sheared(scaled, 50, 1), sheared(twice, 50));
  EXPECT_EQ(sheared(scaled, 50, 0), sheared(law, 50)) << "no size, no scaling";
}

/// A band of thickness h slips by d: gamma_p = d / h. With phi = 0 the stress in it is c, so the work lost over the
/// area is c_r d + (c_p - c_r) sqrt(3) h_ref / eta (1 - exp(-eta d / (sqrt(3) h_ref))), the same for elements of any
/// size.
TEST(MohrCoulomb, loses_the_same_work_over_the_area_of_a_band_whatever_the_size_of_the_element) {
  MohrCoulomb law = mohr_coulomb(30e3, 0);
  law.residual_cohesion = 5e3, law.shape_factor = 50, law.reference_size = 0.5;
  const double slip = 0.03, G = law.shear_modulus(), length = std::sqrt(3.) * law.reference_size / law.shape_factor;
  const double exact = 5e3 * slip + 25e3 * length * (1 - std::exp(-slip / length));
  for (const double h : {0.125, 0.25, 0.5, 1., 2.}) {
    Points<2> point(law, 1, h);
    point.stress[0] = {-1e5, -1e5, -1e5, 0};
    const int steps = 20000;
    double lost = 0, tau = 0, plastic = 0;
    for (int step = 0; plastic * h < slip; ++step) {
      const double shear = 1.05 * slip / h / steps;  // gamma
      point.increment[0].strain = {0, 0, 0, shear / 2};
      point.update();
      const double now = point.stress[0][3], flown = shear - (now - tau) / G;
      lost += flown * (now + tau) / 2 * h, plastic += flown, tau = now;
      ASSERT_LT(step, 2 * steps);
    }
    EXPECT_NEAR(lost, exact, 2e-3 * exact) << h;
  }
}

TEST(MohrCoulomb, never_dilates_more_than_it_rubs) {
  MohrCoulomb law = softening_law();
  law.dilation_angle = 28 * degree.si, law.residual_friction_angle = 0;
  law.prepare();
  EXPECT_NEAR(law.strength(0., {1}).sin_psi, std::sin(28 * degree.si), 1e-15);
  EXPECT_LT(law.strength(1e3, {1}).sin_psi, 1e-300);
}

TEST(MohrCoulomb, loses_dilation_as_it_loses_strength) {
  MohrCoulomb law = softening_law();
  law.residual_dilation_angle = 0;
  law.prepare();
  EXPECT_NEAR(law.strength(0., {1}).sin_psi, std::sin(10 * degree.si), 1e-15);
  EXPECT_NEAR(law.strength(0.02, {1}).sin_psi, std::sin(10 * degree.si) * std::exp(-40 * 0.02), 1e-15);
  EXPECT_LT(law.strength(10., {1}).sin_psi, 1e-100);
}

/// However far the soil shears on.
TEST(MohrCoulomb, dilates_no_more_once_its_dilation_is_lost) {
  MohrCoulomb law = softening_law();
  law.residual_dilation_angle = 0;
  Points<2> point(law, 1);
  point.stress[0] = {-1e5, -1e5, -1e5, 0};
  point.increment[0].strain = {0, 0, 0, 1e-4};
  for (int step = 0; step < 2000; ++step) point.update();
  const double after = point.history[1];
  for (int step = 0; step < 2000; ++step) point.update();
  EXPECT_GT(point.history[0], 0.4);
  EXPECT_GT(after, 1e-3);
  EXPECT_NEAR(point.history[1], after, 1e-3 * after);
}

/// Alonso et al. (2015), Table 3: dc_max = 15 kPa, B = 0.0007 and A = 0.0001 degrees per kPa give
/// 1 + 6.43 kPa and 0.08 degrees more at s = 800 kPa.
MohrCoulomb embankment() {
  MohrCoulomb law = mohr_coulomb(1e3, 23);
  law.suction_cohesion = 15e3, law.suction_cohesion_rate = 7e-7, law.suction_friction_rate = 1e-7 * degree.si;
  return law;
}

/// Alonso et al. (2015), eqs. (14) to (17), alone and with (18), (19).
TEST(MohrCoulomb, gains_strength_from_suction) {
  MohrCoulomb law = embankment();
  law.prepare();
  const double s = 800e3, c = 1e3 + 15e3 * (1 - std::exp(-0.56)), phi = (23 + 0.08) * degree.si;
  EXPECT_NEAR(c, 7.43e3, 5);
  EXPECT_NEAR(law.strength(0., {1, s}).sin_phi, std::sin(phi), 1e-15);
  EXPECT_NEAR(law.strength(0., {1, s}).twice_c_cos_phi, 2 * c * std::cos(phi), 1e-11);
  EXPECT_NEAR(law.strength(0., {1, 0}).twice_c_cos_phi, 2e3 * std::cos(23 * degree.si), 1e-12);
  EXPECT_NEAR(law.strength(0., {1, 1e12}).sin_phi, std::sin(80 * degree.si), 1e-15) << "phi has an end";
  law.residual_cohesion = 0, law.residual_friction_angle = 20 * degree.si, law.shape_factor = 40;
  law.prepare();
  const double left = std::exp(-40 * 0.03), soft_phi = (20 + 3 * left + 0.08) * degree.si;
  EXPECT_NEAR(law.strength(0.03, {1, s}).sin_phi, std::sin(soft_phi), 1e-15);
  EXPECT_NEAR(law.strength(0.03, {1, s}).twice_c_cos_phi, 2 * (c - 1e3 + 1e3 * left) * std::cos(soft_phi), 1e-11);
}

/// Each point has the strength of its own suction; a point without a suction array has none.
TEST(MohrCoulomb, yields_where_its_suction_says) {
  Points<2> points(embankment(), 20);
  for (int i = 0; i < 20; ++i) points.suction[i] = 40e3 * i, points.stress[i] = {-4e4, -4e4, -4e4, 0};
  for (auto &increment : points.increment) increment.strain = {0, 0, 0, 0.05};
  Points<2> dry = points;
  points.update();
  StressPoints<2> view = dry.view();
  view.suction = nullptr;
  update_stress<2>(dry.law, view);
  for (int i = 0; i < 20; ++i) {
    MohrCoulomb same = mohr_coulomb(1e3 + 15e3 * (1 - std::exp(-7e-7 * 40e3 * i)), 23 + 1e-7 * 40e3 * i);
    EXPECT_NEAR(Surface(same).excess(principal(matrix<2>(points.stress[i]))), 0, 1e-9);
    EXPECT_NEAR(Surface(mohr_coulomb(1e3, 23)).excess(principal(matrix<2>(dry.stress[i]))), 0, 1e-9);
  }
}

/// Soil that sees an average softens by it, and what it strains is added to its own strain. Points that stay elastic,
/// in a block of their own or beside others, keep theirs to the bit.
TEST(MohrCoulomb, softens_by_an_average_and_keeps_its_own_strain) {
  MohrCoulomb law = mohr_coulomb(5e3, 30);
  law.residual_cohesion = 0, law.residual_friction_angle = 15 * degree.si, law.shape_factor = 40;
  const int count = 27;
  Points<2> own(law, count);
  std::vector<double> excess(count);
  for (int i = 0; i < count; ++i) {
    own.stress[i] = {-4e4, -4e4, -4e4, 0}, own.history[2 * i] = 1e-3 * i, excess[i] = 0.01 - 1e-4 * i;
    own.increment[i].strain = {0, 0, 0, i < 8 || i % 3 ? 1e-6 : 0.05};
  }
  Points<2> seen = own;
  for (int i = 0; i < count; ++i) seen.history[2 * i] += excess[i];
  const std::vector<double> before = own.history, shown = seen.history;
  StressPoints<2> view = own.view();
  view.excess = excess.data(), view.averaged = 0;
  update_stress<2>(law, view);
  seen.update();
  EXPECT_EQ(own.stress, seen.stress);
  for (int i = 0; i < count; ++i) {
    const double gain = seen.history[2 * i] - shown[2 * i];
    EXPECT_EQ(own.history[2 * i], before[2 * i] + gain);
    EXPECT_EQ(gain > 0, own.increment[i].strain[3] > 0.01);
  }
}

}  // namespace
}  // namespace talus
