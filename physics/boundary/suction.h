#pragma once
#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// The soil beyond the face has this suction, its gas being at atmospheric pressure.
struct PrescribedSuction {
  static constexpr const char *name = "suction";
  static constexpr const char *meaning = "suction beyond the face";
  static constexpr OnSoil in_motion = OnSoil::none, quasi_static = OnSoil::none;
  static constexpr OnWater water = OnWater::pressure;
  static constexpr OnGas gas = OnGas::atmosphere;
  static constexpr bool open_water = false;
  Function suction = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("suction", suction, pascal, {0, 1e9, {0, 1e6}}, of::place_and_time, "suction, function of x, y, z, t");
  }
  double outside(double x, double y, double z, double t, const LiquidBeyond &) const { return -suction(x, y, z, t); }
};

}  // namespace talus
