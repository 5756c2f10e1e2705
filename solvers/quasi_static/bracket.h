#pragma once
/// The search for a factor of safety: which strength to try next, docs/theory/finite_elements.md section 5.
#include <petscsys.h>

#include <functional>
#include <vector>

#include "solvers/quasi_static/factor_of_safety.h"

namespace talus {

/// One trial: what soil does whose strength is divided by `factor`; `interrupted` ends the search.
using TryFactor = std::function<PetscErrorCode(double factor, TrialOutcome *outcome, bool *interrupted)>;

/// Brackets the factor by an equilibrium and a mechanism until the bracket is narrower than `bracket_width` of the
/// factor; the first trial divides strength by `first`, and `ceiling` is known to be a mechanism, 0 if none is. Trials
/// that are undecided leave the bracket wider, then
/// `decided` is false. `result` has lower = 0 if no trial down to `smallest_factor` found an equilibrium, and upper = 0
/// if none up to `largest_factor` found a mechanism.
PetscErrorCode bracket_factor(double first, double ceiling, const TryFactor &attempt, FactorBracket *result,
                              bool *interrupted);
constexpr double bracket_width = 0.005, smallest_factor = 0.02, largest_factor = 20;

/// Is this bracket as narrow as was asked for?
bool narrow(double lower, double upper);

/// The same for soil whose failure depends on its way there (psi < phi): the factor grows in steps from the last
/// equilibrium, which are halved where they fail and doubled where they do not. Only a mechanism of a `narrow` step
/// counts.
/// `first`, in ascending order, are the first trials; a mechanism is known at `ceiling`, 0 if there is none.
PetscErrorCode climb_to_factor(const std::vector<double> &first, double ceiling, const TryFactor &attempt,
                               FactorBracket *result, bool *interrupted);

}  // namespace talus
