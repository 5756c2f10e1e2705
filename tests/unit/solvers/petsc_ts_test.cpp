// PETSc's Runge-Kutta methods behind the Motion interface, on masses and springs.
#include "solvers/petsc_ts.h"

#include <gtest/gtest.h>

#include "springs.h"

namespace talus {
namespace {

constexpr std::pair<RungeKutta, int> methods[] = {
    {RungeKutta::rk3, 3}, {RungeKutta::rk4, 4}, {RungeKutta::rk5, 5}, {RungeKutta::rk8, 8}};

double error_with(RungeKutta method, double step) {
  Springs motion(1, 0.5);
  motion.place = {1};
  motion.force = [](double t) { return std::sin(t / 2); };
  PetscTsSettings settings;
  settings.method = method, settings.step = step;
  PetscTs integrator(settings);
  run_to(integrator, motion, 2, 10);
  const double t = 10, x = std::cos(t) + 4. / 3 * std::sin(t / 2) - 2. / 3 * std::sin(t),
               v = -std::sin(t) + 2. / 3 * (std::cos(t / 2) - std::cos(t));
  return std::hypot(motion.place[0] - x, motion.speed[0] - v);
}

TEST(PetscTs, has_the_order_of_its_method) {
  for (const auto &[method, order] : methods) {
    const double step = order == 8 ? 1 : 0.2;
    EXPECT_NEAR(std::log2(error_with(method, step) / error_with(method, step / 4)) / 2, order, 0.3)
        << "order " << order;
  }
}

double growth(RungeKutta method, double share) {
  Springs motion(20, 1);
  for (int i = 0; i < 20; ++i) motion.speed[i] = std::sin(M_PI * 20 * (i + 1) / 21);
  const double start = motion.energy();
  PetscTsSettings settings;
  settings.method = method, settings.step = share * settings.rule().limit * 2 / motion.largest_frequency();
  PetscTs integrator(settings);
  run_to(integrator, motion, 2 / motion.largest_frequency(), 400 * settings.step);
  return motion.energy() / start;
}

TEST(PetscTs, stability_limits_are_known_within_3_percent) {
  for (const auto &[method, order] : methods) {
    EXPECT_LE(growth(method, 0.97), 1 + 1e-9) << "order " << order;
    EXPECT_GT(growth(method, 1.03), 1.01) << "order " << order;
  }
}

}  // namespace
}  // namespace talus
