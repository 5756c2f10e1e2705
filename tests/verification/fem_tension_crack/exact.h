#pragma once
/// Factor of safety of ACADS 1(b) with a tension crack full of water: 1.592 by Spencer's and 1.596 by Bishop's method
/// (Slide2 verification manual, problem 2; Giam & Donald 1989: 1.65 to 1.70). Without a crack the slope is stronger.
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_tension_crack(Rung &rung) {
  const double wet = rung.factor_of_safety({}).value();
  rung.compare("crack full of water, factor of safety", 1.592, wet, 0.05, 1);
  const double dry = rung.factor_of_safety({"factor_of_safety.crack_water=-1e5"}).value();
  rung.compare("dry crack over crack full of water, above 1", 1.02, dry / wet, 0.02, 1);
}

}  // namespace talus::rungs
