#include "solvers/quasi_static/strength_reduction.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "solvers/quasi_static/bracket.h"
#include "solvers/quasi_static/limit_state.h"
#include "solvers/quasi_static/trial_strength.h"
#include "solvers/quasi_static/undrained_strength.h"

namespace talus {

PetscErrorCode follow_path(double step, double smallest,
                           const std::function<PetscErrorCode(double, double, StepOutcome *)> &advance,
                           const std::function<PetscErrorCode(StepOutcome *)> &decide,
                           const std::function<void(double, const StepOutcome &)> &done, double *share,
                           StepOutcome *outcome, int *iterations) {
  constexpr int quick = 6;  // iterations of a step
  PetscFunctionBeginUser;
  const double largest = step;
  bool asked = !decide;
  *share = 0, *iterations = 0;
  while (*share < 1) {
    double to = *share + step > 1 - 1e-9 ? 1 : *share + step;
    PetscCall(advance(*share, to, outcome));
    *iterations += outcome->iterations;
    if (!outcome->converged && !outcome->stopped && !asked) {
      asked = true;
      PetscCall(decide(outcome));
      *iterations += outcome->iterations;
      if (outcome->converged) to = 1;
    }
    if (outcome->stopped || outcome->fails) PetscFunctionReturn(0);
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

void take(const LimitSearch &found, StepOutcome *outcome) {
  outcome->iterations += found.iterations;
  outcome->converged = found.verdict == LimitVerdict::equilibrium;
  outcome->fails = found.verdict == LimitVerdict::mechanism;
  outcome->stopped = found.verdict == LimitVerdict::interrupted;
  if (outcome->converged) outcome->residual = found.residual, outcome->largest = found.displacement;
}

/// A search with psi = phi under the loads of `load_time`; the problem is left in an equilibrium that it finds.
template <int dim>
PetscErrorCode search_associated(QuasiStatic<dim> &problem, const std::vector<Law> &laws, double load_time, double time,
                                 StepOutcome *outcome) {
  PetscFunctionBeginUser;
  TrialStrength<dim> strength(problem.soil(), problem.bases(), problem.structures(), laws);
  strength.set(1, TrialFlow::associated);
  LimitState<dim> limit(problem);
  LimitSearch found;
  PetscCall(limit.setup(load_time, time));
  PetscCall(limit.search(&found));
  strength.restore();
  take(found, outcome);
  PetscFunctionReturn(0);
}

}  // namespace

template <int dim>
PetscErrorCode find_failure(QuasiStatic<dim> &problem, const std::vector<Law> &laws, double load_time, double time,
                            StepOutcome *outcome) {
  PetscFunctionBeginUser;
  const auto before = problem.save();
  outcome->iterations = 0;
  PetscCall(search_associated(problem, laws, load_time, time, outcome));
  problem.restore(before);
  outcome->converged = false;
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode creep_to(QuasiStatic<dim> &problem, double share, double load_time, double time, double tolerance,
                        StepOutcome *outcome) {
  PetscFunctionBeginUser;
  LimitState<dim> limit(problem);
  LimitSearch found;
  PetscCall(limit.setup(load_time, time, share));
  PetscCall(limit.creep(tolerance, &found));
  take(found, outcome);
  outcome->fails = false;  // less of the loads may do
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode settle(QuasiStatic<dim> &problem, const std::vector<Law> &laws, double load_time, double time,
                      double tolerance, bool *dilated, StepOutcome *outcome) {
  PetscFunctionBeginUser;
  const auto before = problem.save();
  outcome->iterations = 0, *dilated = false;
  PetscCall(creep_to(problem, 1, load_time, time, tolerance, outcome));
  if (outcome->converged || outcome->stopped) PetscFunctionReturn(0);
  PetscCall(search_associated(problem, laws, load_time, time, outcome));
  *dilated = outcome->converged;
  if (!outcome->converged) problem.restore(before);
  PetscFunctionReturn(0);
}

template PetscErrorCode find_failure(QuasiStatic<2> &, const std::vector<Law> &, double, double, StepOutcome *);
template PetscErrorCode find_failure(QuasiStatic<3> &, const std::vector<Law> &, double, double, StepOutcome *);
template PetscErrorCode creep_to(QuasiStatic<2> &, double, double, double, double, StepOutcome *);
template PetscErrorCode creep_to(QuasiStatic<3> &, double, double, double, double, StepOutcome *);
template PetscErrorCode settle(QuasiStatic<2> &, const std::vector<Law> &, double, double, double, bool *,
                               StepOutcome *);
template PetscErrorCode settle(QuasiStatic<3> &, const std::vector<Law> &, double, double, double, bool *,
                               StepOutcome *);

namespace {

/// One search for a bracket.
template <int dim>
class Reduction {
 public:
  Reduction(QuasiStatic<dim> &problem, TrialStrength<dim> &strength, const ReductionSettings<dim> &settings,
            TrialFlow flow, int search, LimitState<dim> &limit, std::vector<StrengthTrial> &trials)
      : problem_(problem),
        strength_(strength),
        settings_(settings),
        flow_(flow),
        search_(search),
        limit_(limit),
        trials_(trials) {}

  /// Brackets the factor of soil with an energy, see bracket_factor. Leaves the problem in the state of the largest
  /// factor with an equilibrium.
  PetscErrorCode bracket(double first, double ceiling, FactorBracket *result, bool *interrupted) {
    PetscFunctionBeginUser;
    start_ = stable_ = problem_.save();
    PetscCall(bracket_factor(first, ceiling, attempts(), result, interrupted));
    problem_.restore(stable_);
    PetscFunctionReturn(0);
  }
  /// The same for soil with psi < phi, see climb_to_factor.
  PetscErrorCode climb(const std::vector<double> &first, double ceiling, FactorBracket *result, bool *interrupted) {
    PetscFunctionBeginUser;
    start_ = stable_ = problem_.save();
    PetscCall(climb_to_factor(first, ceiling, attempts(), result, interrupted));
    problem_.restore(stable_);
    PetscFunctionReturn(0);
  }

 private:
  using State = typename QuasiStatic<dim>::State;
  TryFactor attempts() {
    return [this](double factor, TrialOutcome *outcome, bool *stopped) { return attempt(factor, outcome, stopped); };
  }

  PetscErrorCode attempt(double factor, TrialOutcome *outcome, bool *interrupted) {
    constexpr double long_way = 1.1;  // from the factor of the last equilibrium: the soil creeps there
    PetscFunctionBeginUser;
    const auto begin = std::chrono::steady_clock::now();
    StrengthTrial trial;
    trial.search = search_, trial.factor = factor, trial.flow = flow_;
    const bool energy = flow_ != TrialFlow::own;
    const bool creeps = !energy && settings_.by_damped_motion && factor > long_way * stable_factor_;
    PetscCall(attempt_from(stable_, creeps ? &Reduction::creep : &Reduction::iterate, &trial, interrupted));
    const auto open = [&] { return trial.outcome == TrialOutcome::undecided && !*interrupted; };
    // soil with psi < phi follows a mechanism that is a small step away, and takes a smaller step before others
    const bool near = any_stable_ && narrow(stable_factor_, factor);
    if (!energy && !near && trial.outcome == TrialOutcome::mechanism) trial.outcome = TrialOutcome::undecided;
    // from the first state too, where the last one leads nowhere
    if (open() && energy && any_stable_) PetscCall(attempt_from(start_, &Reduction::iterate, &trial, interrupted));
    const bool last = energy || near || !any_stable_;
    if (open() && last && settings_.by_damped_motion)
      PetscCall(attempt_from(stable_, &Reduction::move, &trial, interrupted));
    else if (open() && last && !energy)
      trial.outcome = TrialOutcome::mechanism;
    if (*interrupted) PetscFunctionReturn(0);
    if (trial.outcome == TrialOutcome::equilibrium)
      stable_ = problem_.save(), any_stable_ = true, stable_factor_ = factor;
    trial.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    *outcome = trial.outcome;
    trials_.push_back(trial);
    settings_.tell(trial);
    PetscFunctionReturn(0);
  }

  using Way = PetscErrorCode (*)(LimitState<dim> &, LimitSearch *);
  static PetscErrorCode iterate(LimitState<dim> &limit, LimitSearch *found) { return limit.search(found); }
  static PetscErrorCode move(LimitState<dim> &limit, LimitSearch *found) { return limit.move(found); }
  static PetscErrorCode creep(LimitState<dim> &limit, LimitSearch *found) { return limit.creep(small_residual, found); }
  PetscErrorCode attempt_from(const State &state, Way way, StrengthTrial *trial, bool *interrupted) {
    PetscFunctionBeginUser;
    LimitSearch found;
    problem_.restore(state);
    strength_.set(trial->factor, flow_);
    PetscCall(way(limit_, &found));
    trial->iterations += found.iterations, trial->steps += found.steps;
    trial->residual = found.residual, trial->surplus = found.surplus, trial->displacement = found.displacement;
    trial->curve = std::move(found.curve);
    *interrupted = found.verdict == LimitVerdict::interrupted;
    trial->outcome = found.verdict == LimitVerdict::equilibrium ? TrialOutcome::equilibrium
                     : found.verdict == LimitVerdict::mechanism ? TrialOutcome::mechanism
                                                                : TrialOutcome::undecided;
    if (trial->outcome == TrialOutcome::equilibrium) trial->displacement = problem_.soil().largest_displacement();
    PetscFunctionReturn(0);
  }

  QuasiStatic<dim> &problem_;
  TrialStrength<dim> &strength_;
  const ReductionSettings<dim> &settings_;
  TrialFlow flow_;
  int search_;
  LimitState<dim> &limit_;
  std::vector<StrengthTrial> &trials_;
  State start_, stable_;
  bool any_stable_ = false;
  double stable_factor_ = 0;
};

/// Mechanisms one after the other.
template <int dim>
class MechanismSearch {
 public:
  MechanismSearch(QuasiStatic<dim> &problem, TrialStrength<dim> &strength, const ReductionSettings<dim> &settings,
                  FactorOfSafety *result)
      : problem_(problem),
        strength_(strength),
        settings_(settings),
        result_(*result),
        limit_(problem),
        undrained_limit_(problem),
        drained_(result->flow) {}

  PetscErrorCode run(bool *interrupted) {
    constexpr int most_searches = 20;
    PetscFunctionBeginUser;
    PetscCall(limit_.setup(settings_.load_time, settings_.time));
    if (settings_.flow) PetscCall(undrained_limit_.setup(settings_.load_time, settings_.time));
    State shown;  // the critical mechanism
    double first = 1;
    for (int search = 1; search <= most_searches; ++search) {
      std::map<TrialFlow, FactorBracket> by_flow;
      const State begin = problem_.save();
      PetscCall(bracket_each_flow(search, first, &by_flow, interrupted));
      if (settings_.flow && !*interrupted) PetscCall(bracket_undrained(search, first, begin, &by_flow, interrupted));
      if (*interrupted) PetscFunctionReturn(0);
      const FactorBracket &bracket = by_flow.at(result_.flow);
      if (bracket.lower == 0 || bracket.upper == 0) {
        if (search == 1) static_cast<FactorBracket &>(result_) = bracket;
        break;
      }
      const State stable = problem_.save();
      LimitState<dim> &limit = result_.flow == TrialFlow::undrained ? undrained_limit_ : limit_;
      PetscCall(limit.move_along(settings_.shown_displacement));
      if (search == 1) shown = problem_.save();
      std::vector<Mechanism> fresh;
      bool grown;
      PetscCall(take_pieces(bracket, &fresh, &grown));
      problem_.restore(stable);
      for (Mechanism &one : fresh) {
        one.by_flow = by_flow;
        if (count_ == 0)
          static_cast<Mechanism &>(result_) = one;
        else
          result_.further.push_back(one);
        if (++count_ == settings_.mechanisms) break;
      }
      if (count_ == settings_.mechanisms || !grown) break;
      for (const CellSet &cells : held_) PetscCall(strength_.hold(cells, std::min(1., result_.lower / 2)));
      first = bracket.upper;
    }
    if (count_ > 0) problem_.restore(shown);
    PetscFunctionReturn(0);
  }

 private:
  using State = typename QuasiStatic<dim>::State;
  Reduction<dim> reduction(TrialFlow flow, int search) {
    LimitState<dim> &limit = flow == TrialFlow::undrained ? undrained_limit_ : limit_;
    return {problem_, strength_, settings_, flow, search, limit, result_.trials};
  }

  /// The factor without flow, from `begin` on; the first search takes it for the result if it is the lower one. Leaves
  /// the problem in the state of the result's flow.
  PetscErrorCode bracket_undrained(int search, double first, const State &begin,
                                   std::map<TrialFlow, FactorBracket> *by_flow, bool *interrupted) {
    PetscFunctionBeginUser;
    const State drained = problem_.save();
    const FactorBracket &held = by_flow->at(drained_);
    problem_.restore(begin);
    FactorBracket undrained;
    PetscCall(reduction(TrialFlow::undrained, search).bracket(first, 0, &undrained, interrupted));
    if (*interrupted) PetscFunctionReturn(0);
    if (search == 1) {
      const bool found = undrained.lower > 0 && undrained.upper > 0, never = held.lower > 0 && held.upper == 0;
      if (found && (never || undrained.value() < held.value())) result_.flow = TrialFlow::undrained;
    }
    (*by_flow)[TrialFlow::undrained] = undrained;
    if (result_.flow != TrialFlow::undrained) problem_.restore(drained);
    PetscFunctionReturn(0);
  }

  /// The factor by the flow of the result and, where this is the soil's own, by those of its bounds. Leaves the problem
  /// in the state of the largest factor with an equilibrium, and that mechanism in `limit_` which was found last.
  PetscErrorCode bracket_each_flow(int search, double first, std::map<TrialFlow, FactorBracket> *by_flow,
                                   bool *interrupted) {
    constexpr double weaker = 0.95;  // Davis's soil fails first
    PetscFunctionBeginUser;
    const State begin = problem_.save();
    FactorBracket &upper = (*by_flow)[TrialFlow::associated];
    PetscCall(reduction(TrialFlow::associated, search).bracket(first, 0, &upper, interrupted));
    if (*interrupted || drained_ == TrialFlow::associated) PetscFunctionReturn(0);
    problem_.restore(begin);
    FactorBracket &lower = (*by_flow)[TrialFlow::davis];
    PetscCall(reduction(TrialFlow::davis, search)
                  .bracket(upper.lower > 0 ? weaker * upper.lower : first, upper.upper, &lower, interrupted));
    if (*interrupted) PetscFunctionReturn(0);
    problem_.restore(begin);
    PetscCall(bracket_own_flow(search, first, lower.lower, upper.upper, &(*by_flow)[TrialFlow::own], interrupted));
    PetscFunctionReturn(0);
  }

  /// Soil with psi < phi goes on from the state of the stages. If that was found with psi = phi, or not at all, the
  /// soil is first so strong that it is elastic, and weakens from there.
  PetscErrorCode bracket_own_flow(int search, double first, double low, double ceiling, FactorBracket *own,
                                  bool *interrupted) {
    PetscFunctionBeginUser;
    if (search > 1 || settings_.by_own_flow) {
      std::vector<double> climb{first};
      if (low > first) climb.push_back(low);
      PetscCall(reduction(TrialFlow::own, search).climb(climb, ceiling, own, interrupted));
      PetscFunctionReturn(0);
    }
    const State begin = problem_.save();
    bool strong;
    PetscCall(strengthen(&strong, interrupted));
    if (*interrupted) PetscFunctionReturn(0);
    if (strong) PetscCall(reduction(TrialFlow::own, search).climb({low > 0 ? low : first}, ceiling, own, interrupted));
    if (*interrupted || own->lower >= 1 || (strong && !settings_.stands)) PetscFunctionReturn(0);
    if (strong) result_.weakened = *own;
    problem_.restore(begin);
    PetscCall(reduction(TrialFlow::own, search).climb({first}, ceiling, own, interrupted));
    PetscFunctionReturn(0);
  }

  /// Puts the loads on soil without stress that hardly yields.
  PetscErrorCode strengthen(bool *found, bool *interrupted) {
    constexpr double divisor = 0.05;  // of strength
    PetscFunctionBeginUser;
    LimitSearch search;
    strength_.set(divisor, TrialFlow::associated);
    for (GaussPoints<dim> &p : problem_.soil().points()) std::fill(p.stress.begin(), p.stress.end(), 0.);
    PetscCall(limit_.search(&search));
    *found = search.verdict == LimitVerdict::equilibrium;
    *interrupted = search.verdict == LimitVerdict::interrupted;
    PetscFunctionReturn(0);
  }

  /// Sorts the pieces of soil that move now into new mechanisms and shoulders of those that were found before. `grown`
  /// says whether there is more soil to hold than before.
  PetscErrorCode take_pieces(const FactorBracket &bracket, std::vector<Mechanism> *fresh, bool *grown) {
    constexpr double alike = 0.5, margin = 0.2;
    std::vector<CellSet> pieces;
    PetscFunctionBeginUser;
    const SoilElements<dim> &soil = problem_.soil();
    PetscCall(moving_pieces(soil, &pieces));
    *grown = false;
    for (const CellSet &piece : pieces) {
      double most = 0;
      size_t like = moved_.size();
      for (size_t k = 0; k < held_.size(); ++k) {
        double beside;
        PetscCall(shear_beside(soil, piece, held_[k], &beside));
        if (beside > most) most = beside, like = k;
      }
      if (most < alike) {
        Mechanism &one = fresh->emplace_back();
        static_cast<FactorBracket &>(one) = bracket;
        describe_motion(soil, piece, &one);
        if (!moved_.empty()) one.of_critical = volume_of(soil, both(moved_[0], piece)) / volume_of(soil, moved_[0]);
        like = moved_.size();
        moved_.push_back(piece), held_.emplace_back(piece.size(), 0);
      } else {
        settings_.tell_shoulder(bracket, static_cast<int>(like) + 1, most);
        moved_[like] = either(moved_[like], piece);
      }
      CellSet held = moved_[like];
      PetscCall(grow_by(soil, margin * std::pow(volume_of(soil, held), 1. / dim), &held));
      if (volume_of(soil, held) <=
          volume_of(soil, held_[like])) {  // a shoulder within soil that is held: along its rim
        held = held_[like];
        PetscCall(grow_by(soil, margin * std::pow(volume_of(soil, held), 1. / dim), &held));
      }
      *grown = *grown || volume_of(soil, held) > volume_of(soil, held_[like]);
      held_[like] = held;
    }
    PetscFunctionReturn(0);
  }

  QuasiStatic<dim> &problem_;
  TrialStrength<dim> &strength_;
  const ReductionSettings<dim> &settings_;
  FactorOfSafety &result_;
  LimitState<dim> limit_, undrained_limit_;
  TrialFlow drained_;  ///< of the factor with pore pressure held
  int count_ = 0;
  std::vector<CellSet> moved_, held_;  ///< by each mechanism with its shoulders, and the soil held for it
};

}  // namespace

template <int dim>
PetscErrorCode reduce_strength(QuasiStatic<dim> &problem, const std::vector<Law> &laws,
                               const ReductionSettings<dim> &settings, FactorOfSafety *result, bool *interrupted) {
  PetscFunctionBeginUser;
  *result = {}, *interrupted = false;
  if (std::any_of(laws.begin(), laws.end(), non_associated)) result->flow = TrialFlow::own;
  std::vector<std::vector<double>> history;  // displacement counts from here, strength as it is
  for (const GaussPoints<dim> &p : problem.soil().points()) history.push_back(p.history);
  problem.soil().reset_displacement();
  for (size_t b = 0; b < history.size(); ++b) problem.soil().points()[b].history = history[b];
  TrialStrength<dim> strength(problem.soil(), problem.bases(), problem.structures(), laws);
  if (settings.flow) strength.take_undrained(undrained_strength(problem.soil(), *settings.flow, laws));
  for (size_t b = 0; b < settings.kept.size(); ++b)
    if (settings.kept[b]) strength.keep(b);
  if (settings.crack) settings.tell_cracked(strength.crack(settings.crack));
  if (settings.divided) settings.tell_confined(strength.confine(settings.divided));
  const PathWork work = problem.work();  // trials do none
  PetscCall(MechanismSearch<dim>(problem, strength, settings, result).run(interrupted));
  problem.set_work(work);
  strength.restore();
  PetscFunctionReturn(0);
}

template PetscErrorCode reduce_strength(QuasiStatic<2> &, const std::vector<Law> &, const ReductionSettings<2> &,
                                        FactorOfSafety *, bool *);
template PetscErrorCode reduce_strength(QuasiStatic<3> &, const std::vector<Law> &, const ReductionSettings<3> &,
                                        FactorOfSafety *, bool *);

}  // namespace talus
