#pragma once
/// The soil fails at a point.
#include <string>

#include "base/units.h"
#include "scene/stages/traits.h"

namespace talus {

struct AtFailure {
  static constexpr const char *name = "failure", *meaning = "the soil fails at a point";
  static constexpr StopTraits traits{.early = true};
  std::string failure_point;    ///< named output point that is watched
  double failure_speed = 0.01;  ///< its mean speed passes this [m/s] ...
  double failure_time = 1;      ///< ... over this time [s]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("failure_point", failure_point, "failure: name of the output point whose velocity is tested");
    v.number("failure_speed", failure_speed, metre_per_second, Range{0, 1e6, {1e-4, 1}},
             "failure: speed that the mean velocity of the point over failure_time must exceed");
    v.number("failure_time", failure_time, second, Range{0, 1e9, {0.01, 60}},
             "failure: time of this mean, no shorter than the period of the slowest vibration; from half of it on, the "
             "soil must "
             "store less than a fifth of the energy that it receives");
  }
};

}  // namespace talus
