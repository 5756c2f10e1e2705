#pragma once
/// Terzaghi's consolidation, drained at the top: p / p_0 = sum (2 / M) sin(M Z) exp(-M^2 T), M = (2m + 1) pi / 2, Z
/// depth below the top over H, T = c_v t / H^2. A liquid that gives way takes its storage into both p_0 and c_v.
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline double terzaghi_pressure(double depth, double T) {
  double sum = 0;
  for (int m = 0; m < 400; ++m) {
    const double M = (2 * m + 1) * M_PI / 2;
    sum += 2 / M * std::sin(M * depth) * std::exp(-M * M * T);
  }
  return sum;
}

inline void terzaghi(Rung &rung) {
  constexpr double modulus = 10e6, porosity = 0.3, soft = 75e6, water_itself = 2.2e9, viscosity = 1e-3, load = 1e3;
  const auto consolidate = [&](int dimension, double k, double T, bool implicit = false) {
    const double bulk = implicit ? water_itself : soft;
    const double p0 = load * (bulk / porosity) / (modulus + bulk / porosity);
    const double c_v = k / viscosity / (1 / modulus + porosity / bulk);
    const std::string stress =
        "body.soil.stress=[0, " + number(p0 - load) + ", 0, 0" + (dimension == 3 ? ", 0, 0]" : "]");
    const Run run = rung.run(in_dimension(
        dimension,
        {stress, "body.soil.permeability=" + number(k), "water.excess=" + number(p0),
         "water.bulk_modulus=" + number(bulk), std::string("water.pressure=") + (implicit ? "implicit" : "explicit"),
         "stage.0.duration=" + number(T / c_v), "output.history_interval=" + number(T / c_v / 20)}));
    double largest = 0, square = 0, count = 0;
    for (const CellMeans &cell : cell_means(run.end, "pore_pressure", dimension)) {
      const double error = cell.value / p0 - terzaghi_pressure(1 - cell.y, T);
      largest = std::max(largest, std::abs(error)), square += error * error, ++count;
    }
    const std::string name =
        name_of(dimension) + (implicit ? " implicit, k = " : " k = ") + number(k) + " m2, T = " + number(T);
    rung.compare(name + ", rms error of p / p0", 0, std::sqrt(square / count), 0.01, 1);
    rung.report(name + ", largest error of p / p0", 0, largest, 1);
    const double water = run.history.column("water_kg").front();
    rung.compare(name + ", water stored less initial, in and out", 0, run.history.column("water_error_kg").back(),
                 1e-10, water);
  };
  for (const double T : {0.1, 0.5, 1.}) consolidate(2, 1e-10, T);
  consolidate(2, 1e-12, 0.01);
  consolidate(3, 1e-10, 0.1);
  consolidate(2, 1e-10, 0.1, true);
  consolidate(2, 1e-12, 0.01, true);
  consolidate(3, 1e-10, 0.1, true);
  if (!rung.longer()) return;
  for (const double T : {0.1, 0.5, 1.}) consolidate(2, 1e-12, T);
  for (const double T : {0.5, 1.}) consolidate(3, 1e-10, T);
}

}  // namespace talus::rungs
