#pragma once
#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// Volume of liquid that enters per area and time, whatever pressure that takes.
struct Flux {
  static constexpr const char *name = "flux";
  static constexpr const char *meaning = "liquid pumped through the face";
  static constexpr OnSoil in_motion = OnSoil::none, quasi_static = OnSoil::none;
  static constexpr OnWater water = OnWater::flux;
  static constexpr OnGas gas = OnGas::atmosphere;
  Function inflow = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("inflow", inflow, metre_per_second, {-1e3, 1e3, {-1e-2, 1e-2}}, of::place_and_time,
               "volume of liquid that enters per area and time, function of x, y, z, t; negative for outflow; taken at "
               "the nodes of the face where water moves with the soil, "
               "so that a jump is spread over an edge");
  }
};

}  // namespace talus
