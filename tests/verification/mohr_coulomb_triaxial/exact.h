#pragma once
/// Compression test at a lateral pressure sigma_3: the soil yields at sigma_1 = sigma_3 N + 2 c sqrt(N), N = tan^2(45
/// deg + phi / 2), in plane strain and in triaxial compression alike.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void mohr_coulomb_triaxial(Rung &rung) {
  constexpr double sigma_3 = 50e3, degree = 3.14159265358979323846 / 180;
  struct Soil {
    int phi, cohesion;  // [deg], [kPa]
  };
  for (const int dimension : {2, 3})
    for (const Soil soil : {Soil{35, 5}, {47, 3}, {30, 3}, {40, 1}}) {
      std::vector<std::string> overrides{"body.soil.friction_angle=" + std::to_string(soil.phi),
                                         "body.soil.cohesion=" + std::to_string(1000 * soil.cohesion)};
      if (dimension == 3)
        overrides.insert(overrides.end(),
                         {"boundary.front.kind=roller", "boundary.lateral.group=[\"lateral\", \"back\"]", "dimension=3",
                          "boundary.plate.velocity=[\"0\", \"-0.0005 * min(1, t / 0.1)\", \"0\"]",
                          "body.soil.stress=[\"-50e3\", \"-50e3\", \"-50e3\", \"0\", \"0\", \"0\"]"});
      const Run run = rung.run(overrides);
      const auto stress = component(run.end, "stress", 1), volume = component(run.end, "volume");
      double sum = 0, total = 0;
      for (size_t p = 0; p < stress.size(); ++p) sum += volume[p] * stress[p], total += volume[p];
      const double N = std::pow(std::tan((45 + soil.phi / 2.) * degree), 2);
      const std::string name = name_of(dimension) + " sigma_1, phi " + std::to_string(soil.phi) + " deg, c " +
                               std::to_string(soil.cohesion) + " kPa";
      rung.compare(name + " [Pa]", sigma_3 * N + 2000 * soil.cohesion * std::sqrt(N), -sum / total, 0.005);
    }
}

}  // namespace talus::rungs
