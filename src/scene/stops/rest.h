#pragma once
/// The soil has come to rest.
#include "base/units.h"
#include "scene/stages/traits.h"

namespace talus {

struct AtRest {
  static constexpr const char *name = "rest", *meaning = "the soil is at rest";
  static constexpr StopTraits traits{.early = true, .waits_for_loads = true, .by_mean_speed = true};
  double rest_speed = 1e-3;  ///< the root mean square speed of all soil stays below this [m/s]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("rest_speed", rest_speed, metre_per_second, Range{0, 1e6, {1e-5, 0.1}},
             "rest: the root mean square speed of all soil remains below this value and does not rise; a stage "
             "does not end while what acts has still to change within its duration, or pore fluids move, unless "
             "hold_loads = true");
  }
};

}  // namespace talus
