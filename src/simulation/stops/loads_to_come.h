#pragma once
/// What a stage has still to bring: until then neither rest nor equilibrium ends it.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "simulation/changing_loads.h"
#include "simulation/run.h"

namespace talus {

/// What will change yet within the duration of the present stage, in words; empty: nothing.
template <int dim>
std::string loads_to_come(const Run<dim> &run) {
  const Stage &stage = run.stage();
  const double since_begin = run.clock.time - run.progress.begin;
  if (since_begin < stage.gravity_ramp) return "gravity still increases";
  if (stage.hold_loads) return "";
  const double now = run.clock.load_time, end = now + stage.duration - since_begin;
  for (const ChangingLoad &load : changing_loads(run.world)) {
    double until = now;
    bool tells = true;
    for (const TimeSpan &span : load.when)
      if (span.begin < end) until = std::max(until, std::min(span.end, end)), tells = tells && std::isfinite(span.end);
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

}  // namespace talus
