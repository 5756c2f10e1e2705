#pragma once
/// Soil nail or dowel, bonded over all of its length.
#include "scene/structures/bar_keys.h"

namespace talus {

struct NailKeys : BarKeys {
  static constexpr const char *name = "nail", *meaning = "soil nail, bonded over all of its length";
  double diameter = 0;  ///< of the grout [m]
  template <class Visitor>
  void fields(Visitor &&v) {
    rod(v);
    v.number("diameter", diameter, metre, Range{0, 10, {0.01, 1, or_zero}}, "diameter of the grouted body");
    v.number("compressive_capacity", compressive_capacity, newton, Range{0, 1e12},
             "axial pressure at which it yields; 0: it bears tension only");
    v.number("plate_capacity", plate_capacity, newton, Range{0, 1e12},
             "force that a plate at the head brings on the soil at most; 0: there is no plate");
  }
  BarKeys bar() const {
    BarKeys keys = *this;
    keys.perimeter = 3.14159265358979323846 * diameter;
    return keys;
  }
};

}  // namespace talus
