#pragma once
/// Factor of safety by strength reduction (Zienkiewicz, Humpheson & Lewis 1975, Geotechnique 25; Griffiths & Lane 1999,
/// Geotechnique 49): the number by which strength has to be divided for equilibrium to be lost.
/// Docs/theory/finite_elements.md, section 5.
#include <functional>

#include "solvers/quasi_static/factor_of_safety.h"
#include "solvers/quasi_static/quasi_static.h"

namespace talus {

/// The law at its peak strength for good: for stages whose soil does not soften.
Law without_softening(const Law &law);

/// Carries a path from share 0 to 1 in load steps of at most `step`, halved where they fail and doubled after quick
/// ones; `done` is told of each. Returns the outcome of the last step and, in `share`, how far it came.
PetscErrorCode follow_path(double step, double smallest,
                           const std::function<PetscErrorCode(double from, double to, StepOutcome *)> &advance,
                           const std::function<void(double share, const StepOutcome &)> &done, double *share,
                           StepOutcome *outcome, int *iterations);

/// Bisection from a state that is in equilibrium with strength divided by `factor`. Each trial starts from the last
/// stable state; it fails if Newton's iterations do not converge down to a sixteenth of the change of strength, or if a
/// node moves more than `blow_up` since the start. Ends when the bracket is narrower than `resolution`, or, without an
/// upper end, beyond a factor of 20.
template <int dim>
PetscErrorCode reduce_strength(QuasiStatic<dim> &problem, const std::vector<Law> &laws, double factor, double load_time,
                               double time, double blow_up, double resolution,
                               const std::function<void(const StrengthTrial &)> &tell, FactorOfSafety *result);

}  // namespace talus
