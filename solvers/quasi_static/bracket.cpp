#include "solvers/quasi_static/bracket.h"

#include <algorithm>
#include <cmath>

namespace talus {

bool narrow(double lower, double upper) { return upper - lower <= bracket_width * upper; }

namespace {

class Search {
 public:
  FactorBracket bracket;

  void learn(double factor, TrialOutcome outcome) {
    FactorBracket &b = bracket;
    if (outcome == TrialOutcome::equilibrium)
      b.lower = std::max(b.lower, factor);
    else if (outcome == TrialOutcome::mechanism)
      b.upper = b.upper > 0 ? std::min(b.upper, factor) : factor;
    else
      least_open_ = open() ? std::min(least_open_, factor) : factor, most_open_ = std::max(most_open_, factor);
    if (b.upper > 0 && b.lower > b.upper) b.lower = b.upper;  // both within the tolerance of equilibrium
    // undecided trials outside of the bracket do not matter any more
    if (open() && (most_open_ <= b.lower || (b.upper > 0 && least_open_ >= b.upper))) least_open_ = most_open_ = 0;
    b.decided = !open();
  }

  bool open_to(double factor) const { return factor > bracket.lower && (bracket.upper == 0 || factor < bracket.upper); }
  /// The factor of the next trial; 0 if there is none.
  double next() const {
    constexpr double stride = 1.25;  // of the factor until it is bracketed
    const FactorBracket &b = bracket;
    const double above = open() ? most_open_ : b.lower, below = open() ? least_open_ : b.upper;
    if (b.upper == 0) {
      const double top = std::max(above, b.lower) * stride;
      return top < largest_factor ? top : 0;
    }
    if (b.lower == 0) {
      const double bottom = below / stride;
      return bottom > smallest_factor ? bottom : 0;
    }
    if (!narrow(b.lower, below)) return std::sqrt(b.lower * below);
    if (open() && !narrow(above, b.upper)) return std::sqrt(above * b.upper);
    return 0;
  }

 private:
  bool open() const { return most_open_ > 0; }
  double least_open_ = 0, most_open_ = 0;  ///< factors of undecided trials in the bracket; 0 if there are none
};

}  // namespace

PetscErrorCode bracket_factor(double first, double ceiling, const TryFactor &attempt, FactorBracket *result,
                              bool *interrupted) {
  PetscFunctionBeginUser;
  Search search;
  search.bracket.upper = ceiling, *interrupted = false;
  for (double factor = first; factor > 0; factor = search.next()) {
    TrialOutcome outcome;
    PetscCall(attempt(factor, &outcome, interrupted));
    if (*interrupted) break;
    search.learn(factor, outcome);
  }
  *result = search.bracket;
  PetscFunctionReturn(0);
}

PetscErrorCode climb_to_factor(const std::vector<double> &first, double ceiling, const TryFactor &attempt,
                               FactorBracket *result, bool *interrupted) {
  constexpr double largest_step = 0.05, stride = 1.25;  // of the factor, up and down
  PetscFunctionBeginUser;
  FactorBracket b;
  b.upper = ceiling, *interrupted = false;
  double step = largest_step, to = first[0];
  for (size_t given = 1; to > smallest_factor && to < largest_factor;) {
    TrialOutcome outcome;
    PetscCall(attempt(to, &outcome, interrupted));
    if (*interrupted) break;
    if (outcome == TrialOutcome::equilibrium) {
      b.lower = to, step = std::min(largest_step, 2 * step);
    } else {
      given = first.size();
      if (b.lower > 0 && narrow(b.lower, to)) {
        b.decided = outcome == TrialOutcome::mechanism;
        if (b.decided) b.upper = to;
        break;
      }
      step = b.lower > 0 ? (to / b.lower - 1) / 2 : step;
    }
    if (b.lower == 0) {
      to = to / stride;
    } else if (given < first.size()) {
      to = first[given++];
    } else {
      to = b.lower * (1 + step);
      if (ceiling > 0 && to >= ceiling) {
        if (narrow(b.lower, ceiling)) break;
        to = std::sqrt(b.lower * ceiling);
      }
    }
  }
  *result = b;
  PetscFunctionReturn(0);
}

}  // namespace talus
