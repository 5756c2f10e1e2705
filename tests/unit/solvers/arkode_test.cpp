// ARKODE behind the Motion interface, on masses and springs whose motion is known.
#include <gtest/gtest.h>

#include <algorithm>

#include "solvers/critical_step.h"
#include "solvers/integrators.h"
#include "springs.h"

namespace talus {
namespace {

/// Error of place and velocity of a mass of 1 kg on springs of omega = 1 under a force sin(t / 2), at t = 10.
double error_with(ArkodeSettings settings) {
  Springs motion(1, 0.5);
  motion.force = [](double t) { return std::sin(t / 2); };
  motion.place = {1};
  Arkode integrator(settings);
  run_to(integrator, motion, 2, 10);
  // x = cos t + (4/3) sin(t / 2) - (2/3) sin t
  const double t = 10, x = std::cos(t) + 4. / 3 * std::sin(t / 2) - 2. / 3 * std::sin(t),
               v = -std::sin(t) + 2. / 3 * (std::cos(t / 2) - std::cos(t));
  return std::hypot(motion.place[0] - x, motion.speed[0] - v);
}

TEST(Arkode, has_the_order_it_is_asked_for) {
  for (int order = 2; order <= 5; ++order) {
    ArkodeSettings settings;
    settings.order = order;
    double errors[3];
    for (int k = 0; k < 3; ++k) settings.step = 0.1 / (1 << k), errors[k] = error_with(settings);
    const double observed = std::log2(errors[0] / errors[2]) / 2;
    EXPECT_NEAR(observed, order, 0.25) << "order " << order;  // two halvings from omega h = 0.1
  }
}

TEST(Arkode, error_follows_the_tolerance) {
  for (int order = 2; order <= 5; ++order) {
    double last = 1e300;
    for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
      ArkodeSettings settings;
      settings.order = order, settings.velocity_tolerance = settings.displacement_tolerance = tolerance;
      const double error = error_with(settings);
      EXPECT_LT(error, 100 * tolerance) << "order " << order;  // some hundred steps at most, each with its error
      EXPECT_LT(error, last);
      last = error;
    }
  }
}

/// The error of the embedded method, of order p, is of order p + 1 in the step. Where it is the same all along (the
/// (p + 1)-th derivative of the velocity is constant), the step that meets the tolerance is found from a single other
/// one.
TEST(Arkode, finds_the_step_of_its_tolerance_at_once) {
  for (const int order : {3, 4}) {
    Springs motion(1, 0);
    motion.force = [&](double t) { return std::pow(t, order - 1); };
    ArkodeSettings settings;
    settings.order = order, settings.velocity_tolerance = 1e-4, settings.displacement_tolerance = 1e3;
    Arkode integrator(settings);
    double t = 0, steps[12];
    for (double &taken : steps) {
      ASSERT_EQ(integrator.advance(motion, t, {1e3, 1e6}, &taken), 0);
      t += taken;
    }
    const int first = static_cast<int>(std::find_if(steps, steps + 11,
                                                    [&](double &h) {
                                                      return (&h)[1] < 4.9 * h;  // steps grow fivefold at most
                                                    }) -
                                       steps);
    ASSERT_LT(first, 9);
    EXPECT_NEAR(steps[first + 1] / steps[11], 1, 1e-3) << "order " << order;
  }
}

/// Energy of a chain of 20 masses in its fastest mode after 400 steps of `share` of the stability limit, over the
/// initial.
double growth(int order, double share) {
  Springs motion(20, 1);
  for (int i = 0; i < 20; ++i) motion.speed[i] = std::sin(M_PI * 20 * (i + 1) / 21);
  const double start = motion.energy();
  ArkodeSettings settings;
  settings.order = order, settings.fraction = 1;
  const double step = share * settings.rule().limit * 2 / motion.largest_frequency();
  settings.step = step;
  Arkode integrator(settings);
  run_to(integrator, motion, 2 / motion.largest_frequency(), 400 * step);
  return motion.energy() / start;
}

TEST(Arkode, stability_limit_of_each_order_is_known_within_3_percent) {
  for (int order = 2; order <= 5; ++order) {
    EXPECT_LE(growth(order, 0.97), 1 + 1e-9) << "order " << order;
    EXPECT_GT(growth(order, 1.03), 1.01) << "order " << order;
  }
}

/// Under damping by the rate of stress the bound of Euler's method is that of the other methods too, over their limits:
/// in the left half plane their regions of stability hold a half circle through these.
TEST(Arkode, is_stable_under_damping_by_the_rate_of_stress) {
  for (int order = 2; order <= 5; ++order)
    for (const double ratio : {0.05, 0.5, 1., 4., 30.}) {
      Springs motion(20, 1);
      for (int i = 0; i < 20; ++i) motion.speed[i] = std::sin(M_PI * 20 * (i + 1) / 21);
      const double start = motion.energy(), omega = motion.largest_frequency();
      motion.beta = 2 * ratio / omega;
      ArkodeSettings settings;
      settings.order = order, settings.fraction = 1;
      const double critical = with_explicit_drag(2 / omega, motion.beta * omega * omega);
      settings.step = 0.97 * settings.rule().limit * critical;
      Arkode integrator(settings);
      run_to(integrator, motion, critical, 400 * settings.step);
      EXPECT_LE(motion.energy() / start, 1 + 1e-9) << "order " << order << ", ratio " << ratio;
    }
}

TEST(Arkode, never_passes_the_stability_limit_however_loose_the_tolerance) {
  Springs motion(20, 1);
  for (int i = 0; i < 20; ++i) motion.speed[i] = (i % 3) - 1;
  const double start = motion.energy(), critical = 2 / motion.largest_frequency();
  ArkodeSettings settings;
  settings.velocity_tolerance = settings.displacement_tolerance = 100;
  Arkode integrator(settings);
  run_to(integrator, motion, critical, 400);
  EXPECT_LE(integrator.statistics().longest, settings.fraction * settings.rule().limit * critical * (1 + 1e-12));
  EXPECT_LE(motion.energy(), start);
  EXPECT_GT(integrator.statistics().by_stability, 0.9 * integrator.statistics().steps);
}

TEST(Arkode, accepts_once_a_step_and_counts_what_it_does) {
  Springs motion(1, 0.5);
  motion.place = {1};
  motion.force = [](double t) { return t < 5 ? 0 : 10.; };  // a load at once: steps have to shrink
  ArkodeSettings settings;
  settings.velocity_tolerance = settings.displacement_tolerance = 1e-5, settings.floor = 1e-8;
  Arkode integrator(settings);
  const int steps = run_to(integrator, motion, 2, 10);
  EXPECT_EQ(integrator.statistics().steps, steps);
  EXPECT_EQ(motion.accepted, steps);
  EXPECT_EQ(integrator.statistics().evaluations, motion.evaluations);
  EXPECT_GT(integrator.statistics().rejections, 0);
}

TEST(Arkode, keeps_its_step_through_a_restart) {
  Springs motion(1, 0.5);
  motion.place = {1};
  ArkodeSettings settings;
  settings.velocity_tolerance = settings.displacement_tolerance = 1e-6;
  Arkode integrator(settings);
  double t = 0, taken = 0, before = 0;
  for (int i = 0; i < 40; ++i) {
    before = taken;
    if (i % 2) integrator.restart();
    ASSERT_EQ(integrator.advance(motion, t, {2, 1e3}, &taken), 0);
    t += taken;
    if (i > 20) {
      EXPECT_GT(taken, 0.5 * before);
    }
  }
  EXPECT_NEAR(motion.place[0], std::cos(t), 1e-4);
}

TEST(Arkode, stops_at_its_floor_and_says_why) {
  Springs motion(1, 0.5);
  motion.place = {1};
  ArkodeSettings settings;
  settings.velocity_tolerance = 1e-12, settings.floor = 0.1;
  Arkode integrator(settings);
  run_to(integrator, motion, 2, 10);
  EXPECT_NE(integrator.obstacle().find("velocity_tolerance"), std::string::npos);
  EXPECT_EQ(integrator.obstructing_component(), 0);
}

}  // namespace
}  // namespace talus
