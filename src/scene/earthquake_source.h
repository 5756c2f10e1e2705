#pragma once
/// A component of the motion of the ground in an earthquake: what it is taken from, and how that is corrected and
/// scaled.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/deferred.h"

namespace talus {

struct EarthquakeSource {
  std::vector<double> direction;  ///< of the motion; empty: x [-]
  double begin = 0, end = 0;      ///< part of the record that is used; end = 0: all of it [s]
  int baseline = 0;               ///< degree of the polynomial that is taken from the velocity; 0: none
  double high_pass = 0;           ///< corner frequency; 0: none [Hz]
  double scale = 1;               ///< factor of the acceleration; of -1 the motion is reversed [-]
  double peak = 0;                ///< largest acceleration, to which it is scaled; 0: as it is [m/s2]
  DeferredTable kind;             ///< "kind" and its parameters, read by src/earthquake
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("direction", direction, one,
            "direction of the motion, one component per dimension, two in a slice of a section, of any length; "
            "default: along x");
    v.number("begin", begin, second, Range{0, 1e5}, "where the part of the record begins that is used");
    v.number("end", end, second, Range{0, 1e5}, "where it ends; 0: with the record");
    v.integer("baseline", baseline, Range{0, 6, {0, 3}},
              "baseline correction: degree of the polynomial, 0 at the begin, that is fitted to the velocity and taken "
              "from it; 0: none");
    v.number("high_pass", high_pass, hertz, Range{0, 100, {0.02, 1, or_zero}},
             "corner frequency of a high-pass filter without change of phase, of the fourth order; 0: none");
    v.number("scale", scale, one, Range{-1e3, 1e3, {-10, 10}}, "factor of the acceleration");
    v.number("peak", peak, metre_per_second_squared, Range{0, 30, {0.1, 15, or_zero}},
             "peak ground acceleration to which the record is scaled, in place of scale; 0: as it is");
    v.deferred("kind", kind, "what the motion is taken from; its parameters are keys of the same table");
  }
  std::string problem() const {
    if (end > 0 && end <= begin) return "end must be later than begin";
    if (peak > 0 && scale != 1) return "scale has no effect beside peak: leave one of them out";
    return "";
  }
};

}  // namespace talus
