#pragma once
/// Green & Ampt (1911): water that ponds at zero pressure on dry soil goes down behind a sharp front, K t = F - psi
/// dtheta ln[1 + F / (psi dtheta)], F the depth of water that has entered. psi is the suction at the front, the
/// integral of k_rl over suction (Neuman 1976): for Brooks & Corey's curves P_e [1 + 1 / (3 l + 1)].
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void green_ampt(Rung &rung) {
  constexpr double width = 0.0125, height = 0.4, conductivity = 0.02, index = 8, seconds = 0.6 + 2.575;
  const double psi = 0.1 * (1 + 1 / (3 * index + 1)), emptied = 0.4 * (1 - std::pow(3., -index)), scale = psi * emptied;
  double inflow = conductivity * seconds;  // by Newton's iteration
  for (int k = 0; k < 50; ++k)
    inflow -= (inflow - scale * std::log1p(inflow / scale) - conductivity * seconds) * (scale + inflow) / inflow;
  const auto infiltrate = [&](int dimension, double size, double tolerance) {
    const double area = dimension == 3 ? width * width : width;
    std::vector<std::string> overrides{"mesh.size=" + number(size)};
    if (dimension == 3)
      overrides.push_back("body.soil.stress=[\"0\", \"-15900 * (0.4 - y)\", \"0\", \"0\", \"0\", \"0\"]");
    const Run run = rung.run(in_dimension(dimension, overrides));
    double soaked = 0, cells = 0;
    for (const CellMeans &cell : cell_means(run.end, "saturation", dimension)) soaked += cell.value > 0.5, ++cells;
    const auto water = run.history.column("water_kg"), error = run.history.column("water_error_kg");
    const std::string name = name_of(dimension) + ", cells of " + number(size * 1e3) + " mm";
    rung.compare(name + ", inflow [m]", inflow, (water.back() - water.front()) / (1000 * area), tolerance);
    // cells counted: known to a cell
    rung.compare(name + ", depth of the front [m], error over cell", inflow / emptied, height * soaked / cells, 1,
                 size);
    rung.compare(name + ", water error over water", 0, error.back(), 1e-10, water.back());
  };
  // 0.2 % a millimetre of the cells, as with any scheme that takes the mean conductivity; the rest is the start anew of
  // water that is handed over
  infiltrate(2, 0.00625, 0.0125);
  if (!rung.longer()) return;
  infiltrate(2, 0.005, 0.01);
  infiltrate(2, 0.003125, 0.01);
  infiltrate(3, 0.0125, 0.025);
}

}  // namespace talus::rungs
