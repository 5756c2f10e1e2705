#include "solvers/quasi_static/limit_state.h"

#include <algorithm>
#include <cmath>

#include "solvers/quasi_static/trial_strength.h"

namespace talus {
namespace {

// While the prop became ten times softer its force has decreased by less than a quarter, where soil fails. The force on
// soil in equilibrium would be a tenth.
constexpr double lasting = 0.75;
// Stiffness of the prop over that of elastic soil. With the last one, soil that has moved by 10,000 times the elastic
// displacement is still in equilibrium.
constexpr double first_prop = 1e-2, last_prop = 1e-9;
constexpr int most_iterations = 200, most_per_prop = 40;
// Of the linear systems of large bodies.
constexpr double small_error = 1e-2;
constexpr int most_iterations_of_system = 60;
// Change of the friction of bases over all of it at which their friction is that of their normal force: a fifth of the
// width of the bracket of a factor of safety.
constexpr double small_change = 1e-3;

}  // namespace

template <int dim>
PetscErrorCode LimitState<dim>::make_solver(bool symmetric) {
  PetscFunctionBeginUser;
  symmetric_ = symmetric;
  PetscCall(KSPCreate(problem_.soil().nodes().comm(), solver_.create()));
  PetscCall(KSPSetOptionsPrefix(solver_, "talus_"));
  PetscCall(problem_.prepare_linear_solver(solver_, symmetric));
  if (!problem_.direct()) {  // a direction that leads down will do: the search along it finds how far
    PetscCall(KSPSetType(solver_, symmetric ? KSPCG : KSPFGMRES));
    PetscCall(KSPSetTolerances(solver_, small_error, PETSC_DEFAULT, PETSC_DEFAULT, most_iterations_of_system));
  }
  PetscCall(KSPSetFromOptions(solver_));
  PetscFunctionReturn(0);
}

/// For the strength that the soil has now.
template <int dim>
PetscErrorCode LimitState<dim>::choose_solver() {
  PetscFunctionBeginUser;
  const bool symmetric = !problem_.bases().any() &&
                         std::ranges::all_of(problem_.soil().points(),
                                             [](const GaussPoints<dim> &p) { return !p.present || has_energy(p.law); });
  if (symmetric != symmetric_) PetscCall(make_solver(symmetric));
  PetscFunctionReturn(0);
}

/// A tangent that is positive but for round-off is solved as one that is not.
template <int dim>
PetscErrorCode LimitState<dim>::solve(::Vec b, ::Vec x, bool *solved) {
  PetscFunctionBeginUser;
  PetscCall(solve_system(solver_, problem_.matrix(), b, x, solved));
  if (*solved || !symmetric_) PetscFunctionReturn(0);
  PetscCall(make_solver(false));
  PetscCall(solve_system(solver_, problem_.matrix(), b, x, solved));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode LimitState<dim>::setup(double load_time, double time, double share) {
  bool solved;
  PetscFunctionBeginUser;
  load_time_ = load_time, time_ = time, share_ = share;
  for (Vector *v : {&x_, &trial_, &direction_, &force_, &of_prop_, &start_, &mechanism_})
    PetscCall(problem_.soil().nodes().global_vector(*v));
  PetscCall(problem_.prepare(share, load_time, time, 0, x_));
  PetscCall(problem_.stiffness(0, 1));
  PetscCall(MatDuplicate(problem_.matrix(), MAT_COPY_VALUES, elastic_.create()));
  PetscCall(make_solver(true));
  PetscCall(solve(problem_.loads(), direction_, &solved));
  PetscCall(VecNorm(direction_, NORM_INFINITY, &elastic_displacement_));
  PetscFunctionReturn(0);
}

/// Out-of-balance force at displacement x, loads minus forces of soil and prop, in force_.
template <int dim>
PetscErrorCode LimitState<dim>::evaluate(::Vec x) {
  PetscFunctionBeginUser;
  PetscCall(problem_.residual(x, force_));
  PetscCall(MatMult(elastic_, x, of_prop_));
  PetscCall(VecScale(of_prop_, prop_));
  PetscCall(VecAXPY(force_, 1, of_prop_));
  PetscCall(VecScale(force_, -1));
  PetscCall(VecNorm(force_, NORM_2, &residual_));
  PetscCall(VecNorm(of_prop_, NORM_2, &prop_force_));
  PetscFunctionReturn(0);
}

/// Goes along the direction to where the out-of-balance force does little more work on it, which is near the least
/// energy on this line. Leaves the end in x_ and its force in force_.
template <int dim>
PetscErrorCode LimitState<dim>::line_search(double slope, double *step) {
  constexpr double enough = 0.3;  // of the slope at the start, up or down: near enough to the least energy
  constexpr int most_evaluations = 15;
  double low = 0, at_low = slope, high = 0, at_high = 0;
  PetscFunctionBeginUser;
  *step = 1;
  for (int k = 0; k < most_evaluations; ++k) {
    double work;
    PetscCall(VecWAXPY(trial_, *step, direction_, x_));
    PetscCall(evaluate(trial_));
    PetscCall(VecDot(force_, direction_, &work));
    if (std::abs(work) <= enough * slope) break;
    if (work > 0) {
      low = *step, at_low = work;
    } else {
      high = *step, at_high = std::isfinite(work) ? work : -1e3 * slope;
    }
    if (high == 0) {
      *step *= 2;
    } else {
      const double middle = low + (high - low) * at_low / (at_low - at_high);
      *step = std::clamp(middle, low + 0.1 * (high - low), low + 0.9 * (high - low));
    }
  }
  PetscCall(VecCopy(trial_, x_));
  PetscFunctionReturn(0);
}

/// Newton's iterations for the propped soil, until what is out of balance is small: a share `of_prop` of the force of
/// the prop, or `of_scale` of all forces.
template <int dim>
PetscErrorCode LimitState<dim>::settle(int most, double of_prop, double of_scale, LimitSearch *result, bool *settled) {
  double slope, step;
  bool solved;
  PetscFunctionBeginUser;
  *settled = false;
  PetscCall(evaluate(x_));
  for (int k = 0;; ++k) {
    const double scale = problem_.force_scale();
    if (problem_.iterated && scale > 0) problem_.iterated(result->iterations, residual_ / scale);
    *settled = residual_ <= std::max(of_prop * prop_force_, of_scale * scale);
    if (*settled || k == most || stop_asked()) PetscFunctionReturn(0);
    PetscCall(problem_.stiffness(1, prop_));
    PetscCall(solve(force_, direction_, &solved));
    ++result->iterations;
    PetscCall(VecDot(force_, direction_, &slope));
    if (!(slope > 0 && std::isfinite(slope))) PetscFunctionReturn(0);
    PetscCall(line_search(slope, &step));
  }
}

/// The same, with the friction that bases have under their present normal forces: a sequence of searches for the least
/// energy, each with the friction of the one before.
template <int dim>
PetscErrorCode LimitState<dim>::settle_on_bases(int most, LimitSearch *result, bool *settled) {
  constexpr int most_changes = 20;
  PetscFunctionBeginUser;
  const int last = result->iterations + most;
  for (int k = 0; k < most_changes; ++k) {
    double change;
    PetscCall(settle(last - result->iterations, 0.05, 0.5 * small_residual, result, settled));
    if (!*settled || stop_asked()) PetscFunctionReturn(0);
    PetscCall(problem_.follow_normal_forces(&change));
    if (change <= small_change) PetscFunctionReturn(0);
  }
  *settled = false;
  PetscFunctionReturn(0);
}

/// The soil moves along x_, which the prop resists.
template <int dim>
PetscErrorCode LimitState<dim>::take_mechanism(LimitSearch *result) {
  double on_prop, of_loads;
  PetscFunctionBeginUser;
  PetscCall(VecDot(of_prop_, x_, &on_prop));
  PetscCall(VecDot(problem_.loads(), x_, &of_loads));
  result->verdict = LimitVerdict::mechanism, result->surplus = on_prop / of_loads;
  PetscCall(VecCopy(x_, mechanism_));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode LimitState<dim>::search(LimitSearch *result) {
  bool settled;
  PetscFunctionBeginUser;
  *result = {};
  PetscCall(choose_solver());
  PetscCall(problem_.prepare(share_, load_time_, time_, 0, x_));
  prop_ = first_prop;
  PetscCall(evaluate(x_));
  problem_.close_scale();
  double change;
  PetscCall(problem_.follow_normal_forces(&change));
  double last_force = 0, last_prop_tried = 0;  // of the stiffer prop before
  for (double reduction = 10;;) {
    PetscCall(VecCopy(x_, start_));  // where this prop begins
    PetscCall(settle_on_bases(std::min(most_per_prop, most_iterations - result->iterations), result, &settled));
    if (stop_asked()) {
      result->verdict = LimitVerdict::interrupted;
      break;
    }
    const double scale = problem_.force_scale(), force = prop_force_ / scale;
    PetscCall(VecNorm(x_, NORM_INFINITY, &result->displacement));
    result->residual = force + residual_ / scale;
    if (settled) result->curve.emplace_back(result->displacement, force);
    if (settled && result->residual <= small_residual) {
      result->verdict = LimitVerdict::equilibrium;
      PetscCall(problem_.commit(x_, false));
      break;
    }
    const double decades = last_force > 0 ? std::log10(last_prop_tried / prop_) : 0;
    if (settled && decades > 0 && result->displacement > far_from_elastic * elastic_displacement_ &&
        force > std::pow(lasting, decades) * last_force) {
      PetscCall(take_mechanism(result));
      break;
    }
    if (result->iterations >= most_iterations) break;
    if (settled) {  // a prop that soil in equilibrium leans on less and less can be taken away faster
      const bool unloads = decades > 0 && force < std::pow(0.3, decades) * last_force;
      reduction = unloads ? std::min(100 * reduction, 1e3) : std::min(reduction * reduction, 10.);
      last_force = force, last_prop_tried = prop_;
    } else {  // a smaller change of the prop
      if (reduction < 1.5 || last_force == 0) break;
      PetscCall(VecCopy(start_, x_));
      prop_ = last_prop_tried, reduction = std::sqrt(reduction);
    }
    if (prop_ <= last_prop) break;
    prop_ = std::max(prop_ / reduction, last_prop);
  }
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode LimitState<dim>::move_along(double size) {
  double largest;
  PetscFunctionBeginUser;
  PetscCall(VecNorm(mechanism_, NORM_INFINITY, &largest));
  PetscCall(VecScale(mechanism_, size / largest));
  PetscCall(problem_.commit(mechanism_, false));
  PetscFunctionReturn(0);
}

template class LimitState<2>;
template class LimitState<3>;

}  // namespace talus
