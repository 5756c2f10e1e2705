// Every integrator keeps the contract of Motion: boundaries exactly once a step, at its end and over all of it, then
// the mapped velocity at most once, then the accepted state.
#include <gtest/gtest.h>

#include <string>

#include "solvers/integrators.h"
#include "wet_springs.h"

namespace talus {
namespace {

/// Notes what an integrator asks for, and when.
class Recorder : public WetSprings {
 public:
  struct Call {
    std::string what;
    double time, step;
  };
  Recorder() : WetSprings(1, 4, 1) {}
  std::vector<Call> calls;
  double latest_evaluation = 0;

  PetscErrorCode acceleration(double t, const double *u, const double *v, double *a) override {
    latest_evaluation = std::max(latest_evaluation, t);
    return WetSprings::acceleration(t, u, v, a);
  }
  PetscErrorCode apply_boundaries_and_drag(double t, double gamma, double *v) override {
    calls.push_back({"boundaries and drag", t, gamma});
    return WetSprings::apply_drag(t, gamma, v);
  }
  PetscErrorCode apply_boundaries(double t, double gamma, double *) override {
    calls.push_back({"boundaries", t, gamma});
    return 0;
  }
  PetscErrorCode map_back(double t, double gamma, double *v, double *w) override {
    calls.push_back({"map back", t, gamma});
    return WetSprings::map_back(t, gamma, v, w);
  }
  PetscErrorCode accept(double t, const double *u, const double *v) override {
    calls.push_back({"accept", t, 0});
    return WetSprings::accept(t, u, v);
  }
};

void expect_contract(const IntegratorSettings &settings, const std::vector<std::string> &order) {
  Recorder motion;
  const auto integrator = make_integrator(settings);
  double t = 0;
  for (int step = 0; step < 3; ++step) {
    motion.calls.clear();
    double taken = 0;
    ASSERT_EQ(integrator->advance(motion, t, {2 / motion.largest_frequency(), 100}, &taken), 0);
    ASSERT_GT(taken, 0);
    ASSERT_EQ(motion.calls.size(), order.size());
    for (size_t k = 0; k < order.size(); ++k) {
      const Recorder::Call &call = motion.calls[k];
      EXPECT_EQ(call.what, order[k]);
      EXPECT_NEAR(call.time, t + taken, 1e-12) << call.what << " is asked for at the end of the step";
      if (call.what != "accept") {
        EXPECT_NEAR(call.step, taken, 1e-12) << call.what;
      }
    }
    t += taken;
    EXPECT_LE(motion.latest_evaluation, t * (1 + 1e-12)) << "no force of a time beyond the step";
  }
}

TEST(Contract, euler) { expect_contract(EulerSettings{}, {"boundaries and drag", "map back", "accept"}); }
TEST(Contract, forward_euler) { expect_contract(ForwardEulerSettings{}, {"boundaries and drag", "accept"}); }
TEST(Contract, petsc) { expect_contract(PetscTsSettings{}, {"boundaries and drag", "accept"}); }
TEST(Contract, arkode) {
  for (int order = 2; order <= 5; ++order) {
    ArkodeSettings settings;
    settings.order = order, settings.step = 0.01;
    expect_contract(settings, {"boundaries and drag", "accept"});
  }
}
TEST(Contract, arkode_with_drag) {
  ArkodeSettings settings;
  settings.drag = true, settings.step = 0.01;
  expect_contract(settings, {"boundaries", "accept"});
}

}  // namespace
}  // namespace talus
