#pragma once
/// Ground anchor: a free length behind its head, then a grouted one.
#include "scene/structures/bar_keys.h"

namespace talus {

struct AnchorKeys : BarKeys {
  static constexpr const char *name = "anchor", *meaning = "ground anchor: a free length, then a bonded one";
  double diameter = 0;  ///< of the grout [m]
  template <class Visitor>
  void fields(Visitor &&v) {
    rod(v);
    v.number("diameter", diameter, metre, Range{0, 10, {0.02, 1, or_zero}}, "diameter of the grouted body");
    v.number("free_length", free_length, metre, Range{0, 1e3}, "length behind the head that has no bond with the soil");
    v.number("prestress", prestress, newton, Range{0, 1e12},
             "force in the free length during the stage that installs the anchor; later it goes with the soil");
    v.number("plate_capacity", plate_capacity, newton, Range{0, 1e12},
             "force that the head brings on the soil at most; 0: tensile_capacity");
  }
  BarKeys bar() const {
    BarKeys keys = *this;
    keys.perimeter = 3.14159265358979323846 * diameter;
    if (plate_capacity == 0) keys.plate_capacity = tensile_capacity;
    return keys;
  }
};

}  // namespace talus
