#pragma once
/// Celia, Bouloutas & Zarba (1990): head -1000 cm in the soil and -75 cm on top. Depth of head -500 cm and inflow after 6 h, computed on 1600 cells of a column of
/// 1 m; the front has not come near the base of this one.
#include <algorithm>
#include <cmath>

#include "commands/rung.h"
#include "tests/verification/cell_means.h"

namespace talus::rungs {

inline void celia(Rung &rung) {
  const auto infiltrate = [&](int dimension, double size, double tolerance) {
    constexpr double width = 0.05, height = 0.5, thickness = 0.0125;
    const double area = dimension == 3 ? width * thickness : width;
    std::vector<std::string> overrides{"mesh.size=" + number(size)};
    if (dimension == 3) overrides.push_back("body.soil.stress=[\"0\", \"-17769 * (0.5 - y)\", \"0\", \"0\", \"0\", \"0\"]");
    const Run run = rung.run(in_dimension(dimension, overrides));
    auto cells = cell_means(run.end, "suction", dimension);
    std::sort(cells.begin(), cells.end(), [](const auto &a, const auto &b) { return a.y > b.y; });
    double depth = 0, found = 0;  // of the layers next to 50 kPa, between cells above and below it
    for (size_t k = 1; k < cells.size(); ++k) {
      const double before = cells[k - 1].value, after = cells[k].value;
      if ((before < 50e3) == (after < 50e3)) continue;
      depth += height - (cells[k - 1].y + (50e3 - before) / (after - before) * (cells[k].y - cells[k - 1].y)), ++found;
    }
    const std::string name = name_of(dimension) + ", cells of " + number(size * 1e3) + " mm";
    rung.compare(name + ", depth of head -500 cm [m]", 0.254, depth / found, tolerance);
    rung.compare(name + ", inflow [m]", 0.01741, -run.history.column("water_out_kg").back() / (1000 * area), tolerance);
    rung.compare(name + ", water error over water", 0, run.history.column("water_error_kg").back(), 1e-10, run.history.column("water_kg").front());
  };
  infiltrate(2, 0.0125, 0.05);
  if (!rung.longer()) return;
  infiltrate(2, 0.00625, 0.05);
  infiltrate(2, 0.003125, 0.05);
  infiltrate(3, 0.0125, 0.05);
}

}  // namespace talus::rungs
