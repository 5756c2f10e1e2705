#include "solvers/quasi_static/strength_reduction.h"

#include <algorithm>
#include <cmath>

namespace talus {

Law without_softening(const Law &law) {
  return std::visit(
      [](auto one) -> Law {
        if constexpr (requires { one.shape_factor; }) one.shape_factor = 0;
        return one;
      },
      law);
}

PetscErrorCode follow_path(double step, double smallest,
                           const std::function<PetscErrorCode(double, double, StepOutcome *)> &advance,
                           const std::function<void(double, const StepOutcome &)> &done, double *share,
                           StepOutcome *outcome, int *iterations) {
  constexpr int quick = 6;
  PetscFunctionBeginUser;
  const double largest = step;
  *share = 0, *iterations = 0;
  while (*share < 1) {
    const double to = *share + step > 1 - 1e-9 ? 1 : *share + step;
    PetscCall(advance(*share, to, outcome));
    *iterations += outcome->iterations;
    if (!outcome->converged) {
      if (step / 2 < smallest) PetscFunctionReturn(0);
      step /= 2;
      continue;
    }
    *share = to;
    done(to, *outcome);
    if (outcome->iterations <= quick) step = std::min(largest, 2 * step);
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode reduce_strength(QuasiStatic<dim> &problem, const std::vector<Law> &laws, double factor, double load_time,
                               double time, double blow_up, double resolution,
                               const std::function<void(const StrengthTrial &)> &tell, FactorOfSafety *result) {
  constexpr double first_step = 0.2, smallest_share = 1. / 16, largest_factor = 20;
  PetscFunctionBeginUser;
  *result = {factor, 0, {}};
  problem.soil().reset_displacement();
  auto stable = problem.soil().save();
  while (result->upper == 0 ? result->lower < largest_factor : result->upper - result->lower > resolution) {
    const double trial = result->upper > 0 ? (result->lower + result->upper) / 2 : result->lower + first_step;
    problem.soil().restore(stable);
    for (size_t b = 0; b < laws.size(); ++b) problem.soil().points()[b].law = with_reduced_strength(laws[b], trial);
    problem.soil().admit();
    PetscCall(problem.begin_path(load_time));
    problem.blow_up = blow_up;
    double share;
    StepOutcome outcome;
    int iterations;
    PetscCall(follow_path(
        1, smallest_share,
        [&](double, double to, StepOutcome *o) { return problem.advance(to, load_time, time, 0, true, o); },
        [](double, const StepOutcome &) {}, &share, &outcome, &iterations));
    problem.blow_up = 0;
    const double displacement = problem.soil().largest_displacement();
    StrengthTrial t{trial, outcome.converged, iterations, outcome.residual, displacement, ""};
    if (t.stable && displacement > blow_up) t.stable = false;
    if (!t.stable)
      t.reason = outcome.blown_up || outcome.converged ? "displacement passed its limit"
                 : outcome.singular                    ? "stiffness became singular"
                                                       : "Newton's iterations did not converge";
    if (t.stable)
      result->lower = trial, stable = problem.soil().save();
    else
      result->upper = trial;
    result->trials.push_back(t);
    tell(t);
  }
  problem.soil().restore(stable);
  PetscFunctionReturn(0);
}

template PetscErrorCode reduce_strength(QuasiStatic<2> &, const std::vector<Law> &, double, double, double, double,
                                        double, const std::function<void(const StrengthTrial &)> &, FactorOfSafety *);
template PetscErrorCode reduce_strength(QuasiStatic<3> &, const std::vector<Law> &, double, double, double, double,
                                        double, const std::function<void(const StrengthTrial &)> &, FactorOfSafety *);

}  // namespace talus
