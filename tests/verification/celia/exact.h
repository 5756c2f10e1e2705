#pragma once
/// Celia, Bouloutas & Zarba (1990): head -1000 cm in the soil and -75 cm on top. Depth of head -500 cm and inflow after
/// 6 h, computed on 1600 cells of a column of 1 m; the front has not come near the base of this one.
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void celia(Rung &rung) {
  constexpr double width = 0.0125, height = 0.4;
  const auto infiltrate = [&](const std::string &what, int dimension, double size, double tolerance,
                              std::vector<std::string> overrides = {}) {
    const double area = dimension == 3 ? width * width : width;
    overrides.push_back("mesh.size=" + number(size));
    if (dimension == 3)
      overrides.push_back("body.soil.stress=[\"0\", \"-17769 * (0.4 - y)\", \"0\", \"0\", \"0\", \"0\"]");
    const Run run = rung.run(in_dimension(dimension, overrides));
    auto cells = cell_means(run.end, "suction", dimension);
    std::sort(cells.begin(), cells.end(), [](const auto &a, const auto &b) { return a.y > b.y; });
    double depth = 0, found = 0;  // of the layers next to 50 kPa, between cells above and below it
    for (size_t k = 1; k < cells.size(); ++k) {
      const double before = cells[k - 1].value, after = cells[k].value;
      if ((before < 50e3) == (after < 50e3)) continue;
      depth += height - (cells[k - 1].y + (50e3 - before) / (after - before) * (cells[k].y - cells[k - 1].y)), ++found;
    }
    const auto water = run.history.column("water_kg"), error = run.history.column("water_error_kg");
    const std::string name = name_of(dimension) + ", " + what + "cells of " + number(size * 1e3) + " mm";
    rung.compare(name + ", depth of head -500 cm [m]", 0.254, depth / found, tolerance);
    rung.compare(name + ", inflow [m]", 0.01741, (water.back() - water.front()) / (1000 * area), tolerance);
    rung.compare(name + ", water error over water", 0, error.back(), 1e-10, water.front());
  };
  infiltrate("", 2, 0.0125, 0.0425);
  infiltrate("", 2, 0.005, 0.01);
  if (!rung.longer()) return;
  infiltrate("", 2, 0.00625, 0.021);
  infiltrate("", 2, 0.003125, 0.01);
  infiltrate("", 3, 0.0125, 0.0425);
  infiltrate("all in motion, raised 4,000-fold, ", 2, 0.0125, 0.0425,
             {"stage.0.duration=1e-6", "stage.1.duration=5.4", "body.soil.hydraulic_conductivity=0.3688",
              "output.history_interval=0.2"});
}

}  // namespace talus::rungs
