#pragma once
/// Factor of safety of example 1 of Hammah et al. (2005): 1.15 by their strength reduction with finite elements, 1.153
/// by Bishop's method. Elements of finite size are too strong by 1 to 3 %.
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_hoek_brown(Rung &rung) {
  rung.compare("psi = phi, factor of safety", 1.15, rung.factor_of_safety({}).value(), 0.03, 1);
  const FactorOfSafety flat = rung.factor_of_safety({"body.rock.dilation_angle=0"});
  rung.compare("psi = 0, largest factor with an equilibrium", 1.15, flat.lower, 0.05, 1);
}

}  // namespace talus::rungs
