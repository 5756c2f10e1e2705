#pragma once
/// Factor of safety by strength reduction (Zienkiewicz, Humpheson & Lewis 1975, Geotechnique 25; Griffiths & Lane 1999,
/// Geotechnique 49): the number by which strength has to be divided for equilibrium to be lost.
/// Docs/theory/finite_elements.md, section 5.
#include <functional>

#include "physics/laws/strength_by_place.h"
#include "solvers/quasi_static/factor_of_safety.h"
#include "solvers/quasi_static/quasi_static.h"

namespace talus {

/// The law at its peak strength for good: for stages whose soil does not soften.
Law without_softening(const Law &law);

/// Has the law a friction angle above its dilation angle?
bool non_associated(const Law &law);

/// The law with its strength divided by `factor` and then with associated flow (psi = phi), which makes its limit load
/// unique. With `dilating` cohesion and friction stay as they are. Else soil with psi < phi gets the strength that it
/// has along a plane on which it slips (Davis 1968): c and tan(phi) times
/// cos(psi) cos(phi) / (1 - sin(psi) sin(phi)). Soil that softens has the strength that its accepted plastic strain has
/// left it, counted in a unit in which a trial adds nothing.
Law strength_of_trial(const Law &law, double factor, bool dilating);

/// Shares that points with the shares `own` of the law's strength have of `strength_of_trial(law, ...)`: they get the
/// strength of a trial of soil whose own strength is that of their place. Exact for c and phi at their peak; what
/// suction adds, and residual values, are reduced as where the law's c and phi are largest.
StrengthShares shares_of_trial(const Law &law, const StrengthShares &own, double factor, bool dilating);

/// Carries a path from share 0 to 1 in load steps of at most `step`, halved where they fail and doubled after quick
/// ones; `done` is told of each. Returns the outcome of the last step and, in `share`, how far it came.
PetscErrorCode follow_path(double step, double smallest,
                           const std::function<PetscErrorCode(double from, double to, StepOutcome *)> &advance,
                           const std::function<void(double share, const StepOutcome &)> &done, double *share,
                           StepOutcome *outcome, int *iterations);

/// What a strength reduction needs of its surroundings.
struct ReductionSettings {
  double load_time = 0, time = 0;  ///< of the loads and of prescribed motions [s]
  double shown_displacement = 0;   ///< largest displacement to which the mechanism is scaled at the end [m]
  std::function<void(const StrengthTrial &)> tell;  ///< after each trial
};

/// Brackets the factor from the present state of the problem by equilibria and mechanisms, until the bracket is
/// narrower than `bracket_width` of the factor, and if some soil has psi < phi a second time with psi = phi. The
/// problem is left in the state of the largest factor that has an equilibrium, moved along the mechanism so far that it
/// shows. A bracket may be open on one side, see bracket.h. `interrupted` is set if the search was stopped.
template <int dim>
PetscErrorCode reduce_strength(QuasiStatic<dim> &problem, const std::vector<Law> &laws,
                               const ReductionSettings &settings, FactorOfSafety *result, bool *interrupted);

}  // namespace talus
