// A bar between points that slip, where the answer is known.
#include "physics/structures/bar_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace talus {
namespace {

/// A bar of elements of 1 m; bond forces are those of a metre.
BarChain bar(int elements, double stiffness, double capacity, double bond_stiffness, double bond) {
  BarChain chain;
  chain.element.resize(elements), chain.point.resize(elements + 1);
  for (BarElement &one : chain.element) one.length = 1, one.stiffness = stiffness, one.tension = capacity;
  for (int i = 0; i <= elements; ++i) {
    const double length = i == 0 || i == elements ? 0.5 : 1;
    chain.point[i].stiffness = bond_stiffness * length, chain.point[i].limit = bond * length;
  }
  return chain;
}

TEST(BarChain, pulls_out_with_its_bond_times_length) {
  BarChain chain = bar(10, 1e8, 1e9, 1e7, 2e3);
  chain.element[0].stiffness = 1e6;  // a free length behind a plate
  chain.point[0].limit = 1e9, chain.point[0].stiffness = 1e12;
  chain.point[1].limit /= 2;
  std::vector<double> stretch(10, 0);
  stretch[0] = 1;
  ASSERT_TRUE(chain.deform(stretch));
  EXPECT_NEAR(chain.force(0) / (9 * 2e3), 1, 1e-8);
  for (int e = 1; e < 10; ++e) EXPECT_NEAR(chain.force(e) / ((9 - (e - 0.5)) * 2e3), 1, 1e-8) << e;
  chain.commit();
  EXPECT_GT(chain.point[10].slip, -1.);
  EXPECT_LT(chain.point[10].slip, -0.9);  // it was drawn towards its head
}

TEST(BarChain, yields_at_its_capacity_and_unloads_elastically) {
  BarChain chain = bar(1, 1e6, 5e3, 1e9, 1e9);
  ASSERT_TRUE(chain.deform({0.01}));
  EXPECT_NEAR(chain.force(0), 5e3, 1e-6);
  chain.commit();
  EXPECT_NEAR(chain.element[0].yielded, 0.005, 1e-4);
  ASSERT_TRUE(chain.deform({-0.002}));
  EXPECT_NEAR(chain.force(0), 3e3, 10);  // the ends give by a two hundred and fiftieth
}

TEST(BarChain, takes_up_its_slack_before_it_bears_again) {
  BarChain chain = bar(1, 1e6, 1e9, 1e12, 1e12);
  ASSERT_TRUE(chain.deform({-0.01}));
  EXPECT_EQ(chain.force(0), 0);
  chain.commit();
  ASSERT_TRUE(chain.deform({0.009}));
  EXPECT_EQ(chain.force(0), 0);
  chain.commit();
  ASSERT_TRUE(chain.deform({0.002}));
  EXPECT_NEAR(chain.force(0), 1e3, 1);
}

TEST(BarChain, holds_the_force_of_a_jack) {
  BarChain chain = bar(3, 1e8, 1e9, 1e7, 1e5);
  chain.element[0].held = 1, chain.element[0].pull = 7e3;
  ASSERT_TRUE(chain.deform({0.3, 0, 0}));
  EXPECT_EQ(chain.force(0), 7e3);
  EXPECT_LT(chain.force(1), 7e3);
  std::vector<double> rows;
  chain.tangent(1, 0, rows);
  EXPECT_EQ(rows[0], 0);
}

/// Force, tangent and energy belong together whatever yields, slips or is slack: the tangent is symmetric, positive and
/// that of the forces.
TEST(BarChain, tangent_is_the_derivative_of_the_forces) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    BarChain chain = bar(7, 1e7, 4e4 * (1.1 + uniform(random)), 1e7, 2e4 * (1.1 + uniform(random)));
    std::vector<double> stretch(7), rows, there(7);
    for (int step = 0; step < 3; ++step) {
      for (double &one : stretch) one = 0.01 * uniform(random);
      ASSERT_TRUE(chain.deform(stretch)) << trial;
      if (step < 2) chain.commit();
    }
    chain.tangent(1, 0, rows);
    constexpr double stiffness = 1e7;
    BarChain other = chain;
    for (int e = 0; e < 7; ++e) there[e] = chain.force(e);
    constexpr double small = 1e-8;
    for (int k = 0; k < 7; ++k) {
      std::vector<double> more = stretch;
      more[k] += small;
      ASSERT_TRUE(other.deform(more));
      for (int e = 0; e < 7; ++e) {
        EXPECT_NEAR((other.force(e) - there[e]) / small, rows[7 * e + k], 1e-4 * stiffness) << trial << e << k;
        EXPECT_NEAR(rows[7 * e + k], rows[7 * k + e], 1e-12 * stiffness);
      }
      EXPECT_GE(rows[8 * k], -1e-12 * stiffness);
    }
  }
}

TEST(BarChain, divides_its_capacities_in_trials) {
  BarChain chain = bar(1, 1e6, 5e3, 1e9, 1e9);
  chain.divisor = 2;
  ASSERT_TRUE(chain.deform({1}));
  EXPECT_NEAR(chain.force(0), 2.5e3, 1e-6);
}

TEST(BarChain, tears_beyond_its_rupture_strain) {
  BarChain chain = bar(2, 1e6, 5e3, 1e12, 1e12);
  ASSERT_TRUE(chain.deform({0.02, 0.001}));
  EXPECT_EQ(chain.to_tear(0.02), -1);
  EXPECT_EQ(chain.to_tear(0.01), 0);
  chain.element[0].torn = 1;
  ASSERT_TRUE(chain.deform({0.02, 0.001}));
  EXPECT_EQ(chain.force(0), 0);
  EXPECT_NEAR(chain.force(1), 1e3, 1);
}

}  // namespace
}  // namespace talus
