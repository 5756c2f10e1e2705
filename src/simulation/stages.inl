// Stages: what loads them, how long they last, what ends them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "simulation/simulation_impl.h"

namespace talus {

/// Is the time t there, but for round-off?
inline bool reached(double t, double now) { return now >= t * (1 - 1e-12); }

/// The first of the times begin + k interval that is still to come; never for interval 0.
inline double next_time(double begin, double interval, double now) {
  if (interval == 0) return std::numeric_limits<double>::infinity();
  double k = std::max(1., std::floor((now - begin) / interval));
  while (reached(begin + k * interval, now)) ++k;
  return begin + k * interval;
}

template <int dim>
void Simulation<dim>::run() {
  options_.resume ? resume_results() : open_results();
  try {
    if (stage_.number < 0) {
      write_history();
      if (options_.gauss_points && is_static(scene_.stage.front().kind))
        make_statics(), require(activate()), in_statics_ = true;
      write_snapshot(), start_stage(), write_checkpoint();
    }
    while (true) {
      run_stage();
      if (stage_.number + 1 == static_cast<int>(scene_.stage.size())) break;
      start_stage();
    }
  } catch (const RunError &) {
    throw;
  } catch (const std::runtime_error &error) {  // results that cannot be written: say how far the run came
    fail(error.what());
  }
  if (!results_) return;
  note_steps();
  results_->progress.finish();
  int rank;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0 && options_.pictures) draw_pictures(options_.directory, {.fields = scene_.output.picture, .times = {}});
}

/// What the integrator did, for the log.
template <int dim>
void Simulation<dim>::note_steps() {
  const StepStatistics &s = integrator_->statistics();
  if (s.steps == 0) return;  // nothing but equilibria
  const std::pair<long long, const char *> bounds[] = {
      {s.by_error, "the error"}, {s.by_stability, "stability"}, {s.by_schedule, "outputs"}};
  std::ostringstream text;
  text.precision(3);
  text << s.steps << " steps from " << s.shortest << " to " << s.longest << " s, " << s.evaluations
       << " evaluations of the forces, " << s.rejections << " attempts rejected by the error test, " << s.inversions
       << " because a cell turned inside out; steps bounded by";
  for (const auto &[count, what] : bounds)
    text << " " << what << ": " << count << (what == bounds[2].second ? "" : ",");
  note(text.str());
}

template <int dim>
void Simulation<dim>::set_loading(const Stage &stage, double stage_time) {
  const double ramp = stage.gravity_ramp > 0 ? std::min(1., stage_time / stage.gravity_ramp) : 1;
  for (int d = 0; d < dim; ++d) motion_->loading.gravity[d] = scene_.gravity[d];
  motion_->loading.ramp = ramp;
  motion_->loading.ramp_rate = ramp < 1 ? 1 / stage.gravity_ramp : 0;
  motion_->loading.set_at = time_;
  motion_->loading.time_rate = stage.hold_loads ? 0 : 1;
  motion_->loading.time = load_time_;
  motion_->loading.damping = stage.damping;
  motion_->loading.softening = stage.softening;
  motion_->loading.pore_flow = stage.pore_flow;
  hold_loads_ = stage.hold_loads;
}

/// Changes between dashpots and the supports that stand in for them; what these bore stays on as a dead load.
template <int dim>
PetscErrorCode Simulation<dim>::hold_supports(bool held) {
  PetscFunctionBeginUser;
  if (held == conditions_.held() || !conditions_.has_dashpots()) PetscFunctionReturn(0);
  if (motion_->gathered()) PetscCall(release(false));
  if (!held) {
    PetscCall(motion_->freeze_reactions(time_));
    PetscCall(release(false));
  }
  conditions_.hold(held);
  PetscFunctionReturn(0);
}

template <int dim>
void Simulation<dim>::start_stage() {
  const int number = stage_.number + 1;
  stage_ = StageState{};
  stage_.number = number, stage_.begin = time_;
  omega_step_ = -1;
}

template <int dim>
void Simulation<dim>::run_stage() {
  const Stage &stage = scene_.stage[stage_.number];
  if (is_static(stage.kind)) return run_quasi_static(stage);
  in_statics_ = false, moved_since_statics_ = true;
  require(hold_supports(stage.hold_loads));
  stage_name_ = stage.name, watched_ = stage.until == StopWhen::failure ? stage.failure_point : "";
  if (results_) results_->progress.stage(stage.name);
  integrator_->restart();
  const double begin = stage_.begin, end = begin + stage.duration;
  double longest = 0;
  for (const Stage &s : scene_.stage) longest = std::max(longest, s.duration);
  const Output &output = scene_.output;
  const double history_interval = output.history_interval > 0 ? output.history_interval : longest / 200;
  set_loading(stage, time_ - begin);
  while (!stage_.met && !reached(end, time_)) {
    set_loading(stage, time_ - begin);
    const double next_row = next_time(begin, history_interval, time_),
                 next_snapshot = next_time(begin, output.interval, time_);
    const double next_checkpoint =
        next_time(begin, output.checkpoint_interval > 0 ? output.checkpoint_interval : output.interval, time_);
    require(motion_->begin(time_));
    require(step(step_rule(integrator_settings_).fixed > 0 ? end : std::min({end, next_row, next_snapshot})));
    const Verdict verdict = agree();
    refuse(verdict);
    require(remap_due_ ? remap() : motion_->settle());
    if (results_) results_->progress.step(time_, steps_, particle_count_);
    if (reached(next_row, time_)) write_history();
    if (reached(next_snapshot, time_) && !reached(end, time_)) write_snapshot();
    stage_.met = stage_ends(stage, time_ - begin, verdict);
    stage_.told = false;
    if (reached(next_checkpoint, time_) && !reached(end, time_)) write_checkpoint();
    heed_interrupt(verdict);
  }
  if (!stage_.met && !stage_.told && stage.until != StopWhen::duration) {
    Balance sums;
    require(motion_->begin(time_));
    require(motion_->balance(time_, &sums));
    std::ostringstream text;
    text.precision(3);
    text << "stage " << stage.name << " reached its duration of " << stage.duration
         << " s before its stop criterion was met: unbalanced force ratio " << sums.unbalanced / sums.applied
         << ", kinetic over strain energy " << sums.kinetic / sums.strain << ", rms speed "
         << std::sqrt(2 * sums.kinetic / total_mass_) << " m/s";
    note(text.str());
  }
  stage_.told = true;
  write_history();
  write_snapshot();
  write_checkpoint();
  if (stage.reset_displacement) reset_displacement();
}

template <int dim>
bool Simulation<dim>::stage_ends(const Stage &stage, double stage_time, const Verdict &verdict) {
  constexpr int steps_between_checks = 25, checks_of_rest = 8;
  switch (stage.until) {
    case StopWhen::duration:
      return false;
    case StopWhen::equilibrium: {
      if (steps_ % steps_between_checks || stage_time < stage.gravity_ramp) return false;
      Balance sums;
      require(motion_->begin(time_));
      require(motion_->balance(time_, &sums));
      if (sums.unbalanced > stage.force_ratio * sums.applied || sums.kinetic > stage.energy_ratio * sums.strain)
        return false;
      note("stage " + stage.name + " is in equilibrium: unbalanced force ratio " +
           std::to_string(sums.unbalanced / sums.applied));
      return true;
    }
    case StopWhen::rest: {
      if (steps_ % steps_between_checks) return false;
      Balance sums;
      require(motion_->begin(time_));
      require(motion_->balance(time_, &sums));
      stage_.quiet_checks = std::sqrt(2 * sums.kinetic / total_mass_) < stage.rest_speed ? stage_.quiet_checks + 1 : 0;
      if (stage_.quiet_checks < checks_of_rest) return false;
      note("stage " + stage.name + " came to rest");
      return true;
    }
    case StopWhen::failure: {
      // the speed must pass the threshold and be larger at each tenth of the watching time
      const double speed = verdict.watched_speed;
      if (stage_.failure_time < 0) {
        if (speed > stage.failure_speed)
          stage_.failure_time = stage_.last_rise_time = time_, stage_.failure_load_time = load_time_,
          stage_.last_rise_speed = speed;
        return false;
      }
      if (speed < stage.failure_speed)
        stage_.failure_time = -1;
      else if (time_ - stage_.last_rise_time >= stage.failure_time / 10) {
        if (speed <= stage_.last_rise_speed) stage_.failure_time = -1;
        stage_.last_rise_time = time_, stage_.last_rise_speed = speed;
      }
      if (stage_.failure_time < 0 || time_ - stage_.failure_time < stage.failure_time) return false;
      std::ostringstream text;
      text.precision(8);
      text << "failure at " << stage_.failure_time << " s (loads at t = " << stage_.failure_load_time << " s): point "
           << stage.failure_point << " passed " << stage.failure_speed << " m/s and kept accelerating";
      note(text.str());
      events_.back().time = stage_.failure_time, events_.back().load_time = stage_.failure_load_time;
      return true;
    }
  }
  return false;
}

template <int dim>
void Simulation<dim>::reset_displacement() {
  if (motion_->gathered()) require(release(false));
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    std::copy_n(p.position, p.count, p.reference);
    std::fill_n(p.velocity, p.count, Vec<dim>{});
    const auto fields = history_fields(body->law());
    for (size_t k = 0; k < fields.size(); ++k)
      for (int i = 0; !fields[k].kept && i < p.count; ++i) p.history[i * fields.size() + k] = 0;
    for (int a = 0; a < phases_.fluids(); ++a) std::fill_n(p.fluid_velocity[a], p.count, Vec<dim>{});
  }
  critical_step_ = 0, shrink_ = 1;
  integrator_->restart();
}

}  // namespace talus
