#pragma once
/// Factor of safety 1.38 of example 1 of Griffiths & Lane (1999) by Bishop & Morgenstern's charts; finite elements in
/// steps of 0.05: 1.40 with psi = 0. Its lower estimate has the strength of Davis (1968), c and tan(phi) times the
/// cosine of the reduced phi, with which Spencer's method gives 1.327
/// (docs/gallery/slope_stability/limit_equilibrium.py
/// --davis).
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_slope(Rung &rung) {
  const auto factor = [&](const std::vector<std::string> &overrides) {
    return rung.factor_of_safety(overrides).value();
  };
  rung.compare("psi = phi, factor of safety", 1.38, factor({}), 0.03, 1);
  const FactorOfSafety flat = rung.factor_of_safety({"body.soil.dilation_angle=0"});
  // trials with more are undecided up to 1.41: where the bracket ends between them depends on round-off
  rung.compare("psi = 0, largest factor with an equilibrium", 1.40, flat.lower, 0.05, 1);
  rung.compare("psi = 0, lower estimate by Davis", 1.327, flat.by_flow.at(TrialFlow::davis).value(), 0.04, 1);
  if (rung.longer()) rung.compare("psi = phi, cells of 0.6 m", 1.38, factor({"mesh.size=0.6"}), 0.03, 1);
}

}  // namespace talus::rungs
