#pragma once
/// The root mean square speed of the soil stays below a limit while nothing that acts on it still has to change in this
/// or a later stage. A large model that stands may hide soil that still slides: the end is said to be rest only where
/// none does. `ended_at_rest` (commands/comparison.h) reads these words.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "simulation/changing_loads.h"
#include "simulation/run.h"
#include "simulation/still_moving.h"

namespace talus {

template <int dim>
class StopAtRest final : public StopCriterion<dim> {
 public:
  explicit StopAtRest(const Stage &stage) : stage_(stage) {}

  bool met(Run<dim> &run, const Verdict &) override {
    constexpr int steps_between_checks = 25, checks_of_rest = 8;
    if (run.clock.steps % steps_between_checks) return false;
    const Balance sums = run.balance();
    quiet_checks_ = std::sqrt(2 * sums.kinetic / run.world.total_mass) < stage_.rest_speed ? quiet_checks_ + 1 : 0;
    if (quiet_checks_ < checks_of_rest) return false;
    if (const std::string load = still_to_come(run); !load.empty()) {
      if (!told_) run.recorder.note("all soil is at rest, but the stage " + stage_.name + " goes on: " + load);
      told_ = true, quiet_checks_ = 0;  // what comes needs time to set soil in motion
      return false;
    }
    if (const auto left = still_moving(run.world.comm, run.recorder.snapshot()))
      run.recorder.note("stage " + stage_.name + " ended: the rms speed of all soil is below rest_speed = " +
                        rounded(stage_.rest_speed) + " m/s, but " + left->sentence());
    else
      run.recorder.note("stage " + stage_.name + " came to rest");
    return true;
  }
  void serialize(Archive &archive) override { archive.serialize("rest", quiet_checks_); }

 private:
  /// What will change yet before the run is over, unless a later stage is there for it; empty: nothing.
  std::string still_to_come(const Run<dim> &run) const {
    if (run.clock.time - run.progress.begin < stage_.gravity_ramp) return "gravity still increases";
    const auto later = run.scene.stage.begin() + run.progress.number + 1;
    if (stage_.hold_loads || std::any_of(later, run.scene.stage.end(), [](const Stage &s) { return !s.hold_loads; }))
      return "";
    for (const ChangingLoad &load : changing_loads(run.world)) {
      if (load.until <= run.clock.load_time) continue;
      std::ostringstream text;
      text << load.key << (std::isinf(load.until) ? " is a function of t" : " changes until t = ");
      if (std::isfinite(load.until)) text << load.until << " s";
      text << "; hold_loads = true would keep loads as they are";
      return text.str();
    }
    return "";
  }

  const Stage &stage_;
  int quiet_checks_ = 0;  ///< in a row
  bool told_ = false;     ///< why the stage goes on
};

}  // namespace talus
