#pragma once
#include <algorithm>

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
  /// At the level itself the face is wet: its pressure is that of a film, and not zero, as of a face that may dry.
  double outside(double, double, double, double t, const LiquidBeyond &liquid) const {
    constexpr double film = 1e-6;  // [m]
    const double above = level(t) - liquid.elevation;
    return above > -film ? liquid.unit_weight * std::max(above, film) : 0;
  }
  /// Nothing enters where the face is dry.
  double supply(double, double, double, double) const { return 0; }
};

}  // namespace talus
