#include "solvers/quasi_static/flow_path.h"

#include <algorithm>
#include <cmath>

#include "scene/quasi_static_source.h"

namespace talus {

namespace {

/// Soil that fails while its water has no time to flow: steps of consolidation then become shorter and shorter.
class FailureWatch {
 public:
  FailureWatch(const FlowPath &path, double longest, double drainage)
      : path_(path), longest_(longest), drainage_(drainage), ask_below_(small * longest) {}

  /// To be told of each try of a step of dt [s] from `share`; `outcome` says so if the path has to end.
  PetscErrorCode tried(double share, double dt, bool converged, StepOutcome *outcome) {
    PetscFunctionBeginUser;
    if (!path_.find_failure) PetscFunctionReturn(0);
    failed_ = converged ? 0 : failed_ + 1;
    if (failed_ >= doubtful || dt < ask_below_) {
      const double least = small * path_.duration, ahead = std::min(drainage_, std::max(dt, least));
      PetscCall(path_.find_failure(std::min(1., share + ahead / path_.duration), outcome));
      if (outcome->stopped || (outcome->fails && dt <= least)) PetscFunctionReturn(0);
      if (!outcome->fails) failed_ = 0, ask_below_ = small * std::min(ask_below_, dt);
      outcome->fails = outcome->undrained = false;  // it may bear the loads of a shorter step
    }
    if (dt > small * std::min(longest_, drainage_)) tries_ = 0, first_ = share;
    shortest_ = tries_++ == 0 ? dt : std::min(shortest_, dt);
    if (tries_ < many) PetscFunctionReturn(0);
    if (share - first_ < small) outcome->crawl = shortest_;
    tries_ = 0, first_ = share;
    PetscFunctionReturn(0);
  }

 private:
  static constexpr double small = 0.01;
  static constexpr int doubtful = 2, many = 100;  // failed steps, tries
  const FlowPath &path_;
  double longest_, drainage_;  ///< of steps, and of the water of one cell [s]
  double ask_below_;           ///< [s]
  int failed_ = 0, tries_ = 0;
  double first_ = 0, shortest_ = 0;
};

}  // namespace

/// The error of a step is what its end misses of the line through the last two states.
template <int dim>
PetscErrorCode follow_flow(MPI_Comm comm, QuasiStatic<dim> *soil, PoreFlow<dim> &flow,
                           const QuasiStaticSource &settings, const FlowPath &path, double *share, StepOutcome *outcome,
                           int *iterations) {
  PetscFunctionBeginUser;
  constexpr double first = 1e-4, growth = 2, shrinkage = 0.2, safety = 0.9, steady_growth = 4, longest_steady = 1e9,
                   still = 1e-7;
  constexpr double soon = 1e-6;    // of the path: events that are nearer to the last are passed over
  constexpr double slight = 0.01;  // of the pressure: changes that are less are resolved no better, nor is their noise
  constexpr double driest = 1e9;   // [Pa]: suction at which soil holds no water any more, Fredlund & Xing (1994)
  FlowStep<dim> step_of_flow(soil, flow, settings, path.steady);
  PetscCall(step_of_flow.setup());
  const int count = flow.nodes().count();
  std::vector<FlowMeasure> before(count), now(count), rate(count), start(count);
  const auto measure = [&](std::vector<FlowMeasure> &of) {
    for (int i = 0; i < count; ++i) of[i] = flow.measure(i);
  };
  measure(start), before = start;
  const double longest = path.steady ? longest_steady * path.duration : path.duration / path.load_steps;
  const double drainage = soil ? step_of_flow.shortest_step() : 0;
  double step = std::min(longest, std::max(first * path.duration, drainage)), last = 0, range = 0;
  FailureWatch watch(path, longest, drainage);
  int known = 0;  // steps behind: the first takes what is put on at once, so that the line starts with the second
  *share = 0, *iterations = 0;
  while (*share < 1) {
    double to = path.steady ? 1 : *share + step / path.duration;
    const auto next = std::ranges::find_if(path.events, [&](double event) { return event > *share + soon; });
    if (next != path.events.end() && to > *next) to = *next;
    if (to > 1 - 1e-9) to = 1;
    const double dt = path.steady ? step : (to - *share) * path.duration;
    PetscCall(step_of_flow.solve(path.load_at(to), path.steady ? 0 : path.load_at(to) - path.load_at(*share),
                                 *share * path.duration, dt, outcome));
    *iterations += outcome->iterations;
    double error[4]{};  // of the step; the largest change of pressure so far, or what is slight; suction and pressure
    if (outcome->converged) {
      measure(now);
      for (int i = 0; i < count; ++i) {
        error[2] = std::max(error[2], -flow.pressure[i]), error[3] = std::max(error[3], flow.pressure[i]);
        error[1] =
            std::max({error[1], std::abs(now[i].pressure - start[i].pressure), slight * std::abs(flow.pressure[i])});
        if (known < 2) continue;
        const double weight = dt / (dt + last);
        error[0] =
            std::max({error[0], weight * std::abs(now[i].pressure - before[i].pressure - dt * rate[i].pressure) / range,
                      weight * std::abs(now[i].saturation - before[i].saturation - dt * rate[i].saturation)});
      }
      MPI_Allreduce(MPI_IN_PLACE, error, 4, MPI_DOUBLE, MPI_MAX, comm);
      range = std::max({range, error[1], 1e-300});
      outcome->dry = error[2] > std::min(driest, flow.liquid().bulk_modulus), outcome->shut = error[3] > driest;
      if (outcome->dry || outcome->shut) PetscFunctionReturn(0);
    }
    PetscCall(watch.tried(*share, dt, outcome->converged, outcome));
    if (outcome->fails || outcome->stopped || outcome->crawl > 0) PetscFunctionReturn(0);
    const double least = settings.smallest_step * first * path.duration;
    if (!outcome->converged || (!path.steady && error[0] > 2 * settings.step_error && dt > 10 * least)) {
      if (dt / 4 < least) PetscFunctionReturn(0);
      step = outcome->converged ? dt * std::max(shrinkage, safety * std::sqrt(settings.step_error / error[0])) : dt / 4;
      continue;
    }
    const double stored = flow.stored();
    PetscCall(step_of_flow.commit(path.softening));
    for (int i = 0; i < count; ++i)
      rate[i] = {(now[i].pressure - before[i].pressure) / dt, (now[i].saturation - before[i].saturation) / dt};
    before = now, last = dt, ++known;
    if (path.steady) {  // what is still stored must be nothing beside what flows
      double flows = 0, stores = stored / dt;
      for (double q : flow.inflow()) flows += std::abs(q);
      MPI_Allreduce(MPI_IN_PLACE, &stores, 1, MPI_DOUBLE, MPI_SUM, comm);
      if (stores <= still * flows || step >= longest) *share = 1, path.done(1);
      step = std::min(longest, steady_growth * step);
      continue;
    }
    *share = to;
    path.done(to);
    const double wish = known < 2 ? 1 : error[0] > 0 ? safety * std::sqrt(settings.step_error / error[0]) : growth;
    step = std::min(longest, dt * std::clamp(wish, shrinkage, growth));
  }
  PetscFunctionReturn(0);
}

template PetscErrorCode follow_flow(MPI_Comm, QuasiStatic<2> *, PoreFlow<2> &, const QuasiStaticSource &,
                                    const FlowPath &, double *, StepOutcome *, int *);
template PetscErrorCode follow_flow(MPI_Comm, QuasiStatic<3> *, PoreFlow<3> &, const QuasiStaticSource &,
                                    const FlowPath &, double *, StepOutcome *, int *);

}  // namespace talus
