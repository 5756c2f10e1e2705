#pragma once
/// Terzaghi's consolidation as in ../terzaghi, at 1e-9 m/s: T = 1 is 11.6 days. Water of 2.2 GPa takes its storage into
/// c_v and p_0. The settlement is that of the skeleton's share of the load: H / E_c (q - mean p) after the load, whose
/// undrained part is (q - p_0) H / E_c.
#include "tests/verification/terzaghi/exact.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_consolidation(Rung &rung) {
  constexpr double modulus = 10e6, porosity = 0.3, bulk = 2.2e9, viscosity = 1e-3, load = 1e3, k = 1e-16;
  constexpr double p0 = load * (bulk / porosity) / (modulus + bulk / porosity);
  const double c_v = k / viscosity / (1 / modulus + porosity / bulk);
  for (const int dimension : {2, 3})
    for (const double T : {0.1, 0.5, 1.}) {
      if (dimension == 3 && T != 0.5 && !rung.longer()) continue;
      const Run run = rung.run(in_dimension(dimension, {"stage.0.duration=" + number(T / c_v)}));
      const auto p = component(run.end, "pore_pressure"), y = component(run.end, "position", 1),
                 u = component(run.end, "displacement", 1);
      double largest = 0, settled = 0, mean = 0;
      for (size_t i = 0; i < p.size(); ++i)
        largest = std::max(largest, std::abs(p[i] / p0 - terzaghi_pressure(1 - y[i], T)));
      for (int m = 0; m < 400; ++m) {
        const double M = (2 * m + 1) * M_PI / 2;
        mean += 2 / (M * M) * std::exp(-M * M * T);
      }
      // of the layer's Gauss points the displacement is compared by its mean, int u = int int strain
      double exact = 0, weight = 0;
      const auto volume = component(run.end, "volume");
      for (size_t i = 0; i < p.size(); ++i) {
        double strained = y[i] * load;  // int_0^y (q - p) dy
        for (int m = 0; m < 400; ++m) {
          const double M = (2 * m + 1) * M_PI / 2;
          strained -= p0 * 2 / (M * M) * (std::cos(M * (1 - y[i])) - std::cos(M)) * std::exp(-M * M * T);
        }
        settled += volume[i] * u[i], exact += volume[i] * strained / modulus, weight += volume[i];
      }
      const std::string name = name_of(dimension) + ", T = " + number(T);
      rung.compare(name + ", largest error of p / p0", 0, largest, 0.01, 1);
      rung.compare(name + ", mean displacement, mm", -1e3 * exact / weight, 1e3 * settled / weight, 0.01);
      rung.report(name + ", degree of consolidation", 1 - mean, 1 - mean, 1);
    }
}

}  // namespace talus::rungs
