// The two Euler methods on masses and springs: first order both, but only the one that updates velocity first keeps the
// energy.
#include <gtest/gtest.h>

#include "solvers/critical_step.h"
#include "solvers/integrators.h"
#include "springs.h"

namespace talus {
namespace {

template <class Settings>
double error_at(double step) {
  Springs motion(1, 0.5);
  motion.place = {1};
  Settings settings;
  settings.step = step;
  run_to(*settings.make(), motion, 2, 5);
  return std::hypot(motion.place[0] - std::cos(5), motion.speed[0] + std::sin(5));
}

TEST(Euler, is_of_first_order) { EXPECT_NEAR(error_at<EulerSettings>(0.01) / error_at<EulerSettings>(0.005), 2, 0.05); }
TEST(ForwardEuler, is_of_first_order) {
  EXPECT_NEAR(error_at<ForwardEulerSettings>(0.01) / error_at<ForwardEulerSettings>(0.005), 2, 0.05);
}

/// Largest energy over the initial in 1000 periods of omega = 1.
template <class Settings>
double energy_after(double step, int steps) {
  Springs motion(1, 0.5);
  motion.place = {1};
  const double start = motion.energy();
  Settings settings;
  settings.step = step;
  run_to(*settings.make(), motion, 2, steps * step);
  return motion.energy() / start;
}

TEST(Euler, keeps_the_energy_for_1000_periods) { EXPECT_NEAR(energy_after<EulerSettings>(0.1, 62832), 1, 0.1); }
TEST(Euler, grows_beyond_the_critical_step) {
  EXPECT_LT(energy_after<EulerSettings>(1.98, 1000), 200);
  EXPECT_GT(energy_after<EulerSettings>(2.02, 1000), 1e6);
}
/// A mass on springs, omega = 1, damped by the rate of their force: the energy after 1000 steps over the initial.
double damped_energy_after(double ratio, double share) {
  Springs motion(1, 0.5);
  motion.place = {1}, motion.beta = 2 * ratio;
  const double start = motion.energy();
  EulerSettings settings;
  settings.step = share * with_explicit_drag(2, motion.beta);
  run_to(*settings.make(), motion, 2, 1000 * settings.step);
  return motion.energy() / start;
}
TEST(Euler, is_stable_under_damping_just_up_to_its_bound) {
  for (const double ratio : {0.01, 0.05, 0.5, 1., 4., 30.}) {
    EXPECT_LT(damped_energy_after(ratio, 0.99), 1) << ratio;
    EXPECT_GT(damped_energy_after(ratio, 1.01), 1e3) << ratio;
    EXPECT_NEAR(with_explicit_drag(2, 2 * ratio), 2 * (std::sqrt(1 + ratio * ratio) - ratio), 1e-14);
  }
}
TEST(ForwardEuler, gains_energy_by_omega_squared_h_squared_in_every_step) {
  EXPECT_NEAR(energy_after<ForwardEulerSettings>(0.1, 500) / std::pow(1.01, 500), 1, 1e-9);
}

}  // namespace
}  // namespace talus
