#pragma once
/// Celia, Bouloutas & Zarba (1990), Water Resour. Res. 26(7), 1483-1496, with the parameters of their fig. 5: depth at
/// which the head is -500 cm and the water that came in, computed on 1600 cells (an independent computation,
/// converged).
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_infiltration(Rung &rung) {
  constexpr double width = 0.00333333, gamma = 9810;
  for (const auto &[hours, depth, entered] : {std::tuple{6., 0.254, 0.01741}, {24., 0.565, 0.04113}}) {
    if (hours > 6 && !rung.longer()) break;
    const Run run = rung.run({"stage.0.duration=" + number(3600 * hours)});
    const auto p = component(run.end, "pore_pressure"), y = component(run.end, "position", 1);
    std::vector<size_t> order(p.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return y[a] > y[b]; });
    double front = 1;
    for (size_t k = 1; k < order.size() && front == 1; ++k) {
      const double above = p[order[k - 1]] + 5 * gamma, below = p[order[k]] + 5 * gamma;
      if (below <= 0 && above > 0)
        front = 1 - (y[order[k]] + (y[order[k - 1]] - y[order[k]]) * below / (below - above));
    }
    const auto time = run.history.column("time_s"), inflow = run.history.column("top_inflow_m3_s");
    double water = 0;
    for (size_t i = 1; i < time.size(); ++i) water += (time[i] - time[i - 1]) * inflow[i] / width;
    const std::string name = number(hours) + " h: ";
    rung.compare(name + "depth of the head -500 cm, m", depth, front, 0.01);
    rung.compare(name + "water that came in, m", entered, water, 0.01);
    rung.report(name + "steps", 0, static_cast<double>(run.steps), 1);
  }
}

}  // namespace talus::rungs
