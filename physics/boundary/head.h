#pragma once
#include <algorithm>
#include <limits>

#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// Open water up to a level: below it the face bears the hydrostatic pressure of the water, above it the face is a
/// seepage face.
struct Head {
  static constexpr const char *name = "head";
  static constexpr const char *meaning =
      "open water up to a level, whose weight acts on the face; above the level a seepage face";
  static constexpr OnSoil in_motion = OnSoil::none, quasi_static = OnSoil::none;
  static constexpr OnWater water = OnWater::seepage;
  static constexpr OnGas gas = OnGas::atmosphere;
  static constexpr bool open_water = true;
  Function level = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("level", level, metre, {-1e5, 1e5}, of::time, "elevation of the water level, along `up`, function of t");
  }
  /// At the level itself, to round-off, the face is wet: its pressure is the least above zero, and not that of a face
  /// which may dry.
  double outside(double, double, double, double t, const LiquidBeyond &liquid) const {
    constexpr double round_off = 1e-6;  // [m]
    const double above = level(t) - liquid.elevation;
    if (above < -round_off || !(liquid.unit_weight > 0)) return 0;
    return std::max(liquid.unit_weight * above, std::numeric_limits<double>::min());
  }
  /// Nothing enters where the face is dry.
  double supply(double, double, double, double, double) const { return 0; }
};

}  // namespace talus
