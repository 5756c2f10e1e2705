// Steps of seepage and consolidation, and what pore water by finite elements and by particles hand to one another;
// included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>

#include "simulation/simulation_impl.h"

namespace talus {

/// Time steps by what each misses, docs/theory/seepage.md section 3: implicit Euler against the line through the last
/// two states.
template <int dim>
void Simulation<dim>::follow_water(const Stage &stage, const std::function<double(double)> &load_at,
                                   const std::function<void(double)> &done, double *share, StepOutcome *outcome,
                                   int *iterations) {
  constexpr double first = 1e-4, growth = 2, shrinkage = 0.2, safety = 0.9, steady_growth = 4, longest_steady = 1e9,
                   still = 1e-7;
  const bool soil_moves = stage.kind == StageKind::consolidation;
  const QuasiStaticSource &settings = scene_.quasi_static;
  FlowStep<dim> flow(soil_moves ? statics_.get() : nullptr, *flow_, settings);
  require(flow.setup());
  const int count = flow_->nodes().count();
  std::vector<FlowMeasure> before(count), now(count), rate(count), start(count);
  const auto measure = [&](std::vector<FlowMeasure> &of) {
    for (int i = 0; i < count; ++i) of[i] = flow_->measure(i);
  };
  measure(start), before = start;
  const double longest = stage.steady ? longest_steady * stage.duration : stage.duration / stage.load_steps;
  double step = std::min(longest, std::max(first * stage.duration, soil_moves ? flow.shortest_step() : 0)), last = 0,
         range = 0;
  int known = 0;  // steps behind: the first takes what is put on at once, so that the line starts with the second
  *share = 0, *iterations = 0;
  while (*share < 1) {
    double to = stage.steady ? 1 : *share + step / stage.duration;
    if (to > 1 - 1e-9) to = 1;
    const double dt = stage.steady ? step : (to - *share) * stage.duration;
    require(flow.solve(load_at(to), stage.steady ? 0 : load_at(to) - load_at(*share), dt, outcome));
    *iterations += outcome->iterations;
    double error[2]{};  // of the step, and the largest change of pressure so far
    if (outcome->converged) {
      measure(now);
      for (int i = 0; i < count; ++i) {
        error[1] = std::max(error[1], std::abs(now[i].pressure - start[i].pressure));
        if (known < 2) continue;
        const double weight = dt / (dt + last);
        error[0] =
            std::max({error[0], weight * std::abs(now[i].pressure - before[i].pressure - dt * rate[i].pressure) / range,
                      weight * std::abs(now[i].saturation - before[i].saturation - dt * rate[i].saturation)});
      }
      MPI_Allreduce(MPI_IN_PLACE, error, 2, MPI_DOUBLE, MPI_MAX, comm_);
      range = std::max({range, error[1], 1e-300});
    }
    const double least = settings.smallest_step * first * stage.duration;
    if (!outcome->converged || (!stage.steady && error[0] > 2 * settings.step_error && dt > 10 * least)) {
      if (dt / 4 < least) return;
      step = outcome->converged ? dt * std::max(shrinkage, safety * std::sqrt(settings.step_error / error[0])) : dt / 4;
      continue;
    }
    const double stored = flow_->stored();
    require(flow.commit(stage.softening));
    for (int i = 0; i < count; ++i)
      rate[i] = {(now[i].pressure - before[i].pressure) / dt, (now[i].saturation - before[i].saturation) / dt};
    before = now, last = dt, ++known;
    if (stage.steady) {  // what is still stored must be nothing beside what flows
      double flows = 0, stores = stored / dt;
      for (double q : flow_->inflow()) flows += std::abs(q);
      MPI_Allreduce(MPI_IN_PLACE, &stores, 1, MPI_DOUBLE, MPI_SUM, comm_);
      if (stores <= still * flows || step >= longest) *share = 1, done(1);
      step = std::min(longest, steady_growth * step);
      continue;
    }
    *share = to;
    done(to);
    const double wish = known < 2 ? 1 : error[0] > 0 ? safety * std::sqrt(settings.step_error / error[0]) : growth;
    step = std::min(longest, dt * std::clamp(wish, shrinkage, growth));
  }
}

/// Particles take the water of the nodes.
template <int dim>
void Simulation<dim>::fill_pores() {
  if (phases_.liquid) {
    motion_->fill_pores(
        [this](int cell, const Vec<dim> &x) { return flow_->pressure_at(cell, barycentric(mesh_.cells[cell], x)); });
    first_ledger_.clear();
  }
}

/// Nodes take the mean of the particles around them, weighted by volume and shape function.
template <int dim>
void Simulation<dim>::pressure_from_particles() {
  if (phases_.liquid) {
    require(motion_->begin(time_));
    std::vector<double> sum(flow_->nodes().count(), 0), weight = sum;
    for (const auto &body : bodies_) {
      const ParticleArrays<dim> &p = body->particles();
      for (int i = 0; i < p.count; ++i) {
        if (!flow_->active(p.cell[i])) continue;
        const Barycentric<dim> l = barycentric(mesh_.cells[p.cell[i]], p.position[i]);
        for (int a = 0; a <= dim; ++a) {
          const int node = flow_->nodes().of_cell(p.cell[i])[a];
          weight[node] += p.volume[i] * l[a], sum[node] += p.volume[i] * l[a] * motion_->pores(*body, i).liquid;
        }
      }
    }
    require(flow_->nodes().sum(sum));
    require(flow_->nodes().sum(weight));
    for (size_t i = 0; i < sum.size(); ++i)
      if (weight[i] > 0) flow_->accepted[i] = flow_->pressure[i] = sum[i] / weight[i];
  }
}

}  // namespace talus
