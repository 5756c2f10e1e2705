#pragma once
#include "base/units.h"
#include "scene/function.h"

namespace talus {

/// The soil beyond the face has this suction, its gas being at atmospheric pressure.
struct GivenSuction {
  static constexpr const char *name = "suction";
  static constexpr const char *meaning = "suction beyond the face";
  static constexpr bool water = true;
  Function suction = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("suction", suction, pascal, {0, 1e9}, "suction, function of x, y, z, t");
  }
  double outside(double x, double y, double z, double t, double) const { return -suction(x, y, z, t); }
  double load(double) const { return 0; }
};

}  // namespace talus
