// Drag at a node: momentum, limits, and the exact decay to first order.
#include "physics/pores/drag.h"

#include <gtest/gtest.h>

#include <cmath>

namespace talus {
namespace {

constexpr double grains = 1800;
constexpr NodalFluid water{300, 1000, 3e6}, air{0.05, 1.2, 50};

TEST(Drag, conserves_momentum) {
  const NodalFluid fluids[]{water, air};
  for (double step : {1e-9, 1e-4, 1e3}) {
    double solid = 0.3, v[]{-1., 5.};
    resolve_drag<2>(step, grains, solid, fluids, v);
    EXPECT_NEAR(grains * solid + 300 * v[0] + 0.05 * v[1], grains * 0.3 - 300 + 0.25, 1e-10);
  }
}

TEST(Drag, joins_what_it_holds_together_and_leaves_what_it_does_not) {
  const NodalFluid tight{300, 1000, 1e18}, open{300, 1000, 1e-12};
  double solid = 0.3, v = -1;
  resolve_drag<1>(1e-3, grains, solid, &tight, &v);
  EXPECT_NEAR(solid, v, 1e-9);
  solid = 0.3, v = -1;
  resolve_drag<1>(1e-3, grains, solid, &open, &v);
  EXPECT_NEAR(solid, 0.3, 1e-12);
  EXPECT_NEAR(v, -1, 1e-12);
}

TEST(Drag, relaxes_at_the_rate_of_both_masses) {
  // d(v_l - v_s)/dt = -(Q / M + m Q / (M m_s)) (v_l - v_s)
  const double rate = 3e6 / 1000 * (1 + 300 / grains), step = 1e-8;
  double solid = 0, v = 1;
  resolve_drag<1>(step, grains, solid, &water, &v);
  EXPECT_NEAR((1 - (v - solid)) / step, rate, 1e-4 * rate);
}

TEST(Drag, does_not_move_what_is_held_nor_where_no_fluid_is) {
  double solid = 0, v = 1;
  resolve_drag<1>(1, grains, solid, &water, &v, true);
  EXPECT_EQ(solid, 0);
  EXPECT_NEAR(v, 1 / (1 + 3e6 / 1000), 1e-12);
  const NodalFluid none{0, 0, 0};
  solid = 0.3, v = 1;
  resolve_drag<1>(1, grains, solid, &none, &v);
  EXPECT_EQ(solid, 0.3);
  EXPECT_EQ(v, 1);
}

}  // namespace
}  // namespace talus
