#pragma once
/// Factor of safety of ACADS 1(b) with a tension crack full of water: 1.592 by Spencer's and 1.596 by Bishop's method
/// (Slide2 verification manual, problem 2; Giam & Donald 1989: 1.65 to 1.70). Elements of a tenth of the height are too
/// strong by 1 to 3 %.
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_tension_crack(Rung &rung) {
  rung.compare("crack full of water, factor of safety", 1.592, rung.factor_of_safety({}).value(), 0.03, 1);
}

}  // namespace talus::rungs
