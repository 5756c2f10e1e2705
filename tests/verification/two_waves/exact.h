#pragma once
/// Two waves in a saturated column: a load runs down with water and skeleton together at c_1, behind it at c_2 the skeleton against
/// the water. The stresses at one place and time are those of two independent computations of the linear problem, converged.
#include <cmath>

#include "commands/rung.h"

namespace talus::rungs {

inline void two_waves(Rung &rung) {
  constexpr double height = 0.40014;
  for (const int dimension : {2, 3})
    for (const bool ponded : {false, true}) {
      const Run run = rung.run(in_dimension(dimension, {std::string("boundary.drain.pressure=") + (ponded ? "2e3" : "0")}));
      const auto y = component(run.end, "position", 1), stress = component(run.end, "stress", 1), pressure = component(run.end, "pore_pressure");
      // linear through what lies around the height
      double weight = 0, sigma = 0, p = 0;
      constexpr double reach = 0.015;
      for (size_t i = 0; i < y.size(); ++i) {
        const double w = std::max(0., 1 - std::abs(y[i] - height) / reach);
        weight += w, sigma += w * stress[i], p += w * pressure[i];
      }
      const std::string name = name_of(dimension) + (ponded ? " pressure on top" : " drained top");
      // ringing behind two fronts, a few per cent in any code: the peer's errors are 2.2 to 63 %
      rung.compare(name + ", effective stress [Pa]", ponded ? -734 : -1267, sigma / weight, 0.025, 2000);
      if (!ponded) rung.compare(name + ", pore pressure [Pa]", 734, p / weight, 0.025, 2000);
    }
}

}  // namespace talus::rungs
