#pragma once
#include <algorithm>

#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// Rain: all of it enters as long as the pressure at the face stays below zero; at zero pressure the rest runs off.
/// Water leaves where its pressure is above zero. Without rain this is a seepage face. Intensity counts per level area,
/// as a rain gauge has it: a slope catches it on the area that it has on the map, and a wall or an overhang none.
struct Rainfall {
  static constexpr const char *name = "rainfall";
  static constexpr const char *meaning =
      "rain, of which the excess runs off at zero pressure; without rain a seepage face";
  static constexpr OnSoil in_motion = OnSoil::none, quasi_static = OnSoil::none;
  static constexpr OnWater water = OnWater::seepage;
  static constexpr OnGas gas = OnGas::atmosphere;
  static constexpr bool open_water = false;
  Function intensity = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("intensity", intensity, metre_per_second, {0, 1e3, {0, 1e-4}}, of::place_and_time,
               "rain, volume per level area and time as a gauge has it, function of x, y, z, t; steep faces get less, "
               "walls none");
  }
  double outside(double, double, double, double, const LiquidBeyond &) const { return 0; }
  double supply(double x, double y, double z, double t, double upward) const {
    return std::max(0., upward) * intensity(x, y, z, t);
  }
};

}  // namespace talus
