#pragma once
/// Geogrid or geotextile: bears tension only, and slips on both of its faces.
#include "scene/structures/bar_keys.h"

namespace talus {

struct GeogridKeys : BarKeys {
  static constexpr const char *name = "geogrid",
                              *meaning = "geogrid or geotextile: tension only, values per metre of width";
  double width = 0;  ///< of a strip, in 3D [m]
  template <class Visitor>
  void fields(Visitor &&v) {
    strength(v, newton_per_metre);
    v.number("width", width, metre, Range{0, 1e4}, "width of the strip that the line stands for, in 3D");
    bond(v);
    v.number("plate_capacity", plate_capacity, newton_per_metre, Range{0, 1e9},
             "force that a facing at the head brings on the soil at most; 0: the head is free");
    factor(v);
  }
  /// In plane strain the strip is a metre wide.
  BarKeys bar() const {
    const double strip = width > 0 ? width : 1;
    BarKeys keys = *this;
    keys.perimeter = 2 * strip, keys.sheet = true;
    for (double *of_metre : {&keys.axial_stiffness, &keys.tensile_capacity, &keys.plate_capacity}) *of_metre *= strip;
    return keys;
  }
};

}  // namespace talus
