#pragma once
/// What a stage has still to bring: until then neither rest nor equilibrium ends it.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "scene/stage.h"
#include "simulation/changing_loads.h"
#include "simulation/run.h"

namespace talus {

/// What the scene will change yet within the duration of the present stage.
template <int dim>
class LoadsToCome {
 public:
  /// In words; empty: nothing.
  std::string operator()(const Run<dim> &run) {
    const Stage &stage = run.stage();
    const double since_begin = run.clock.time - run.progress.begin;
    if (since_begin < stage.gravity_ramp()) return "gravity still increases";
    if (stage.shakes() && since_begin < run.world.shaking.duration()) return "the ground still shakes";
    if (stage.hold_loads) return "";
    if (!known_) loads_ = changing_loads(run.scene), known_ = true;
    const double now = run.clock.load_time, end = now + stage.duration - since_begin;
    for (const ChangingLoad &load : loads_) {
      double until = now;
      bool tells = true;
      for (const TimeSpan &span : load.when)
        if (span.begin < end)
          until = std::max(until, std::min(span.end, end)), tells = tells && std::isfinite(span.end);
      if (until <= now) continue;
      std::ostringstream text;
      text << load.key;
      if (tells)
        text << " changes until t = " << until << " s";
      else
        text << " is a function of t";
      text << "; hold_loads = true would keep loads as they are";
      return text.str();
    }
    return "";
  }
  /// Says once why a stage goes on though the soil is as the stage asks, `state`. True unless `why` is empty.
  bool hold_up(Run<dim> &run, const std::string &state, const std::string &why) {
    why_ = why;
    if (why.empty()) return false;
    if (!run.recorder.happened(event::waits_for_loads, run.progress.begin))
      run.recorder.note(state + ", but the stage " + run.stage().name + " goes on: " + why, event::waits_for_loads);
    return true;
  }
  const std::string &why() const { return why_; }

 private:
  std::vector<ChangingLoad> loads_;  ///< of the scene, once they are known
  std::string why_;                  ///< the stage went on when it was last asked
  bool known_ = false;
};

}  // namespace talus
