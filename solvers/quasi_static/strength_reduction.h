#pragma once
/// Factor of safety by strength reduction (Zienkiewicz, Humpheson & Lewis 1975, Geotechnique 25; Griffiths & Lane 1999,
/// Geotechnique 49): the number by which strength has to be divided for equilibrium to be lost.
/// Docs/theory/finite_elements.md, section 5.
#include <functional>

#include "solvers/quasi_static/factor_of_safety.h"
#include "solvers/quasi_static/quasi_static.h"

namespace talus {

/// Carries a path from share 0 to 1 in load steps of at most `step`, halved where they fail and doubled after quick
/// ones; `done` is told of each. `decide`, where it is given, is asked once, after the first step that failed: it may
/// find the equilibrium at the end of the path, or that the soil fails there. Returns the outcome of the last step and,
/// in `share`, how far it came.
PetscErrorCode follow_path(double step, double smallest,
                           const std::function<PetscErrorCode(double from, double to, StepOutcome *)> &advance,
                           const std::function<PetscErrorCode(StepOutcome *)> &decide,
                           const std::function<void(double share, const StepOutcome &)> &done, double *share,
                           StepOutcome *outcome, int *iterations);

/// Says in `outcome` whether soil with its present strength fails under the loads of `load_time`. It is given psi =
/// phi, with which no soil bears less than with its own psi (Radenkovic 1961), so that soil that fails has no
/// equilibrium. The problem keeps its state.
template <int dim>
PetscErrorCode find_failure(QuasiStatic<dim> &problem, const std::vector<Law> &laws, double load_time, double time,
                            StepOutcome *outcome);

/// Lets the soil creep to an equilibrium under the loads of `load_time` at `share` of the path, where Newton's
/// iterations went astray. The problem is left in the equilibrium if there is one, else in the state before.
template <int dim>
PetscErrorCode creep_to(QuasiStatic<dim> &problem, double share, double load_time, double time, double tolerance,
                        StepOutcome *outcome);

/// The same under all loads; or else, with psi = phi, by the search of a strength reduction, which sets `dilated`: the
/// strength of such soil is the same, so that it bears the stress that is found. `fails` says that it fails even so.
template <int dim>
PetscErrorCode settle(QuasiStatic<dim> &problem, const std::vector<Law> &laws, double load_time, double time,
                      double tolerance, bool *dilated, StepOutcome *outcome);

/// What a strength reduction needs of its surroundings.
template <int dim>
struct ReductionSettings {
  double load_time = 0, time = 0;       ///< of the loads and of prescribed motions [s]
  std::vector<char> kept;               ///< [body] its strength is not divided; empty: all are
  double shown_displacement = 0;        ///< largest displacement to which the mechanism is scaled at the end [m]
  int mechanisms = 1;                   ///< that are searched for
  bool stands = true;                   ///< the stages before ended in equilibrium
  bool by_own_flow = true;              ///< and soil moved there with its own dilation, not with psi = phi
  bool by_damped_motion = true;         ///< where iterations stall; otherwise soil with psi < phi fails there
  const PoreFlow<dim> *flow = nullptr;  ///< of pore water that moves, for a factor without flow too; null: none does
  /// Is strength divided at this place, in an element of this size [m]? Empty: everywhere.
  std::function<bool(const Vec<dim> &, double)> divided;
  /// Pressure of water in a crack at this place [Pa], negative where no crack reaches. Empty: there are none.
  std::function<double(const Vec<dim> &)> crack;
  std::function<void(bool any)> tell_cracked;       ///< before the trials, if `crack`: does any soil lie there?
  std::function<void(double share)> tell_confined;  ///< before the trials, if `divided`: in which share of the soil
  std::function<void(const StrengthTrial &)> tell;  ///< after each trial
  /// A search found the shoulder of a mechanism, counted from 1: a share of its shear follows the soil that is held.
  std::function<void(const FactorBracket &, int of, double beside)> tell_shoulder;
};

/// Brackets the factor from the present state of the problem by equilibria and mechanisms, until the bracket is
/// narrower than `bracket_width` of the factor; if some soil has psi < phi also by the flows that bound it, and where
/// pore water moves also without flow: the lower one is the factor. Further
/// mechanisms are searched for with the soil of those before held at its strength, finite_elements.md section 5.1;
/// there may be fewer than asked for. The problem is left in the state of the largest factor that has an equilibrium,
/// moved along the critical mechanism so far that it shows. A bracket may be open on one side, see bracket.h.
/// `interrupted` is set if the search was stopped.
template <int dim>
PetscErrorCode reduce_strength(QuasiStatic<dim> &problem, const std::vector<Law> &laws,
                               const ReductionSettings<dim> &settings, FactorOfSafety *result, bool *interrupted);

}  // namespace talus
