/// What holds for any law. A new law is tested here as soon as it stands in `Laws`; it brings its examples.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "examples.h"

namespace talus {
namespace {

template <class OneLaw>
class EveryLaw : public ::testing::Test {};
TYPED_TEST_SUITE(EveryLaw, TypesOf<Laws>::type);

TYPED_TEST(EveryLaw, says_what_it_remembers) {
  std::set<std::string> names;
  const Law law = examples<TypeParam>()[0];
  for (const HistoryField &field : history_fields(law)) {
    EXPECT_TRUE(names.insert(field.name).second);
    EXPECT_GT(std::string(field.meaning).size(), 10u);
    EXPECT_NE(field.unit.name, nullptr);
  }
  EXPECT_EQ(history_size(law), static_cast<int>(names.size()));
  EXPECT_STREQ(law_name(law), TypeParam::name);
  EXPECT_GT(std::string(TypeParam::meaning).size(), 10u);
}

TYPED_TEST(EveryLaw, has_moduli_of_a_stable_material) {
  for (const TypeParam &law : examples<TypeParam>()) {
    EXPECT_GT(bulk_modulus(law), 0);
    EXPECT_GT(shear_modulus(law), 0);
    EXPECT_DOUBLE_EQ(constrained_modulus(law), bulk_modulus(law) + 4 * shear_modulus(law) / 3);
  }
}

/// Q s Q^T strained by Q e Q^T ends as Q s' Q^T: no direction is preferred.
TYPED_TEST(EveryLaw, is_objective) {
  for_all<TypeParam>([]<int dim>(Dim<dim>, const Law &law) {
    Random random;
    const int n = 2000;
    Points<dim> points(law, n), turned(law, n);
    std::vector<Matrix> Q(n);
    for (int i = 0; i < n; ++i) {
      Q[i] = random.rotation<dim>();
      points.stress[i] = random.symmetric<dim>(scale);
      points.increment[i].strain = random.symmetric<dim>(0.01);
      turned.stress[i] = components<dim>(Q[i] * matrix<dim>(points.stress[i]) * Q[i].transpose());
      turned.increment[i].strain = components<dim>(Q[i] * matrix<dim>(points.increment[i].strain) * Q[i].transpose());
    }
    points.update(), turned.update();
    double worst = 0, worst_history = 0;
    for (int i = 0; i < n; ++i)
      worst = std::max(
          worst, (Q[i] * matrix<dim>(points.stress[i]) * Q[i].transpose() - matrix<dim>(turned.stress[i])).norm());
    const auto fields = history_fields(law);
    for (std::size_t k = 0; k < points.history.size(); ++k)
      if (!fields[k % fields.size()].of_tensor)
        worst_history = std::max(worst_history,
                                 std::abs(points.history[k] - turned.history[k]) / (1 + std::abs(points.history[k])));
    EXPECT_LT(worst, 1e-10 * scale);
    EXPECT_LT(worst_history, 1e-12);
  });
}

TYPED_TEST(EveryLaw, keeps_principal_stresses_under_finite_rotation) {
  for_all<TypeParam>([]<int dim>(Dim<dim>, const Law &law) {
    Random random;
    const int n = 2000;
    Points<dim> still(law, n), turned(law, n);
    std::vector<Matrix> R(n);
    for (int i = 0; i < n; ++i) {
      R[i] = random.rotation<dim>();
      still.stress[i] = turned.stress[i] = random.symmetric<dim>(scale);
      still.increment[i].strain = random.symmetric<dim>(0.02);
      turned.increment[i] = still.increment[i];
      turned.turn(i, R[i]);
    }
    still.update(), turned.update();
    double worst = 0;
    for (int i = 0; i < n; ++i)
      worst = std::max(worst,
                       (R[i] * matrix<dim>(still.stress[i]) * R[i].transpose() - matrix<dim>(turned.stress[i])).norm());
    EXPECT_LT(worst, 1e-12 * 1e6);
    const auto fields = history_fields(law);
    for (std::size_t k = 0; k < still.history.size(); ++k)
      if (!fields[k % fields.size()].of_tensor) {
        EXPECT_EQ(still.history[k], turned.history[k]);
      }
  });
}

TYPED_TEST(EveryLaw, leaves_what_it_admitted) {
  for_all<TypeParam>([]<int dim>(Dim<dim>, const Law &law) {
    Random random;
    Points<dim> points(law, 2000);
    for (auto &s : points.stress) s = random.symmetric<dim>(scale);
    points.admit();
    const auto fields = history_fields(law);
    for (std::size_t k = 0; k < points.history.size(); ++k)
      if (!fields[k % fields.size()].kept) points.history[k] = 1e3;  // no strength is left to lose
    points.admit();
    const auto admitted = points.stress;
    points.admit();
    double worst = 0;
    for (std::size_t i = 0; i < admitted.size(); ++i)
      worst = std::max(worst, (matrix<dim>(points.stress[i]) - matrix<dim>(admitted[i])).norm());
    EXPECT_LT(worst, 1e-12 * scale);
  });
}

TYPED_TEST(EveryLaw, is_the_same_in_plane_strain_and_in_3d) {
  for (const TypeParam &law : examples<TypeParam>()) {
    Random random;
    const int n = 5000;
    Points<2> plane(law, n);
    Points<3> solid(law, n);
    for (int i = 0; i < n; ++i) {
      const Matrix R = random.rotation<2>();
      plane.stress[i] = random.symmetric<2>(scale);
      plane.increment[i].strain = random.symmetric<2>(0.01);
      solid.stress[i] = components<3>(matrix<2>(plane.stress[i]));
      solid.increment[i].strain = components<3>(matrix<2>(plane.increment[i].strain));
      plane.turn(i, R), solid.turn(i, R);
    }
    plane.update(), solid.update();
    double worst = 0, worst_history = 0;
    for (int i = 0; i < n; ++i)
      worst = std::max(worst, (matrix<2>(plane.stress[i]) - matrix<3>(solid.stress[i])).norm());
    for (std::size_t k = 0; k < plane.history.size(); ++k)
      worst_history =
          std::max(worst_history, std::abs(plane.history[k] - solid.history[k]) / (1 + std::abs(plane.history[k])));
    EXPECT_LT(worst, 1e-10 * scale);
    EXPECT_LT(worst_history, 1e-12);
  }
}

/// The answer for a point depends on neither its place in a block nor the number of points; input may be output.
TYPED_TEST(EveryLaw, treats_points_alone_and_in_blocks_alike) {
  for_all<TypeParam>([]<int dim>(Dim<dim>, const Law &law) {
    Random random;
    for (int n = 1; n < 20; ++n) {
      Points<dim> many(law, n);
      for (int i = 0; i < n; ++i) {
        many.stress[i] = random.symmetric<dim>(scale);
        many.increment[i].strain = random.symmetric<dim>(0.01);
        many.turn(i, random.rotation<dim>());
        many.cell[i] = n - 1 - i;
      }
      std::vector<Components<dim>> out(n, Components<dim>{});
      std::vector<double> history(many.history.size());
      StressPoints<dim> apart = many.view();
      apart.stress_out = out[0].data(), apart.history_out = history.data();
      update_stress<dim>(law, apart);
      for (int i = 0; i < n; ++i) {
        Points<dim> one(law, 1);
        one.stress[0] = many.stress[i], one.increment[0] = many.increment[many.cell[i]];
        one.update();
        EXPECT_EQ(one.stress[0], out[i]);
      }
      many.update();
      EXPECT_EQ(many.stress, out);
      EXPECT_EQ(many.history, history);
    }
  });
}

/// Elastic energy is the work of straining from zero stress, where the law stays elastic: 1/2 s : C^-1 : s if its
/// elasticity is linear. Of any law: the work of isotropic compression by 1e-3, which for laws that keep a volume
/// differs from the energy at the volume of the start by that share, or twice that.
TYPED_TEST(EveryLaw, stores_elastic_energy) {
  Random random;
  const Law law = examples<TypeParam>()[0];
  for (int i = 0; linear_inside<TypeParam> && i < 100; ++i) {
    const Components<3> s = random.symmetric<3>(scale);
    const Stress<3> stress{s[0], s[1], s[2], s[3], s[4], s[5]};
    const double expected = matrix<3>(s).cwiseProduct(elastic_strain(law, matrix<3>(s))).sum() / 2;
    EXPECT_NEAR(elastic_energy(law, stress), expected, 1e-12 * expected);
  }
  constexpr int steps = 1000;
  Points<3> point(law, 1);
  point.increment[0].strain = {-1e-3 / (3 * steps), -1e-3 / (3 * steps), -1e-3 / (3 * steps), 0, 0, 0};
  double work = 0, p = 0;
  for (int step = 0; step < steps; ++step) {
    point.update();
    const double now = -point.stress[0][0];
    work += (p + now) / 2 * 1e-3 / steps, p = now;
  }
  const auto &s = point.stress[0];
  const double energy = elastic_energy(law, Stress<3>{s[0], s[1], s[2], s[3], s[4], s[5]});
  EXPECT_GT(work, 0);
  EXPECT_NEAR(energy, work, 2e-3 * work);
}

}  // namespace
}  // namespace talus
