#pragma once
/// Two waves in a saturated column: a load runs down with water and skeleton together at c_1, behind it at c_2 the
/// skeleton against the water. The stresses at one place and time are those of two independent computations of the
/// linear problem, converged.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void two_waves(Rung &rung) {
  constexpr double height = 0.40014, share = 0.01;  // of the load of 2 kPa, so that the problem is the linear one
  const auto wave = [&](int dimension, bool ponded, double size, double load, double tolerance, bool claimed) {
    const Run run = rung.run(in_dimension(
        dimension, {"mesh.size=" + number(size), "mesh.thickness=" + number(size),
                    "boundary.load.pressure=" + number(load), "boundary.drain.pressure=" + number(ponded ? load : 0)}));
    const auto y = component(run.end, "position", 1), stress = component(run.end, "stress", 1),
               pressure = component(run.end, "pore_pressure");
    // linear through what lies around the height
    double weight = 0, sigma = 0, p = 0;
    constexpr double reach = 0.015;
    for (size_t i = 0; i < y.size(); ++i) {
      const double w = std::max(0., 1 - std::abs(y[i] - height) / reach);
      weight += w, sigma += w * stress[i], p += w * pressure[i];
    }
    const double scale = 2000 / load / weight;
    const std::string name = name_of(dimension) + ", cells of " + number(size * 1e3) + " mm, " +
                             (load < 2000 ? "" : "full load, ") + (ponded ? "pressure on top" : "drained top");
    const auto put = [&](const std::string &quantity, double exact, double value) {
      claimed ? rung.compare(name + quantity, exact, value, tolerance, 2000)
              : rung.report(name + quantity, exact, value, 2000);
    };
    put(", effective stress [Pa]", ponded ? -734 : -1267, scale * sigma);
    if (!ponded) put(", pore pressure [Pa]", 734, scale * p);
  };
  for (const int dimension : {2, 3})
    for (const bool ponded : {false, true}) {
      // behind two fronts stress rings, by a part that falls with the cells, and differs from mesh to mesh by as much:
      // up to 2.8 % in cells of 11.5 to 13.5 mm; the exact values have three digits
      wave(dimension, ponded, 0.0125, share * 2000, 0.03, true);
      if (dimension == 2 || !ponded || rung.longer()) wave(dimension, ponded, 0.0025, share * 2000, 0.005, true);
    }
  wave(2, false, 0.0025, 2000, 0.01, false);  // the face crosses a cell, and nothing is linear any more
}

}  // namespace talus::rungs
