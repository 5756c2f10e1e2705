// A base that sliding heats, docs/theory (6.7)-(6.11). A rigid slab of soil slides at a given speed on the unit
// square's base under a given normal stress, so that slip, friction, heat and excess pressure have the closed forms of
// Rice (2006), J. Geophys. Res. 111, B05311: undrained and adiabatic, and slip on a plane. With friction that does not
// lag behind the normal force (no delay) a step is exact but for its length.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "physics/boundary/kinds.h"
#include "square.h"

namespace talus {
namespace {

constexpr double stress = 2e6, speed = 3;  // on the base [Pa], along it [m/s]
const double coefficient = std::tan(std::numbers::pi / 15);

HeatedFriction heated(double thickness, double thermal_conductivity, double hydraulic_conductivity) {
  HeatedFriction base;
  base.friction_angle = std::numbers::pi / 15;  // 12 deg
  base.zone.thickness = thickness;
  base.zone.heat_capacity = 2.7e6;
  base.zone.thermal_conductivity = thermal_conductivity;
  base.zone.hydraulic_conductivity = hydraulic_conductivity;
  base.zone.storage = 1.6e-9;
  base.zone.thermal_pressurisation = 6e4;
  return base;
}

/// A slab that slides on.
struct Slab {
  explicit Slab(Boundary base)
      : soil({{"base", {"base"}, std::move(base)}}), v(soil.grid.node_count()), u(v), area(v.size(), 0) {
    for (int i = 0; i < soil.grid.node_count(); ++i) soil.grid.mass[i] = 1e7;  // friction hardly slows it down
    for (const Facet<2> &facet : soil.mesh.facets("base"))
      for (const int node : facet.node) area[soil.grid.find_node(node)] += facet.area / 2;
    EXPECT_EQ(soil.grid.sum(area.data(), 1), 0);
  }
  /// One step with the soil at rest against the base or sliding on it; returns friction over normal force.
  double step(double length, double along = speed, double pressing = stress) {
    for (int i = 0; i < soil.grid.node_count(); ++i) {
      v[i] = u[i] = {};
      if (!soil.at_base(i)) continue;
      v[i] = {along, -pressing * area[i] * length / soil.grid.mass[i]}, u[i] = {along * length, 0};
    }
    soil.conditions.resolve(0, length, soil.grid, v.data());
    soil.conditions.add_work(soil.grid, u.data());
    return report().friction;
  }
  RigidBases<2>::Report report() {
    std::vector<RigidBases<2>::Report> all;
    EXPECT_EQ(soil.conditions.bases().take_reports(PETSC_COMM_WORLD, all), 0);
    return all[0];
  }
  Square1m soil;
  std::vector<Vec<2>> v, u;
  std::vector<double> area;  ///< of the base, by node [m2]
};

/// tau = f sigma exp(-D / L*): the error is that of implicit Euler, which halves with the step.
TEST(HeatedBase, LosesFrictionExponentiallyWhenUndrainedAndAdiabatic) {
  const HeatedFriction base = heated(0.01, 0, 0);
  const double length = base.zone.weakening_slip(coefficient), slip = 2 * length;
  double before = 0;
  for (const int steps : {50, 100, 200, 400}) {
    Slab slab{Boundary(base)};
    double friction = 0;
    for (int k = 0; k < steps; ++k) friction = slab.step(slip / speed / steps);
    const double error = friction / coefficient - std::exp(-2.);
    EXPECT_NEAR(slab.report().slip, slip, 1e-9);
    EXPECT_LT(std::abs(error), 0.3 / steps);  // 2 exp(-2) of the step to first order
    if (before != 0) {
      EXPECT_NEAR(before / error, 2, 0.1);
    }
    before = error;
  }
}

/// tau = f sigma exp(D / L) erfc(sqrt(D / L)), L = (4 / f2) (rho c / Lambda)2 (sqrt(a_hy) + sqrt(a_th))2 / V, of a
/// plane: zones that are thin against the ways of heat and water come ever nearer.
TEST(HeatedBase, ApproachesSlipOnAPlaneAsItGetsThinner) {
  double before = 1;
  for (const double thickness : {1e-3, 2.5e-4, 6e-5}) {
    const HeatedFriction base = heated(thickness, 2, 1e-11);
    const double roots = std::sqrt(base.zone.hydraulic_diffusivity()) + std::sqrt(base.zone.thermal_diffusivity());
    const double ratio = base.zone.heat_capacity / (coefficient * base.zone.thermal_pressurisation);
    const double length = 4 * ratio * ratio * roots * roots / speed;
    Slab slab{Boundary(base)};
    constexpr int steps = 400;
    double worst = 0;
    for (int k = 1; k <= steps; ++k) {  // slip grows with the square of the number of the step, up to L
      const double end = length * k * k / (steps * steps), begin = length * (k - 1) * (k - 1) / (steps * steps);
      const double friction = slab.step((end - begin) / speed) / coefficient, d = end / length;
      if (d > 0.1) worst = std::max(worst, std::abs(friction - std::exp(d) * std::erfc(std::sqrt(d))));
    }
    RecordProperty("error_" + std::to_string(thickness), std::to_string(worst));
    EXPECT_LT(worst, 0.6 * before) << thickness;
    before = worst;
  }
  EXPECT_LT(before, 0.01);  // 1 % of the friction of the cold base
}

/// Water that drains at once takes no friction away, heat that expands nothing neither; a base that drains slowly has
/// its friction back in time.
TEST(HeatedBase, KeepsItsFrictionWhenDrained) {
  HeatedFriction drained = heated(0.01, 2, 0.1), without_expansion = heated(0.01, 2, 1e-11);
  without_expansion.zone.thermal_pressurisation = 0;
  for (const HeatedFriction &base : {drained, without_expansion}) {
    Slab slab{Boundary(base)};
    double friction = 0;
    for (int k = 0; k < 100; ++k) friction = slab.step(0.01);
    EXPECT_NEAR(friction, coefficient, 1e-3 * coefficient);
    EXPECT_GT(slab.report().temperature, 10);
  }
  Slab slab{Boundary(heated(0.01, 0, 1e-11))};
  for (int k = 0; k < 100; ++k) slab.step(0.01);
  const double hot = slab.step(1e-6), pressure = slab.report().pressure;
  for (int k = 0; k < 100; ++k) slab.step(1e3, 0);  // at rest
  EXPECT_LT(hot, 0.8 * coefficient);
  EXPECT_LT(slab.report().pressure, 0.05 * pressure);
  EXPECT_NEAR(slab.step(1e-6), coefficient, 0.05 * coefficient);
}

/// Heat is the work of friction, to round-off of a thousand steps, also where it spreads to the end of the grid.
TEST(HeatedBase, ConservesEnergy) {
  HeatedFriction base = heated(0.01, 200, 1e-10);
  base.zone.reach = 0.02;
  base.base_adhesion = 1e4;
  Slab slab{Boundary(base)};
  for (int k = 0; k < 1000; ++k) slab.step(1e-3 * (1 + k % 3), k % 5 ? speed : 0);
  const double work = test::sum(slab.soil.conditions.work()[0]), heat = slab.report().heat;
  EXPECT_LT(work, -1e5);
  EXPECT_NEAR(heat, -work, 1e-11 * heat);
}

/// Excess pressure never exceeds the normal stress by its own doing, however long the steps are.
TEST(HeatedBase, IsStableInLongSteps) {
  Slab slab{Boundary(heated(1e-3, 0, 0))};
  for (int k = 0; k < 10; ++k) {
    const double friction = slab.step(10);  // slips a hundred times L*
    EXPECT_GE(friction, 0);
    EXPECT_LE(slab.report().pressure, stress * (1 + 1e-9));
  }
}

/// Friction and adhesion follow the slip of the base at the place, which counts where soil touches it, in stages that
/// record it, until it is forgotten.
TEST(FrictionBySlip, FollowsTheWayAlongTheBase) {
  Friction base;
  base.friction_angle = Function("20 - 40 * slip", degree.si);
  EXPECT_TRUE(Boundary(base).remembers);
  EXPECT_FALSE(Boundary(Friction{}).remembers);
  Slab slab{Boundary(base)};
  const auto expected = [](double slip) { return std::tan((20 - 40 * slip) * degree.si); };
  EXPECT_NEAR(slab.step(0.01), expected(0), 1e-12);
  EXPECT_NEAR(slab.step(0.01), expected(0.03), 1e-12);
  slab.step(0.02, -speed);  // a way has no direction
  EXPECT_NEAR(slab.report().slip, 0.12, 1e-12);
  slab.step(0.01, speed, -stress);  // in the air
  EXPECT_NEAR(slab.step(0.01), expected(0.12), 1e-12);
  slab.soil.conditions.bases().remember_slip(false);
  EXPECT_NEAR(slab.step(0.01), expected(0.15), 1e-12);
  EXPECT_NEAR(slab.step(0.01), expected(0.15), 1e-12);
  slab.soil.conditions.bases().remember_slip(true);
  slab.soil.conditions.bases().forget_slip();
  EXPECT_NEAR(slab.step(0.01), expected(0), 1e-12);
}

/// A stage that does not record slip neither heats the base nor forgets its heat, which spreads on.
TEST(HeatedBase, IsHeatedOnlyWhereSlipCounts) {
  Slab slab{Boundary(heated(0.01, 0, 0))};
  slab.soil.conditions.bases().remember_slip(false);
  EXPECT_NEAR(slab.step(0.1), coefficient, 1e-12);
  EXPECT_EQ(slab.report().heat, 0);
  slab.soil.conditions.bases().remember_slip(true);
  slab.step(0.1);
  const double heat = slab.report().heat;
  EXPECT_GT(heat, 0);
  slab.soil.conditions.bases().remember_slip(false);
  EXPECT_LT(slab.step(0.1), 0.95 * coefficient);
  EXPECT_NEAR(slab.report().heat, heat, 1e-12 * heat);
  slab.soil.conditions.bases().forget_slip();
  EXPECT_NEAR(slab.step(0.1), coefficient, 1e-12);
}

}  // namespace
}  // namespace talus
