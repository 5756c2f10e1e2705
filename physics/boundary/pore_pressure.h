#pragma once
#include "base/units.h"
#include "scene/function.h"

namespace talus {

/// The liquid beyond the face has this pressure; it moves in and out freely. A negative one is a suction. The face
/// carries no other load by it.
struct GivenPorePressure {
  static constexpr const char *name = "pore_pressure";
  static constexpr const char *meaning = "pressure of the liquid beyond the face";
  static constexpr bool water = true;
  Function pressure = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("pressure", pressure, pascal, {-1e9, 1e9},
               "pore pressure, function of x, y, z, t; negative for suction");
  }
  /// P beyond the face [Pa]; `unit_weight` of the liquid [N/m3].
  double outside(double x, double y, double z, double t, double) const { return pressure(x, y, z, t); }
  /// Pressure on the skeleton's face [Pa].
  double load(double) const { return 0; }
};

}  // namespace talus
