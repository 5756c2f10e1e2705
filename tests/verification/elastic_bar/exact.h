#pragma once
/// Elastic bar with nu = 0, held at x = 0, v0 = V sin(pi x / 2 L): omega = (pi / 2 L) sqrt(E / rho), amplitude V /
/// omega at the end, energy constant.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void elastic_bar(Rung &rung) {
  constexpr double E = 100e3, rho = 1000, L = 1, V = 0.1, pi = 3.14159265358979323846;
  const double omega = pi / (2 * L) * std::sqrt(E / rho), period = 2 * pi / omega;
  constexpr int periods = 10;
  for (const int dimension : {2, 3})
    for (const bool remap_always : {false, true}) {
      const std::string point = dimension == 2 ? "[1, 0.05]" : "[1, 0.05, 0.0125]",
                        rest = dimension == 2 ? "]" : ", \"0 * x\"]";
      const Run run = rung.run(in_dimension(
          dimension,
          {"output.point.end.position=" + point, "body.soil.velocity=[\"0.1 * sin(pi * x / 2)\", \"0 * x\"" + rest,
           remap_always ? "transfer.remap_interval=0" : "transfer.remap_interval=0.1"}));
      const auto t = run.history.column("time_s"), x = run.history.column("end_x_m");
      const auto kinetic = run.history.column("kinetic_J"), strain = run.history.column("strain_J");
      // upward passages through the place of rest; between them lie whole periods
      double first = 0, last = 0, low[2]{}, high[2]{}, energy = 0;
      int count = -1;
      for (size_t i = 1; i < t.size(); ++i) {
        const double a = x[i - 1] - x[0], b = x[i] - x[0];
        if (i > 1 && a < 0 && b >= 0) {
          last = t[i - 1] + (t[i] - t[i - 1]) * a / (a - b);
          if (++count == 0) first = last;
        }
        for (const int k : {0, 1})
          if (t[i] > k * (periods - 1) * period && t[i] <= (k * (periods - 1) + 1) * period)
            low[k] = std::min(low[k], b), high[k] = std::max(high[k], b);
        if (t[i] <= periods * period * (1 + 1e-9)) energy = kinetic[i] + strain[i];
      }
      const double amplitude = V / omega * std::sin(pi * x[0] / (2 * L));
      const std::string which = name_of(dimension) + (remap_always ? " remap each step, " : " ");
      const auto state = [&](const std::string &what, double exact, double computed, double tolerance) {
        remap_always ? rung.report(which + what, exact, computed)
                     : rung.compare(which + what, exact, computed, tolerance);
      };
      state("period [s]", period, count > 0 ? (last - first) / count : 0, 0.01);
      state("amplitude in the first period [m]", amplitude, (high[0] - low[0]) / 2, 0.01);
      state("amplitude in the tenth period [m]", amplitude, (high[1] - low[1]) / 2, 0.02);
      state("energy after ten periods over the initial", 1, energy / kinetic[0], 0.02);
    }
}

}  // namespace talus::rungs
