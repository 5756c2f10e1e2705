#pragma once
/// Strip footing on weightless Tresca soil: limit load per width N_c c_u, N_c = 2 + pi (Prandtl 1920).
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_footing(Rung &rung) {
  constexpr double cohesion = 10e3, pi = 3.14159265358979323846;
  const auto factor = [&](const std::vector<std::string> &overrides) {
    return -rung.run(overrides).history.column("footing_force_y_N").back() / cohesion;
  };
  rung.compare("N_c", 2 + pi, factor({}), 0.02);
  rung.report("N_c with linear elements and patches", 2 + pi, factor({"quasi_static.elements=patches"}));
  rung.report("N_c with linear elements, which lock", 2 + pi, factor({"quasi_static.elements=linear"}));
}

}  // namespace talus::rungs
