#pragma once
/// Factor of safety of example 1 of Hammah et al. (2005): 1.15 by their strength reduction with finite elements, 1.153
/// by Bishop's method. Elements of 0.75 m are too strong by 3 %, those of 0.5 m by 2 %.
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_hoek_brown(Rung &rung) {
  rung.compare("psi = phi, factor of safety", 1.15, rung.factor_of_safety({}).value(), 0.04, 1);
  if (!rung.longer()) return;
  rung.compare("psi = phi, cells of 0.5 m", 1.15, rung.factor_of_safety({"mesh.size=0.5"}).value(), 0.03, 1);
  const FactorOfSafety flat = rung.factor_of_safety({"body.rock.dilation_angle=0"});
  rung.compare("psi = 0, largest factor with an equilibrium", 1.15, flat.lower, 0.05, 1);
}

}  // namespace talus::rungs
