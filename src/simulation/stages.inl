// Stages: what loads them, how long they last, what ends them; included only where it is instantiated (src/variants).
#include <algorithm>
#include <cmath>
#include <sstream>

#include "simulation/simulation_impl.h"

namespace talus {

template <int dim, class Phases>
void Simulation<dim, Phases>::run() {
  open_results();
  try {
    write_history();
    write_snapshot();
    for (const Stage &stage : scene_.stage) run_stage(stage);
  } catch (const RunError &) {
    throw;
  } catch (const std::runtime_error &error) {  // results that cannot be written: say how far the run came
    fail(error.what());
  }
  if (!results_) return;
  results_->progress.finish();
  int rank;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0 && options_.pictures) draw_pictures(options_.directory);
}

template <int dim, class Phases>
void Simulation<dim, Phases>::set_loading(const Stage &stage, double stage_time) {
  const double ramp = stage.gravity_ramp > 0 ? std::min(1., stage_time / stage.gravity_ramp) : 1;
  for (int d = 0; d < dim; ++d) motion_->loading.gravity[d] = ramp * scene_.gravity[d];
  motion_->loading.ramp = ramp;
  motion_->loading.time = load_time_;
  motion_->loading.damping = stage.damping;
  motion_->loading.softening = stage.softening;
  hold_loads_ = stage.hold_loads;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::run_stage(const Stage &stage) {
  stage_name_ = stage.name;
  if (results_) results_->progress.stage(stage.name);
  const double begin = time_, end = time_ + stage.duration;
  double longest = 0;
  for (const Stage &s : scene_.stage) longest = std::max(longest, s.duration);
  const double history_interval = scene_.output.history_interval > 0 ? scene_.output.history_interval : longest / 200;
  long long rows = 1, snapshots = 1;
  quiet_checks_ = 0, failure_time_ = -1, watched_ = stage.until == StopWhen::failure ? stage.failure_point : "";
  bool ended = false;
  while (!ended && time_ < end * (1 - 1e-12)) {
    set_loading(stage, time_ - begin);
    const double next_row = begin + rows * history_interval;
    const double next_snapshot = scene_.output.interval > 0 ? begin + snapshots * scene_.output.interval : end;
    require(motion_->begin(time_));
    require(step(choose_step(std::min({end, next_row, next_snapshot}))));
    const Verdict verdict = agree();
    refuse(verdict);
    if (remap_due_) require(remap());
    if (results_) results_->progress.step(time_, steps_, particle_count_);
    if (time_ >= next_row * (1 - 1e-12)) write_history(), ++rows;
    if (time_ >= next_snapshot * (1 - 1e-12) && time_ < end * (1 - 1e-12)) write_snapshot(), ++snapshots;
    ended = stage_ends(stage, time_ - begin, verdict);
  }
  if (!ended && stage.until != StopWhen::duration) {
    Balance sums;
    require(motion_->begin(time_));
    require(motion_->balance(time_, &sums));
    std::ostringstream text;
    text.precision(3);
    text << "stage " << stage.name << " reached its duration of " << stage.duration << " s before its stop criterion was met: unbalanced force ratio "
         << sums.unbalanced / sums.applied << ", kinetic over strain energy " << sums.kinetic / sums.strain << ", rms speed "
         << std::sqrt(2 * sums.kinetic / total_mass_) << " m/s";
    note(text.str());
  }
  write_history();
  write_snapshot();
  if (stage.reset_displacement) reset_displacement();
}

template <int dim, class Phases>
bool Simulation<dim, Phases>::stage_ends(const Stage &stage, double stage_time, const Verdict &verdict) {
  constexpr int steps_between_checks = 25, checks_of_rest = 8;
  switch (stage.until) {
    case StopWhen::duration: return false;
    case StopWhen::equilibrium: {
      if (steps_ % steps_between_checks || stage_time < stage.gravity_ramp) return false;
      Balance sums;
      require(motion_->begin(time_));
      require(motion_->balance(time_, &sums));
      if (sums.unbalanced > stage.force_ratio * sums.applied || sums.kinetic > stage.energy_ratio * sums.strain) return false;
      note("stage " + stage.name + " is in equilibrium: unbalanced force ratio " + std::to_string(sums.unbalanced / sums.applied));
      return true;
    }
    case StopWhen::rest: {
      if (steps_ % steps_between_checks) return false;
      Balance sums;
      require(motion_->begin(time_));
      require(motion_->balance(time_, &sums));
      quiet_checks_ = std::sqrt(2 * sums.kinetic / total_mass_) < stage.rest_speed ? quiet_checks_ + 1 : 0;
      if (quiet_checks_ < checks_of_rest) return false;
      note("stage " + stage.name + " came to rest");
      return true;
    }
    case StopWhen::failure: {
      // the speed must pass the threshold and be larger at each tenth of the watching time
      const double speed = verdict.watched_speed;
      if (failure_time_ < 0) {
        if (speed > stage.failure_speed) failure_time_ = last_rise_time_ = time_, failure_load_time_ = load_time_, last_rise_speed_ = speed;
        return false;
      }
      if (speed < stage.failure_speed) failure_time_ = -1;
      else if (time_ - last_rise_time_ >= stage.failure_time / 10) {
        if (speed <= last_rise_speed_) failure_time_ = -1;
        last_rise_time_ = time_, last_rise_speed_ = speed;
      }
      if (failure_time_ < 0 || time_ - failure_time_ < stage.failure_time) return false;
      std::ostringstream text;
      text.precision(8);
      text << "failure at " << failure_time_ << " s (loads at t = " << failure_load_time_ << " s): point " << stage.failure_point << " passed "
           << stage.failure_speed << " m/s and kept accelerating";
      note(text.str());
      events_.back().time = failure_time_, events_.back().load_time = failure_load_time_;
      return true;
    }
  }
  return false;
}

template <int dim, class Phases>
void Simulation<dim, Phases>::reset_displacement() {
  if (motion_->gathered()) require(release(false));
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    std::copy_n(p.position, p.count, p.reference);
    std::fill_n(p.velocity, p.count, Vec<dim>{});
    if (p.history) std::fill_n(p.history, p.count * body->history_count(), 0.);
  }
  critical_step_ = 0, shrink_ = 1;
}

}  // namespace talus
