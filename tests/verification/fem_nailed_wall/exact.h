#pragma once
/// Factor of safety of a soil-nailed wall, test slope 7 of Pockoski & Duncan (2000): 0.98 by finite elements with
/// reduction of strength (RS2), 1.009 by Spencer's method (Slide2), 1.02 (UTEXAS4).
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_nailed_wall(Rung &rung) {
  const auto factor = [&](const std::vector<std::string> &overrides) {
    return rung.factor_of_safety(overrides).value();
  };
  rung.compare("factor of safety", 0.98, factor({}), 0.03);
}

}  // namespace talus::rungs
