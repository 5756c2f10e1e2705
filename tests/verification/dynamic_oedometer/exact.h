#pragma once
/// Dynamic oedometer: a load q on an elastic column of height H sends a front down at c = sqrt(E_c / rho); behind it
/// the stress is -q and the soil moves at q / (rho c). Linear theory, valid until the front comes back to the top at 2
/// H / c.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void dynamic_oedometer(Rung &rung) {
  constexpr double E = 180e3, nu = 0.2, rho = 2000, q = 1e3, height = 1;
  const double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), c = std::sqrt(modulus / rho), speed = q / (rho * c);
  for (const int dimension : {2, 3}) {
    const Run run = rung.run(in_dimension(dimension));
    for (const double t : {0.05, 0.1})
      rung.compare(name_of(dimension) + " settlement at " + (t < 0.1 ? "0.05" : "0.1") + " s [m]", speed * t,
                   -at_time(run.history, "load_displacement_y_m", t), 0.0045);
    double late = 0;
    int rows = 0;
    for (double t = 0.02; t < 0.1005; t += 0.001, ++rows)
      late -= at_time(run.history, "load_displacement_y_m", std::min(t, 0.1)) + speed * t;
    rung.compare(name_of(dimension) + " settlement, mean error from 0.02 s over 2.5 mm", 0, late / rows / 0.0025,
                 0.0027, 1);
    // at 0.1 s the front is at the base
    const auto y = component(run.end, "position", 1), stress = component(run.end, "stress", 1),
               volume = component(run.end, "volume");
    const auto mean_stress = [&](double from) {
      double sum = 0, total = 0;
      for (size_t p = 0; p < y.size(); ++p)
        if (y[p] > from && y[p] < from + height / 4) sum += volume[p] * stress[p], total += volume[p];
      return sum / total;
    };
    rung.compare(name_of(dimension) + " mean stress over H/4, H/2 behind the front [Pa]", -q, mean_stress(height / 2),
                 0.01);
    rung.report(name_of(dimension) + " mean stress over H/4, H/4 behind the front [Pa]", -q, mean_stress(height / 4));
  }
}

}  // namespace talus::rungs
