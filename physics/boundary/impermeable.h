#pragma once
#include "physics/boundary/kind.h"

namespace talus {

/// No fluid passes. Faces that support the soil (fixed, roller, velocity, friction) state the same of themselves.
struct Impermeable {
  static constexpr const char *name = "impermeable";
  static constexpr const char *meaning = "no fluid passes";
  static constexpr OnSoil in_motion = OnSoil::none, quasi_static = OnSoil::none;
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::wall;
  template <class Visitor>
  void fields(Visitor &&) {}
};

}  // namespace talus
