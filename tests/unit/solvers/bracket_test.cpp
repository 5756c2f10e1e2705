// Claims of bracket.h, for soil whose trials are known: it stands up to a limit, fails beyond, and between two factors
// the iterations find neither.
#include "solvers/quasi_static/bracket.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace talus {
namespace {

struct Soil {
  double limit;                            ///< factor of safety
  double open_from = 1e9, open_to = -1e9;  ///< trials between them are undecided
  std::vector<double> tried{};
  bool interrupted = false;

  FactorBracket bracket(double first = 1, int stop_after = 1000) {
    FactorBracket result;
    const TryFactor attempt = [&](double factor, TrialOutcome *outcome, bool *stop) -> PetscErrorCode {
      tried.push_back(factor);
      *outcome = open_from < factor && factor < open_to ? TrialOutcome::undecided
                 : factor <= limit                      ? TrialOutcome::equilibrium
                                                        : TrialOutcome::mechanism;
      *stop = static_cast<int>(tried.size()) == stop_after;
      return 0;
    };
    EXPECT_EQ(bracket_factor(first, 0, attempt, &result, &interrupted), 0);
    return result;
  }
};

void expect_narrow(const FactorBracket &b, double limit) {
  EXPECT_TRUE(b.decided);
  EXPECT_LE(b.lower, limit);
  EXPECT_GT(b.upper, limit);
  EXPECT_LE(b.upper - b.lower, bracket_width * b.upper);
}

/// Steps of 1.25 to the limit and bisection from 25 % to 0.5 % ask for 6 trials more than log(limit) / log(1.25).
TEST(Bracket, holds_the_limit_above_and_below_the_first_trial) {
  for (const double limit : {0.03, 0.5, 0.99, 1., 1.2345, 4., 15.}) {
    Soil soil{limit};
    expect_narrow(soil.bracket(), limit);
    EXPECT_LE(soil.tried.size(), 8 + std::abs(std::log(limit)) / std::log(1.25)) << limit;
    Soil started{limit};
    expect_narrow(started.bracket(1.01 * limit), limit);
  }
}

/// The limit lies among undecided trials: the bracket ends at them, on both sides as near as it would without them.
TEST(Bracket, stays_wide_around_undecided_trials_and_says_so) {
  Soil soil{1.5, 1.4, 1.7};
  const FactorBracket b = soil.bracket();
  EXPECT_FALSE(b.decided);
  EXPECT_LE(b.lower, 1.4);
  EXPECT_GE(b.lower, 1.4 * (1 - bracket_width));
  EXPECT_GE(b.upper, 1.7);
  EXPECT_LE(b.upper, 1.7 * (1 + 1.01 * bracket_width));
}

/// Undecided trials that turn out to lie outside of the bracket do not matter.
TEST(Bracket, forgets_undecided_trials_outside_of_it) {
  expect_narrow(Soil{3., 1.2, 1.3}.bracket(), 3);     // below, met on the way up
  expect_narrow(Soil{1.1, 1.2, 1.3}.bracket(), 1.1);  // above: the trial at 1.25
  expect_narrow(Soil{0.5, 0.7, 0.9}.bracket(), 0.5);  // above, met on the way down
}

TEST(Bracket, is_open_where_nothing_fails_or_nothing_stands) {
  const FactorBracket strong = Soil{1e9}.bracket(), weak = Soil{0}.bracket();
  EXPECT_EQ(strong.upper, 0);
  EXPECT_GT(strong.lower, largest_factor / 1.25);
  EXPECT_LT(strong.lower, largest_factor);
  EXPECT_EQ(weak.lower, 0);
  EXPECT_LT(weak.upper, smallest_factor * 1.25);
  EXPECT_GT(weak.upper, smallest_factor);
  EXPECT_TRUE(strong.decided && weak.decided);
}

/// Where no trial is decided there is no end at all, and the bracket does not pass for a decided one.
TEST(Bracket, without_any_decided_trial_is_not_decided) {
  const FactorBracket none = Soil{1, 0, 1e9}.bracket(), half = Soil{1.3, 1.2, 1e9}.bracket();
  EXPECT_FALSE(none.decided);
  EXPECT_EQ(none.lower, 0);
  EXPECT_EQ(none.upper, 0);
  EXPECT_FALSE(half.decided);
  EXPECT_EQ(half.upper, 0);
}

TEST(Bracket, ends_when_a_trial_is_interrupted) {
  Soil soil{2};
  soil.bracket(1, 3);
  EXPECT_TRUE(soil.interrupted);
  EXPECT_EQ(soil.tried.size(), 3u);
}

/// Soil that fails where strength falls by more than 3 % at once, whatever its limit: small steps come to the limit,
/// and the mechanisms of larger steps do not count.
TEST(Climb, holds_the_limit_of_small_steps) {
  for (const double ceiling : {0., 1.55}) {
    double stands = 1;
    const TryFactor attempt = [&](double factor, TrialOutcome *outcome, bool *) -> PetscErrorCode {
      const bool bears = factor <= 1.4 && factor <= 1.03 * stands;
      *outcome = bears ? TrialOutcome::equilibrium : TrialOutcome::mechanism;
      if (bears) stands = std::max(stands, factor);
      return 0;
    };
    FactorBracket result;
    bool interrupted;
    EXPECT_EQ(climb_to_factor({1}, ceiling, attempt, &result, &interrupted), 0);
    expect_narrow(result, 1.4);
  }
}

/// Nothing fails below the ceiling, which is a mechanism by itself.
TEST(Climb, ends_at_the_ceiling) {
  const TryFactor attempt = [](double, TrialOutcome *outcome, bool *) -> PetscErrorCode {
    *outcome = TrialOutcome::equilibrium;
    return 0;
  };
  FactorBracket result;
  bool interrupted;
  EXPECT_EQ(climb_to_factor({1, 1.2}, 1.25, attempt, &result, &interrupted), 0);
  EXPECT_EQ(result.upper, 1.25);
  expect_narrow(result, result.lower);
}

}  // namespace
}  // namespace talus
