/// Creep of the soil, docs/theory/finite_elements.md section 3.
#include <algorithm>

#include "solvers/quasi_static/limit_state.h"

namespace talus {

/// Implicit steps of a motion in which the elastic prop is a dashpot: 1 / prop is the time that a step takes. It grows
/// where the step was easy, and becomes less where it was not.
template <int dim>
PetscErrorCode LimitState<dim>::creep(double small, LimitSearch *result) {
  constexpr double first_prop = 0.1, softest = 1e-9, stiffest = 10;
  constexpr double of_prop = 0.5;   // out of balance at the end of a step, over the force of the prop
  constexpr double growth = 3.162;  // of the prop, for a step that is easier or harder
  constexpr int most_iterations = 100, most_per_step = 12, easy = 6, easiest = 2;
  constexpr double lasting = 0.75;  // of the force out of balance, while the soil goes twice as far: it fails
  PetscFunctionBeginUser;
  *result = {};
  const auto before = problem_.save();
  PetscCall(choose_solver());
  Vector way;
  PetscCall(VecDuplicate(x_, way.create()));
  PetscCall(VecZeroEntries(way));
  PetscCall(problem_.prepare(share_, load_time_, time_, 0, x_));
  PetscCall(problem_.residual(x_, force_));
  problem_.close_scale();
  prop_ = first_prop;
  while (result->iterations < most_iterations && prop_ < stiffest) {
    bool settled;
    const int iterations = result->iterations;
    PetscCall(VecZeroEntries(x_));
    PetscCall(settle(most_per_step, of_prop, small / 2, result, &settled));
    if (stop_asked()) {
      result->verdict = LimitVerdict::interrupted;
      break;
    }
    if (!settled) {
      prop_ *= growth * growth;
      continue;
    }
    PetscCall(problem_.commit(x_, false));
    PetscCall(VecAXPY(way, 1, x_));
    result->residual = (residual_ + prop_force_) / problem_.force_scale();
    PetscCall(VecNorm(way, NORM_INFINITY, &result->displacement));
    auto &curve = result->curve;
    curve.emplace_back(result->displacement, result->residual);
    if (result->residual <= small) {
      result->verdict = LimitVerdict::equilibrium;
      break;
    }
    const auto half = std::find_if(curve.rbegin(), curve.rend(),
                                   [&](const auto &one) { return one.first < result->displacement / 2; });
    if (result->displacement > far_from_elastic * elastic_displacement_ && half != curve.rend() &&
        result->residual > lasting * half->second) {
      PetscCall(take_mechanism(result));
      break;
    }
    const int took = result->iterations - iterations;
    if (took <= easy)
      prop_ = std::max(softest, prop_ / (took <= easiest ? 10 : growth));
    else
      prop_ *= growth;
  }
  if (result->verdict != LimitVerdict::equilibrium) problem_.restore(before);
  PetscFunctionReturn(0);
}

template PetscErrorCode LimitState<2>::creep(double, LimitSearch *);
template PetscErrorCode LimitState<3>::creep(double, LimitSearch *);

}  // namespace talus
