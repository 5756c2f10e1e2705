#pragma once
/// Srivastava & Yeh (1991): conductivity over height and time in a soil of Gardner's kind between a water table and a
/// flux that rises from q_A to q_B, in z = alpha y, t = alpha K_s t / (theta_s - theta_r), L = alpha H.
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline double srivastava_yeh_conductivity(double z, double t, double L, double q_a, double q_b) {
  double sum = 0;
  for (int k = 1; k <= 60; ++k) {  // roots of tan(l L) = -2 l, one in each ((k - 1/2) pi / L, k pi / L)
    double low = (k - 0.5) * M_PI / L * (1 + 1e-12), high = k * M_PI / L;
    for (int i = 0; i < 100; ++i) {
      const double middle = (low + high) / 2;
      (std::sin(middle * L) + 2 * middle * std::cos(middle * L)) * (k % 2 ? 1 : -1) > 0 ? low = middle : high = middle;
    }
    const double l = low;
    sum += std::sin(l * z) * std::sin(l * L) * std::exp(-l * l * t) / (1 + L / 2 + 2 * l * l * L);
  }
  return q_b - (q_b - 1) * std::exp(-z) - 4 * (q_b - q_a) * std::exp((L - z) / 2) * std::exp(-t / 4) * sum;
}

inline void srivastava_yeh(Rung &rung) {
  constexpr double alpha = 20, height = 0.5, K_s = 1e-2, porosity = 0.4, decay = 500;
  const auto infiltrate = [&](int dimension, double t, bool implicit = false) {
    const double seconds = t * porosity / (alpha * K_s);
    std::vector<std::string> overrides{"stage.0.duration=" + number(seconds)};
    if (implicit) overrides.insert(overrides.end(), {"water.pressure=implicit", "water.bulk_modulus=2.2e9"});
    if (dimension == 3)
      overrides.push_back(
          "body.soil.stress=[\"0\", \"-10 * (1630 * (0.5 - y) + 18 * exp(-20 * y))\", \"0\", \"0\", \"0\", \"0\"]");
    const Run run = rung.run(in_dimension(dimension, overrides));
    double square = 0, total = 0;
    for (const CellMeans &cell : cell_means(run.end, "suction", dimension)) {
      const double error =
          std::exp(-cell.value / decay) - srivastava_yeh_conductivity(alpha * cell.y, t, alpha * height, 0.1, 0.9);
      square += error * error, ++total;
    }
    const std::string name = name_of(dimension) + (implicit ? " implicit," : "") + " t* = " + number(t);
    rung.compare(name + ", rms error of K / K_s", 0, std::sqrt(square / total), 0.01, 1);
    rung.compare(name + ", water error over water", 0, run.history.column("water_error_kg").back(), 1e-10,
                 run.history.column("water_kg").front());
  };
  infiltrate(2, 0.5);
  infiltrate(2, 2);
  infiltrate(2, 0.5, true);
  if (!rung.longer()) return;
  infiltrate(2, 6);
  infiltrate(3, 2);
  infiltrate(2, 2, true);
}

}  // namespace talus::rungs
