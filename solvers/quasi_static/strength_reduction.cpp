#include "solvers/quasi_static/strength_reduction.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "solvers/quasi_static/bracket.h"
#include "solvers/quasi_static/limit_state.h"
#include "solvers/quasi_static/slip_surface.h"

namespace talus {

Law without_softening(const Law &law) {
  return std::visit(
      [](auto one) -> Law {
        if constexpr (requires { one.shape_factor; }) one.shape_factor = 0;
        return one;
      },
      law);
}

namespace {

// Plastic strain of soil that softens is counted in this unit during trials, and its shape factor in the inverse: the
// product, from which strength follows, is that of the stages, and what trials add to it is nothing.
constexpr double unit_of_plastic_strain = 1e-9;

/// Multiplies the plastic strain of softening soil at all points.
template <int dim>
void scale_plastic_strain(SoilElements<dim> &soil, double factor) {
  for (GaussPoints<dim> &p : soil.points()) {
    const int field = plastic_strain_field(p.law), size = history_size(p.law);
    for (int q = 0; field >= 0 && q < p.count(); ++q) p.history[q * size + field] *= factor;
  }
}

}  // namespace

bool non_associated(const Law &law) {
  return std::visit(
      [](const auto &one) {
        if constexpr (requires { one.friction_angle; })
          return one.dilation_angle < one.friction_angle;
        else
          return false;
      },
      law);
}

Law strength_of_trial(const Law &law, double factor, bool dilating) {
  const auto slip_strength = [dilating](double phi, double psi) {
    return dilating ? 1 : std::cos(psi) * std::cos(phi) / (1 - std::sin(psi) * std::sin(phi));
  };
  return std::visit(
      [&](auto one) -> Law {
        if constexpr (requires { one.friction_angle; }) {
          one.FrictionalStrength::prepare();  // residual values that are not given are those of the peak
          const double peak = slip_strength(one.friction_angle, one.dilation_angle),
                       residual =
                           slip_strength(one.residual_phi, std::min(one.residual_phi, std::asin(one.sin_psi_residual)));
          if (one.softens())
            one.residual_cohesion = residual * one.residual_c,
            one.residual_friction_angle = std::atan(residual * std::tan(one.residual_phi)),
            one.residual_dilation_angle = one.residual_friction_angle;
          one.cohesion *= peak, one.friction_angle = std::atan(peak * std::tan(one.friction_angle));
          one.dilation_angle = one.friction_angle, one.shape_factor *= unit_of_plastic_strain;
          if constexpr (requires { one.suction_cohesion; }) one.suction_cohesion *= peak;
        }
        return one;
      },
      with_reduced_strength(law, factor));
}

StrengthShares shares_of_trial(const Law &law, const StrengthShares &own, double factor, bool dilating) {
  const Law at_place = std::visit(
      [&](auto one) -> Law {
        if constexpr (requires { one.reads_shares; }) one.take_shares(own.cohesion, own.friction);
        return one;
      },
      law);
  const StrengthRange largest = strength_of(strength_of_trial(law, factor, dilating)),
                      here = strength_of(strength_of_trial(at_place, factor, dilating));
  const auto share = [](double part, double whole) { return whole > 0 ? part / whole : 1; };
  return {share(here.cohesion[0], largest.cohesion[0]), share(here.friction_angle[0], largest.friction_angle[0])};
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
    if (outcome->stopped) PetscFunctionReturn(0);
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

namespace {

/// One search for a bracket.
template <int dim>
class Reduction {
 public:
  Reduction(QuasiStatic<dim> &problem, const std::vector<Law> &laws,
            const std::vector<std::vector<StrengthShares>> &own_shares, const ReductionSettings &settings,
            bool dilating, LimitState<dim> &limit, std::vector<StrengthTrial> &trials)
      : problem_(problem),
        laws_(laws),
        own_shares_(own_shares),
        settings_(settings),
        dilating_(dilating),
        limit_(limit),
        trials_(trials) {}

  /// Brackets the factor; the first trial divides strength by `first`. Leaves the problem in the state of the largest
  /// factor with an equilibrium.
  PetscErrorCode bracket(double first, FactorBracket *result, bool *interrupted) {
    PetscFunctionBeginUser;
    start_ = stable_ = problem_.soil().save();
    const TryFactor attempt = [this](double factor, TrialOutcome *outcome, bool *stopped) {
      return this->attempt(factor, outcome, stopped);
    };
    PetscCall(bracket_factor(first, attempt, result, interrupted));
    problem_.soil().restore(stable_);
    PetscFunctionReturn(0);
  }

 private:
  PetscErrorCode attempt(double factor, TrialOutcome *outcome, bool *interrupted) {
    PetscFunctionBeginUser;
    const auto begin = std::chrono::steady_clock::now();
    SoilElements<dim> &soil = problem_.soil();
    StrengthTrial trial;
    trial.factor = factor, trial.dilating = dilating_;
    for (const auto *state : {&stable_, &start_}) {  // from the first state too, where the last one leads nowhere
      if (state == &start_ && !any_stable_) break;   // they are the same
      soil.restore(*state);
      for (size_t b = 0; b < laws_.size(); ++b) divide_strength(soil.points()[b], laws_[b], own_shares_[b], factor);
      LimitSearch found;
      PetscCall(limit_.search(&found));
      trial.iterations += found.iterations, trial.residual = found.residual, trial.surplus = found.surplus;
      trial.curve = std::move(found.curve);
      *interrupted = found.verdict == LimitVerdict::interrupted;
      if (*interrupted) PetscFunctionReturn(0);
      if (found.verdict != LimitVerdict::undecided) {
        const bool stands = found.verdict == LimitVerdict::equilibrium;
        trial.outcome = stands ? TrialOutcome::equilibrium : TrialOutcome::mechanism;
        trial.displacement = stands ? soil.largest_displacement() : found.displacement;
        if (stands) stable_ = soil.save(), any_stable_ = true;
        break;
      }
      trial.displacement = found.displacement;
    }
    trial.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    *outcome = trial.outcome;
    trials_.push_back(trial);
    settings_.tell(trial);
    PetscFunctionReturn(0);
  }

  /// Gives points with `own` shares of the law's strength that of a trial.
  void divide_strength(GaussPoints<dim> &p, const Law &law, const std::vector<StrengthShares> &own, double factor) {
    p.law = strength_of_trial(law, factor, dilating_);
    for (size_t q = 0; q < own.size(); ++q) {
      const StrengthShares shares = shares_of_trial(law, own[q], factor, dilating_);
      p.cohesion_share[q] = shares.cohesion, p.friction_share[q] = shares.friction;
    }
  }

  QuasiStatic<dim> &problem_;
  const std::vector<Law> &laws_;
  const std::vector<std::vector<StrengthShares>> &own_shares_;
  const ReductionSettings &settings_;
  bool dilating_;
  LimitState<dim> &limit_;
  std::vector<StrengthTrial> &trials_;
  typename SoilElements<dim>::State start_, stable_;
  bool any_stable_ = false;
};

}  // namespace

template <int dim>
PetscErrorCode reduce_strength(QuasiStatic<dim> &problem, const std::vector<Law> &laws,
                               const ReductionSettings &settings, FactorOfSafety *result, bool *interrupted) {
  PetscFunctionBeginUser;
  *result = {}, *interrupted = false;
  result->davis = std::any_of(laws.begin(), laws.end(), non_associated);
  std::vector<std::vector<double>> history;  // displacement counts from here, strength as it is
  for (const GaussPoints<dim> &p : problem.soil().points()) history.push_back(p.history);
  problem.soil().reset_displacement();
  for (size_t b = 0; b < history.size(); ++b) problem.soil().points()[b].history = history[b];
  scale_plastic_strain(problem.soil(), 1 / unit_of_plastic_strain);
  std::vector<std::vector<StrengthShares>> own_shares;  // [body][point], empty where the law is the same everywhere
  for (const GaussPoints<dim> &p : problem.soil().points()) {
    std::vector<StrengthShares> &own = own_shares.emplace_back(p.cohesion_share.size());
    for (size_t q = 0; q < own.size(); ++q) own[q] = {p.cohesion_share[q], p.friction_share[q]};
  }
  LimitState<dim> limit(problem);
  PetscCall(limit.setup(settings.load_time, settings.time));
  Reduction<dim> own(problem, laws, own_shares, settings, !result->davis, limit, result->trials);
  PetscCall(own.bracket(1, result, interrupted));
  if (*interrupted || result->lower == 0 || result->upper == 0) PetscFunctionReturn(0);
  const auto stable = problem.soil().save();
  PetscCall(limit.move_along(settings.shown_displacement));
  find_slip_surface(problem.soil(), result);
  const auto moved = problem.soil().save();
  if (result->davis) {
    problem.soil().restore(stable);
    Reduction<dim> dilating(problem, laws, own_shares, settings, true, limit, result->trials);
    PetscCall(dilating.bracket(result->upper, &result->dilating, interrupted));
    problem.soil().restore(moved);
  }
  scale_plastic_strain(problem.soil(), unit_of_plastic_strain);
  PetscFunctionReturn(0);
}

template PetscErrorCode reduce_strength(QuasiStatic<2> &, const std::vector<Law> &, const ReductionSettings &,
                                        FactorOfSafety *, bool *);
template PetscErrorCode reduce_strength(QuasiStatic<3> &, const std::vector<Law> &, const ReductionSettings &,
                                        FactorOfSafety *, bool *);

}  // namespace talus
