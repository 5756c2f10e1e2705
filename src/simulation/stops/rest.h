#pragma once
/// The root mean square speed of the soil stays below a limit and does not rise, for as long as soil out of balance
/// would take to pass the limit, while nothing that acts on it has still to change. A large model that stands may hide
/// soil that still slides: the end is said to be rest only where none does.

#include <cmath>

#include "physics/phase_models.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation/run.h"
#include "simulation/still_moving.h"
#include "simulation/stops/loads_to_come.h"

namespace talus {

template <int dim>
class StopAtRest final : public StopCriterion<dim> {
 public:
  StopAtRest(const Stage &stage, const AtRest &keys) : stage_(stage), keys_(keys) {}

  bool met(Run<dim> &run, const Verdict &) override {
    constexpr int steps_between_checks = 25, checks_of_rest = 8;
    if (run.clock.steps % steps_between_checks) return false;
    const double speed = run.rms_speed(run.balance());
    quiet_checks_ = speed < keys_.rest_speed ? quiet_checks_ + 1 : 0;
    if (quiet_checks_ == 1) first_speed_ = speed, quiet_since_ = run.clock.time;
    quiet_for_ = quiet_checks_ > 0 ? run.clock.time - quiet_since_ : 0, needed_ = time_of_rest(run.scene);
    if (quiet_checks_ < checks_of_rest || quiet_for_ < needed_) return false;
    quiet_checks_ = 0;                       // unless all is over, it is looked at for as long again
    if (speed > first_speed_) return false;  // soil that sets out is slow too
    if (loads_to_come_.hold_up(run, "the rms speed of all soil is below rest_speed", still_to_come(run))) return false;
    if (const auto left = still_moving(run.world.comm, run.recorder.snapshot()))
      run.recorder.note("stage " + stage_.name + " ended: the rms speed of all soil is below rest_speed = " +
                            rounded(keys_.rest_speed) + " m/s, but " + left->sentence(),
                        event::slow, {{"rest_speed_m_s", keys_.rest_speed}});
    else
      run.recorder.note("stage " + stage_.name + " came to rest", event::rest);
    return true;
  }
  std::string unmet(double speed) const override {
    if (speed >= keys_.rest_speed) return "";
    const std::string why = waits_for();
    return ", which is below rest_speed" +
           (why.empty() ? " but has not stayed there without rising" : " but is no rest: " + why);
  }
  void serialize(Archive &archive) override { archive.serialize("rest", quiet_checks_, first_speed_, quiet_since_); }

 private:
  /// Time in which soil out of balance by a small share of its weight passes the limit; damping of the stage takes its
  /// share of that force [s].
  double time_of_rest(const Scene &scene) const {
    constexpr double out_of_balance = 0.02;
    double square = 0;
    for (const double a : scene.acceleration_in(stage_)) square += a * a;
    const double driving = out_of_balance * (1 - stage_.damping()) * std::sqrt(square);
    return driving > 0 ? keys_.rest_speed / driving : 0;
  }
  /// What it waits for though the soil is slow; empty: nothing.
  std::string waits_for() const {
    if (!loads_to_come_.why().empty() || quiet_for_ == 0 || quiet_for_ >= needed_) return loads_to_come_.why();
    return "it was so for " + rounded(quiet_for_) + " s, and soil that sets out may take " + rounded(needed_) +
           " s to pass it; a smaller rest_speed or less damping takes less time";
  }
  /// Water that moves may set soil in motion later, as rain does that seeps in.
  std::string still_to_come(const Run<dim> &run) {
    if (const std::string load = loads_to_come_(run); !load.empty()) return load;
    if (stage_.hold_loads || !stage_.pore_flow || !fluids_move(run.scene.phases)) return "";
    return "pore fluids move; with hold_loads = true it would end when the soil is at rest";
  }

  const Stage &stage_;
  const AtRest &keys_;
  int quiet_checks_ = 0;    ///< in a row
  double first_speed_ = 0;  ///< at the first of them [m/s]
  double quiet_since_ = 0;  ///< time of the first of them [s]
  LoadsToCome<dim> loads_to_come_;
  double quiet_for_ = 0, needed_ = 0;  ///< time of quiet at the last check, and what rest takes [s]
};

}  // namespace talus
