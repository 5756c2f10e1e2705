#pragma once
#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// The liquid beyond the face has this pressure and moves in and out freely; a negative pressure is a suction. The
/// pressure does not load the skeleton.
struct PrescribedPorePressure {
  static constexpr const char *name = "pore_pressure";
  static constexpr const char *meaning = "pressure of the liquid beyond the face";
  static constexpr OnSoil in_motion = OnSoil::none, quasi_static = OnSoil::none;
  static constexpr OnWater water = OnWater::pressure;
  static constexpr OnGas gas = OnGas::atmosphere;
  static constexpr bool open_water = false;
  Function pressure = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("pressure", pressure, pascal, {-1e9, 1e9, {-1e6, 1e7}}, of::place_and_time,
               "pore pressure, function of x, y, z, t; negative for suction");
  }
  double outside(double x, double y, double z, double t, const LiquidBeyond &) const { return pressure(x, y, z, t); }
};

}  // namespace talus
