#pragma once
/// Where a run stands.
#include <string>

#include "base/archive.h"

namespace talus {

/// Stage of the mechanism of a factor of safety, the last row of the history and the last snapshot of a run that ends
/// with one.
inline constexpr const char *strength_reduction = "strength reduction";

struct Clock {
  double time = 0;          ///< since the start of the run [s]
  double load_time = 0;     ///< what functions of the scene see as t [s]
  double last_step = 0;     ///< [s]
  long long steps = 0;      ///< since the start of the run
  bool hold_loads = false;  ///< the load time stands still
  std::string stage;        ///< name of the present stage; empty before the first

  /// A step was taken [s].
  void advance(double step) {
    time += step, last_step = step, ++steps;
    if (!hold_loads) load_time += step;
  }
  void serialize(Archive &archive) { archive.serialize("clock", time, load_time, last_step, steps, hold_loads); }
};

}  // namespace talus
