// Integrators that treat drag between phases implicitly, on a chain of grains and water whose motion is known.
#include <gtest/gtest.h>

#include "solvers/critical_step.h"
#include "solvers/integrators.h"
#include "springs.h"
#include "wet_springs.h"

namespace talus {
namespace {

constexpr double end = 3;

ArkodeSettings with_drag() {
  ArkodeSettings settings;
  settings.order = 3, settings.drag = true;
  return settings;
}

double error_with(const ArkodeSettings &settings, double drag, double water_velocity = 0.5) {
  WetSprings motion(1, 4, drag, water_velocity);
  const Eigen::VectorXd exact = motion.exact(end);
  Arkode integrator(settings);
  run_to(integrator, motion, 2 / motion.largest_frequency(), end);
  return motion.error(exact);
}

TEST(ImEx, is_of_third_order) {
  double errors[3];
  for (int k = 0; k < 3; ++k) {
    ArkodeSettings settings = with_drag();
    settings.step = 0.1 / (1 << k), errors[k] = error_with(settings, 2);
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[2]) / 2, 3, 0.25);
}

// Explicitly a step could not exceed 2 / d, d = drag (1 / m_s + 1 / m_l): 5e-9 s at the last one. The phases start at
// different velocities, which drag ends within the first step.
TEST(ImEx, drag_however_stiff_does_not_limit_the_step) {
  for (const double drag : {1e2, 1e4, 1e8}) {
    WetSprings motion(1, 4, drag);
    ArkodeSettings settings = with_drag();
    settings.velocity_tolerance = settings.displacement_tolerance = 1;
    const double critical = 2 / motion.largest_frequency();
    const Eigen::VectorXd exact = motion.exact(end);
    Arkode integrator(settings);
    const int steps = run_to(integrator, motion, critical, end);
    EXPECT_LE(steps, std::ceil(end / (settings.rule().share * critical)) + 3)
        << drag;  // the first steps grow from a tenth
    EXPECT_EQ(integrator.statistics().rejections, 0);
    EXPECT_LT(motion.error(exact), 0.02) << drag;
  }
}

// From a start that drag leaves as it is: no step is short enough for a slip that ends in 1e-7 s.
TEST(ImEx, error_follows_the_tolerance) {
  for (const double drag : {0., 2., 1e2, 1e6}) {
    double last = 1e300;
    for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
      ArkodeSettings settings = with_drag();
      settings.velocity_tolerance = settings.displacement_tolerance = tolerance;
      const double error = error_with(settings, drag, 1);
      EXPECT_LT(error, 100 * tolerance) << "drag " << drag << ", tolerance " << tolerance;
      EXPECT_LT(error, last);
      last = error;
    }
  }
}

/// Largest velocity after 2000 steps of `share` of the stability limit.
double speed_after(double share, double pores, double drag) {
  WetSprings motion(1, pores, drag);
  ArkodeSettings settings = with_drag();
  settings.fraction = 1, settings.step = share * settings.rule().limit * 2 / motion.largest_frequency();
  for (int i = 0; i < 2 * WetSprings::count; ++i) motion.speed[i] = i % 3 - 1;
  Arkode integrator(settings);
  run_to(integrator, motion, 2 / motion.largest_frequency(), 2000 * settings.step);
  double largest = 0;
  for (double v : motion.speed) largest = std::max(largest, std::abs(v));
  return largest;
}

TEST(ImEx, is_stable_up_to_its_limit_for_any_drag) {
  for (const double pores : {0.1, 4., 1e3})
    for (const double drag : {0., 1e-2, 1., 1e2, 1e5})
      EXPECT_LT(speed_after(1, pores, drag), 10) << "pores " << pores << ", drag " << drag;
  EXPECT_GT(speed_after(1.03, 4, 0), 1e2);
}

TEST(Euler, takes_drag_implicitly) {
  for (const double drag : {2., 1e8}) {
    WetSprings motion(1, 4, drag);
    const Eigen::VectorXd exact = motion.exact(end);
    EulerSettings settings;
    settings.step = 0.01;
    Euler integrator(settings);
    run_to(integrator, motion, 2 / motion.largest_frequency(), end);
    EXPECT_LT(motion.error(exact), 0.02) << drag;
  }
}

/// Drag among the forces, from the velocities at the start of a step.
class DraggedFirst : public WetSprings {
 public:
  DraggedFirst(double skeleton, double pores, double drag) : WetSprings(skeleton, pores, 0), drag_(drag) {}
  PetscErrorCode acceleration(double t, const double *u, const double *v, double *a) override {
    WetSprings::acceleration(t, u, v, a);
    for (int i = 0; i < count; ++i) {
      const double force = drag_ * (v[count + i] - v[i]);
      a[i] += force / grains, a[count + i] -= force / water;
    }
    return 0;
  }

 private:
  double drag_;
};

// The formula is safe where waves and drag both matter, and sharp where one of them does (docs/theory/pores.md (6.1a)).
TEST(Euler, with_explicit_drag_holds_up_to_the_step_of_both_limits) {
  for (const double drag : {1e-3, 0.1, 1., 1e1, 1e3, 1e6}) {
    const auto speed = [&](double share) {
      DraggedFirst motion(1, 4, drag);
      for (int i = 0; i < motion.size(); ++i) motion.speed[i] = i % 3 - 1;
      EulerSettings settings;
      settings.step = share * with_explicit_drag(2 / motion.largest_frequency(),
                                                 drag * (1 / WetSprings::grains + 1 / WetSprings::water));
      Euler integrator(settings);
      run_to(integrator, motion, 1, 2000 * settings.step);
      double largest = 0;
      for (double v : motion.speed) largest = !(std::abs(v) < largest) ? std::abs(v) : largest;
      return largest;
    };
    EXPECT_LT(speed(0.999), 100) << drag;
    const bool alone = drag < 0.01 || drag > 5;
    EXPECT_FALSE(speed(alone ? 1.03 : 1.5) < 1e4) << drag;
  }
}

TEST(IntegratorSettings, that_cannot_follow_drag_say_so) {
  EXPECT_EQ(drag_problem(EulerSettings{}), "");
  EXPECT_EQ(drag_problem(with_drag()), "");
  ArkodeSettings fourth;
  fourth.order = 4;
  EXPECT_NE(drag_problem(fourth).find("order = 4"), std::string::npos);
  EXPECT_NE(drag_problem(ForwardEulerSettings{}), "");
  EXPECT_NE(drag_problem(PetscTsSettings{}), "");
}

}  // namespace
}  // namespace talus
