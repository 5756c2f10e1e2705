#pragma once
/// Vertical cut in Tresca soil: gamma H / c_u = 3.776 (bounds 3.776 and 3.7776: Pastor, Thai & Francescato 2000, 2009).
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_vertical_cut(Rung &rung) {
  const FactorOfSafety factor = rung.factor_of_safety();
  rung.compare("gamma H / c_u", 3.776, 3.776 * factor.value(), 0.02);
}

}  // namespace talus::rungs
