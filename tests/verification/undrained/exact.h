#pragma once
/// Skempton's B: of a change of mean total stress water takes B = 1 / (1 + n K / K_l), whatever the strain, as grains
/// do not compress.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void undrained(Rung &rung) {
  constexpr double K = 20e6 / (3 * (1 - 2 * 0.25)), n = 0.4;
  for (const int dimension : {2, 3})
    for (const double bulk : {1e6, 1e8, 2.2e9}) {
      const std::string plate = std::string("boundary.plate.velocity=[\"0\", \"-1e-4 * min(1, t / 0.1)\"") +
                                (dimension == 3 ? ", \"0\"]" : "]");
      const Run run = rung.run(in_dimension(dimension, {plate, "water.bulk_modulus=" + number(bulk)}));
      const auto pressure = component(run.end, "pore_pressure"), volume = component(run.end, "volume");
      double u = 0, mean = 0, total = 0;
      for (int k = 0; k < 3; ++k) {
        const auto stress = component(run.end, "stress", k);
        for (size_t p = 0; p < volume.size(); ++p) mean -= volume[p] * stress[p] / 3;
      }
      for (size_t p = 0; p < volume.size(); ++p) u += volume[p] * pressure[p], total += volume[p];
      // small strains, so that 0.01 % is what products of strain leave
      rung.compare(name_of(dimension) + " B for K_l = " + number(bulk / 1e6) + " MPa", 1 / (1 + n * K / bulk),
                   u / (u + mean), 1e-3);
      rung.compare(name_of(dimension) + " water error over water", 0, run.history.column("water_error_kg").back(),
                   1e-12, run.history.column("water_kg").front());
    }
}

}  // namespace talus::rungs
