#pragma once
#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// The gas beyond the face has this gauge pressure and moves in and out freely; liquid only leaves. The pressure does
/// not load the skeleton.
struct PrescribedGasPressure {
  static constexpr const char *name = "gas_pressure";
  static constexpr const char *meaning = "pressure of the gas beyond the face; liquid may leave but not enter";
  static constexpr OnSoil in_motion = OnSoil::none, quasi_static = OnSoil::none;
  static constexpr OnWater water = OnWater::outflow;
  static constexpr OnGas gas = OnGas::pressure;
  Function pressure = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("pressure", pressure, pascal, {-1e6, 1e9, {-1e5, 1e6}}, of::place_and_time,
               "gauge pressure of the gas, function of x, y, z, t");
  }
  double gas_outside(double x, double y, double z, double t) const { return pressure(x, y, z, t); }
};

}  // namespace talus
