// Claims of solvers/quasi_static/strength_reduction.h about paths of loads.
#include <gtest/gtest.h>

#include "solvers/quasi_static/strength_reduction.h"

namespace talus {
namespace {

struct Walk {
  int failed = 0, asked = 0;  ///< steps that found no equilibrium, and questions whether the soil fails
  double share = 0;
  StepOutcome last;
};

/// Soil that bears a share of 0.5 of the loads.
Walk walk(bool ask, bool fails) {
  Walk walk;
  int iterations;
  const auto advance = [&](double, double to, StepOutcome *outcome) -> PetscErrorCode {
    *outcome = {};
    outcome->converged = to <= 0.5 + 1e-12, outcome->iterations = 3;
    walk.failed += !outcome->converged;
    return 0;
  };
  std::function<PetscErrorCode(StepOutcome *)> decide;
  if (ask)
    decide = [&](StepOutcome *outcome) -> PetscErrorCode {
      ++walk.asked, outcome->fails = fails;
      return 0;
    };
  const auto done = [](double, const StepOutcome &) {};
  EXPECT_EQ(follow_path(0.25, 1e-3, advance, decide, done, &walk.share, &walk.last, &iterations), 0);
  return walk;
}

/// Halves of 0.25 that are not below 0.001: the first step and seven smaller ones.
TEST(Path, TriesSmallStepsUnlessTheSoilFails) {
  const Walk alone = walk(false, false), undecided = walk(true, false), failing = walk(true, true);
  EXPECT_EQ(alone.failed, 8);
  EXPECT_EQ(undecided.failed, alone.failed);
  EXPECT_EQ(undecided.asked, 1);
  EXPECT_FALSE(undecided.last.fails);
  EXPECT_EQ(failing.failed, 1);
  EXPECT_EQ(failing.asked, 1);
  EXPECT_TRUE(failing.last.fails);
  for (const Walk &one : {alone, undecided, failing}) EXPECT_DOUBLE_EQ(one.share, 0.5);
}

}  // namespace
}  // namespace talus
