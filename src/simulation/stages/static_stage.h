#pragma once
/// What stages by finite elements have in common: they follow a path of loads in shares of their duration, hand each
/// state to the particles, and say how the path ended.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/rounded.h"
#include "scene/output_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation/changing_loads.h"
#include "simulation/softening.h"
#include "simulation/stages/stage_runner.h"

namespace talus {

template <int dim>
class StaticStage : public StageRunner<dim> {
 public:
  StaticStage(Run<dim> &run, const StaticKeys &keys) : run_(run), stage_(run.stage()), keys_(keys) {}

  void run() final {
    if (!run_.progress.met) {  // a resumed run has it behind it
      begin();
      follow(path_);
      finish();
    }
    if (stage_.reset_displacement) run_.end_by_reset();
  }

 protected:
  /// How far the path of loads was followed.
  struct Path {
    double share = 0;  ///< of the stage
    StepOutcome last;
    int iterations = 0;
  };
  /// Do supports have to hold the soil?
  bool soil_moves() const { return stage_.soil_moves(); }
  bool water_flows() const { return stage_.water_flows(); }
  /// Solves for one state after another and calls `done` after each.
  virtual void follow(Path &path) = 0;
  /// Says what the end of the path is.
  virtual void describe(const Path &path, std::ostream &text) = 0;

  double load_at(double share) const { return stage_.hold_loads ? begin_load_ : begin_load_ + share * stage_.duration; }
  /// A state has been found: particles take it over, and results are written as they come due.
  void done(double share) {
    Clock &clock = run_.clock;
    clock.time = begin_ + share * stage_.duration, clock.load_time = load_at(share), ++clock.steps;
    if (sets_pressure()) run_.statics.take_seeped_pressure();
    refuse_bad_functions();
    run_.hand_to_particles();
    run_.recorder.progress();
    run_.recorder.write_history();
    const double interval = run_.scene.output->interval, elapsed = share * stage_.duration;
    if (interval > 0 && share < 1 && elapsed >= snapshots_ * interval * (1 - 1e-9))
      run_.recorder.write_snapshot(), snapshots_ = std::floor(elapsed / interval * (1 + 1e-9)) + 1;
    int stop = interrupted;
    MPI_Allreduce(MPI_IN_PLACE, &stop, 1, MPI_INT, MPI_MAX, run_.world.comm);
    if (!stop) return;
    run_.recorder.write_snapshot();
    throw RunFailure("interrupted");
  }

  void describe_equilibrium(const Path &path, std::ostream &text) {
    QuasiStatic<dim> &problem = run_.statics.problem();
    text << "stage " << stage_.name << " is in equilibrium: " << problem.unknowns() << " unknowns, " << path.iterations
         << " iterations (" << (problem.direct() ? "LU" : "GMRES and multigrid") << "), largest displacement "
         << problem.soil().largest_displacement() << " m";
    if (const LeftOut<dim> &out = problem.left_out(); out.pieces > 0) {
      text << "; " << out.pieces << (out.pieces == 1 ? " piece" : " pieces") << " of soil, " << out.volume
           << (dim == 3 ? " m3" : " m2") << " or " << 100 * out.share
           << " % of it, that hang on the rest by an edge or a corner and find no hold on the base are left out: they "
              "have no stress and fall when motion begins; the largest is at (";
      for (int d = 0; d < dim; ++d) text << (d ? ", " : "") << std::llround(out.place[d]);
      text << ") m";
    }
  }

  Run<dim> &run_;
  const Stage &stage_;
  const StaticKeys &keys_;

 private:
  /// Do loads come as functions of time or at once, so that a share of the path is none of them?
  bool loads_in_time() const {
    const double begin = load_at(0), end = load_at(1);
    return water_flows() || std::ranges::any_of(changing_loads(run_.scene), [&](const ChangingLoad &load) {
             return std::ranges::any_of(load.when, [&](const TimeSpan &s) { return s.begin < end && s.end > begin; });
           });
  }
  /// Does the flow set the pressure in drained soil?
  bool sets_pressure() const { return run_.world.phases.prescribed && water_flows(); }

  void begin() {
    run_.clock.stage = stage_.name, run_.clock.hold_loads = stage_.hold_loads;
    run_.recorder.begin_stage(stage_);
    run_.dynamics.set_loading(stage_, 0);  // particles take over what is computed, whatever the stage before prescribed
    run_.statics.begin_stage(stage_, soil_moves());
    note_what_moved();
    run_.statics.problem().iterated = [&run = run_](int k, double unbalanced) { run.recorder.seeking(k, unbalanced); };
    begin_strain_ = run_.statics.softening_strain();
    begin_ = run_.clock.time, begin_load_ = run_.clock.load_time;
  }

  /// Soil that finite elements do not have where it is, or stop.
  void note_what_moved() {
    constexpr double visible = 0.01, fast = 0.1;  // of the soil; [m/s]
    const auto &moved = run_.statics.moved();
    if (!moved) return;
    std::ostringstream text;
    text.precision(3);
    if (moved->emptied > visible) {
      text << "stage " << stage_.name << " computes the soil where it lay at the start, and " << 100 * moved->emptied
           << " % of it is there no more: the motion before has carried soil by up to " << moved->way
           << " m. What acts at the ground acts where the ground was"
           << (run_.world.phases.liquid ? ", and water that enters there reaches no particle" : "");
      run_.recorder.warn(text.str());
      text.str("");
    }
    if (moved->speed > fast) {
      text << "stage " << stage_.name << " stops the soil, which was moving at up to " << moved->speed
           << " m/s: finite elements know no motion. A longer stage before it lets the soil come to rest";
      run_.recorder.warn(text.str());
    }
  }

  void refuse_bad_functions() const {
    if (const std::string fault = run_.world.function_fault(); !fault.empty()) throw RunFailure(fault);
  }

  /// A base of small strains lets soil slide any way at no cost, until its force has found a place where it holds.
  void refuse_soil_that_slid_away() const {
    if (!soil_moves()) return;
    const auto &[low, high] = run_.world.mesh_box;
    double square = 0;
    for (int d = 0; d < dim; ++d) square += (high[d] - low[d]) * (high[d] - low[d]);
    const double moved = run_.statics.problem().soil().largest_displacement();
    if (moved <= std::sqrt(square)) return;
    std::ostringstream text;
    text.precision(3);
    text << "stage " << stage_.name << " has no equilibrium: the one that was found has moved the soil by " << moved
         << " m, further than the mesh is long, so it has slid or fallen; let it move in a dynamic stage";
    throw RunFailure(text.str());
  }

  void finish() {
    refuse_bad_functions();  // loads that are no numbers have no equilibrium
    if (const std::string said = run_.statics.take_consolidated_strength(stage_.name); !said.empty())
      run_.recorder.note(said);
    run_.recorder.write_snapshot();
    std::ostringstream text;
    text.precision(3);
    const bool lost = path_.share < 1;
    const char *kind = lost && soil_moves() ? event::equilibrium_lost
                       : lost               ? event::flow_lost
                       : soil_moves()       ? event::equilibrium
                                            : event::stage_end;
    EventValues values{{"iterations", path_.iterations}};
    if (lost) values = {{soil_moves() ? "share_of_loads" : "share_of_duration", path_.share}};
    const auto fail = [&](const std::string &cause) {
      run_.recorder.record({kind, text.str(), values});
      throw RunFailure(cause);
    };
    if (path_.last.stopped) throw RunFailure("interrupted");
    if (lost) {
      text << (soil_moves() ? "no equilibrium beyond " : "no flow was found beyond ") << 100 * path_.share
           << " % of the "
           << (!soil_moves()     ? "duration"
               : loads_in_time() ? "time"
                                 : "loads")
           << " of stage " << stage_.name;
      if (soil_moves() && loads_in_time())
        text << " (" << rounded(path_.share * stage_.duration) << " s of " << rounded(stage_.duration) << " s)";
      text << ": "
           << (path_.last.undrained ? "the soil fails before its pore water can flow"
               : path_.last.fails   ? "a mechanism of failure was found under all of its loads, even with psi = phi"
               : path_.last.crawl > 0
                   ? "steps became as short as " + rounded(path_.last.crawl) + " s, in which no water drains"
               : path_.last.dry  ? "more water is drawn from the soil than it can give: suction passed 1 GPa, at which "
                                   "soil is dry (Fredlund & Xing 1994), or the stiffness of the water"
               : path_.last.shut ? "water that enters has no way out: pore pressure passed 1 GPa"
               : path_.last.singular ? "the stiffness became singular"
                                     : "Newton's iterations did not converge")
           << " (" << path_.last.iterations << " iterations";
      if (!water_flows()) text << ", out-of-balance force " << path_.last.residual << " of the forces";
      if (!water_flows() && path_.last.largest < ran_away)
        text << ", largest step of a node " << path_.last.largest << " m";
      else if (!water_flows())
        text << ", and the displacement ran away";
      text << ")";
      if (water_flows() && !path_.last.fails && !path_.last.dry && !path_.last.shut)
        text << "; a larger quasi_static.step_error or tolerance, a smaller smallest_step, or a load that comes in the "
                "course of an hour rather than at once may help";
      if (!path_.last.moving.empty()) text << "; " << path_.last.moving;
      if (!path_.last.moved_most.empty()) text << "; in the last iteration " << path_.last.moved_most;
      const bool softened = soil_moves() && run_.statics.softening_strain() > begin_strain_;
      if (softened)
        text << "; its soil softens, and beyond its peak there may be no equilibrium that stays near: motion goes on "
                "from here (when_lost = \"next_stage\" and a dynamic stage), and softening = false keeps the strength";
      else if (soil_moves() && !path_.last.moving.empty())
        text
            << "; a base or soil that is too weak there has no equilibrium: let it start by motion, in a dynamic stage "
               "with damping, or make base or soil stronger there; finer or coarser cells may do where it is little "
               "soil";
      else if (soil_moves() && !path_.last.moved_most.empty())
        text << "; either base or soil is too weak there, or a few cells at the rim of the soil that yield keep the "
                "iterations from an equilibrium of the rest. Motion shows which: a dynamic stage with damping, from "
                "the start or (when_lost = \"next_stage\") from here";
      else if (soil_moves() && !path_.last.fails && !path_.last.dry && !path_.last.shut)
        text << "; the slope may be too weak to stand, or other load_steps (here " << keys_.load_steps
             << ") may help, or, where the stage is the first, initial_stress = \"k0\"";
      const bool goes_on = run_.leads_to_factor() && !water_flows();
      if (goes_on && stage_.softening && std::ranges::any_of(run_.world.laws, softens))
        fail(text.str() +
             "; there is no factor of safety, since the strength that is left depends on how far the "
             "loads came, and this on the steps: other load_steps may find the equilibrium; with "
             "softening = false soil keeps the strength that it has at the beginning of the stage");
      if (keys_.when_lost == WhenLost::stop && !goes_on) fail(text.str());
      if (!goes_on && !stage_.hold_loads && stage_.duration > 0)
        text << "; the next stage begins with the loads of t = " << run_.clock.load_time << " s";
      if (goes_on) {
        run_.statics.lost_stages.push_back(stage_.name);
        run_.clock.time = begin_ + stage_.duration, run_.clock.load_time = load_at(1);
      }
    } else {
      refuse_soil_that_slid_away();
      describe(path_, text);
    }
    run_.dynamics.set_loading(stage_, 0);
    const Balance sums = run_.balance();
    if (sums.applied > 0 && soil_moves())
      text << "; unbalanced force ratio of the particles that take it over " << sums.ratio();
    if (sums.applied > 0 && sums.ratio() > swings && soil_moves())
      text << ", by which soil at rest swings as soon as it may move: "
           << (water_flows() || run_.scene.quasi_static->elements == Elements::patches
                   ? ""
                   : "quasi_static.elements = \"patches\" or ")
           << "a dynamic stage with damping and hold_loads after this one lets it rest";
    run_.recorder.note(text.str(), kind, values);
    run_.progress.met = true;
    if (sets_pressure()) run_.statics.take_seeped_pressure();
    if (sets_pressure() && run_.recorder.writes()) run_.statics.save_seeped_pressure(run_.options.directory);
    run_.write_checkpoint();
  }

  static constexpr double swings = 0.01;    ///< unbalanced force ratio
  static constexpr double ran_away = 1000;  ///< displacement of a step that is none of soil [m]
  Path path_;
  double begin_ = 0, begin_load_ = 0;  ///< [s]
  double begin_strain_ = 0;            ///< Statics::softening_strain
  double snapshots_ = 1;               ///< number of the next
};

}  // namespace talus
