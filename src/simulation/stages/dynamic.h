#pragma once
/// Motion by the material point method until the stop criterion is met or the duration is over.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "scene/output_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation/stages/stage_runner.h"
#include "simulation/still_moving.h"

namespace talus {

template <int dim>
class DynamicStage final : public StageRunner<dim> {
 public:
  DynamicStage(Run<dim> &run, const DynamicKeys &keys) : run_(run), stage_(run.stage()), keys_(keys) {}

  void run() override {
    begin();
    while (!run_.progress.met && !reached(end(), run_.clock.time)) advance();
    finish();
  }

 private:
  /// Is the time t there, but for round-off?
  static bool reached(double t, double now) { return now >= t * (1 - 1e-12); }
  /// The first of the times begin + k interval that is still to come; never for interval 0.
  static double next_time(double begin, double interval, double now) {
    if (interval == 0) return std::numeric_limits<double>::infinity();
    double k = std::max(1., std::floor((now - begin) / interval));
    while (reached(begin + k * interval, now)) ++k;
    return begin + k * interval;
  }
  double end() const { return run_.progress.begin + stage_.duration; }

  void begin() {
    const bool handed_over = run_.statics.current();
    if (run_.clock.time == run_.progress.begin) run_.energies.begin_stage();
    run_.statics.leave();
    require(run_.world.fix_dashpots(stage_.hold_loads, run_.clock.time));
    run_.clock.stage = stage_.name;
    if (run_.world.structures) run_.world.structures->begin_stage(stage_);
    run_.recorder.begin_stage(stage_);
    run_.dynamics.restart();
    const std::string point = run_.stop->watched_point();
    run_.dynamics.watch = nullptr;
    if (!point.empty())
      run_.dynamics.watch = [&points = run_.points, point](Vec<3> *v) { return points.velocity(point, v); };
    double longest = 0;
    for (const Stage &s : run_.scene.stage) longest = std::max(longest, s.duration);
    const Output &output = *run_.scene.output;
    history_interval_ = output.history_interval > 0 ? output.history_interval : longest / 200;
    checkpoint_interval_ = output.checkpoint_interval > 0 ? output.checkpoint_interval : output.interval;
    set_loading();
    if (!stage_.pore_flow)
      run_.statics.forget_nodes();
    else if (handed_over)
      run_.statics.remember_nodes();
  }
  void set_loading() { run_.dynamics.set_loading(stage_, run_.clock.time - run_.progress.begin); }

  /// One step and what is written after it.
  void advance() {
    const double begin = run_.progress.begin, &now = run_.clock.time;
    const double row = next_time(begin, history_interval_, now),
                 snapshot = next_time(begin, run_.scene.output->interval, now),
                 checkpoint = next_time(begin, checkpoint_interval_, now);
    set_loading();
    const Verdict verdict = run_.dynamics.cycle(run_.dynamics.fixed_step() ? end() : std::min(end(), snapshot));
    run_.balance_ranks(end());
    run_.recorder.progress();
    watch_energy();
    if (reached(row, now)) run_.recorder.write_history();
    if (reached(snapshot, now) && !reached(end(), now)) run_.recorder.write_snapshot();
    run_.progress.met = run_.stop->met(run_, verdict);
    run_.progress.told = false;
    if (reached(checkpoint, now) && !reached(end(), now)) run_.write_checkpoint();
    run_.heed(verdict);
  }

  /// A motion that has created more energy than there was goes on no further.
  void watch_energy() {
    constexpr int steps_between_looks = 100;
    if (run_.clock.steps % steps_between_looks) return;
    if (const std::string created = run_.energies.look(); !created.empty())
      run_.recorder.warn(created, event::created_energy);
    if (!run_.energies.watch().beyond_all()) return;
    run_.recorder.write_history();
    throw MotionFailure(run_.energies.watch().verdict());
  }

  void finish() {
    if (!run_.progress.met && !run_.progress.told && keys_.stop().early && !run_.is_past_stage()) note_unmet();
    run_.progress.told = true;
    run_.recorder.write_history();
    run_.recorder.write_snapshot();
    run_.write_checkpoint();
    note_softened();
    if (run_.last_stage()) find_motion_left();  // before a reset sets it to zero
    if (stage_.reset_displacement) note_reset(), run_.end_by_reset();
  }

  /// Bars that motion has computed softer than they are, so that they do not shorten its steps.
  void note_softened() {
    if (!run_.world.structures) return;
    for (const Bar<dim> &bar : run_.world.structures->bars()) {
      if (bar.softened >= 1) continue;
      std::ostringstream text;
      text.precision(2);
      text << "structure." << bar.name << " moved with at least " << 100 * bar.softened
           << " % of its stiffness, so that it does not shorten the step; its capacities are its own";
      run_.recorder.note(text.str());
    }
  }

  void note_reset() {
    std::ostringstream text;
    text.precision(3);
    const double largest = run_.world.largest_displacement();
    text << "stage " << stage_.name << " sets displacements to zero, of up to " << largest << " m";
    run_.recorder.note(text.str(), event::reset, {{"largest_displacement_m", largest}});
  }

  void find_motion_left() {
    const auto left = still_moving(run_.world.comm, run_.recorder.snapshot());
    if (!left) return;
    std::ostringstream text;
    text << "the slide has not come to rest at t = " << run_.clock.time << " s: " << left->sentence() << "; ";
    if (!run_.progress.met)
      text << "a longer duration of the stage " << stage_.name;
    else if (keys_.stop().by_mean_speed)  // of all soil, most of which may stand
      text << "the rms speed of all soil is below rest_speed, and a smaller rest_speed of the stage " << stage_.name;
    else
      text << "a further stage";
    text << " would show where it stops";
    if (run_.recorder.writes() && (!run_.progress.met || keys_.stop().by_mean_speed))
      text << " (--resume goes on with it)";
    run_.motion_left = text.str();
  }

  void note_unmet() {
    const Balance sums = run_.balance();
    const double speed = run_.rms_speed(sums);
    std::ostringstream text;
    text.precision(3);
    text << "stage " << stage_.name << " reached its duration of " << stage_.duration
         << " s before its stop criterion was met: unbalanced force ratio " << sums.ratio()
         << ", kinetic over strain energy " << (sums.kinetic > 0 ? sums.kinetic / sums.strain : 0) << ", rms speed "
         << speed << " m/s" << run_.stop->unmet(speed);
    run_.recorder.note(text.str(), event::duration_over,
                       {{"unbalanced_force_ratio", sums.ratio()}, {"rms_speed_m_s", speed}});
  }

  Run<dim> &run_;
  const Stage &stage_;
  const DynamicKeys &keys_;
  double history_interval_ = 0, checkpoint_interval_ = 0;  ///< [s]
};

}  // namespace talus
