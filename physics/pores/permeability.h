#pragma once
/// Permeability of the pores to liquid and gas: the list of relative permeabilities (one line to add one; a plain
/// struct with `liquid(w)` and `gas(w)` from 0 to 1), and how the intrinsic permeability follows porosity.
#include <cmath>
#include <variant>

#include "physics/pores/permeability/brooks_corey.h"
#include "physics/pores/permeability/constant.h"
#include "physics/pores/permeability/gardner.h"
#include "physics/pores/permeability/hillel.h"
#include "physics/pores/permeability/van_genuchten_mualem.h"
#include "scene/permeability_change.h"

namespace talus {

using RelativePermeability =
    std::variant<ConstantPermeability, VanGenuchtenMualem, Hillel, BrooksCoreyPermeability, GardnerPermeability>;

inline double liquid_permeability(const RelativePermeability &curve, const Wetness &w) {
  return std::visit([&](const auto &one) { return one.liquid(w); }, curve);
}
inline double gas_permeability(const RelativePermeability &curve, const Wetness &w) {
  return std::visit([&](const auto &one) { return one.gas(w); }, curve);
}

/// k / k_0 at porosity n over that at n_0: Kozeny (1927) and Carman (1937), n^3 / (1 - n)^2; or ((1 - n_0) / (1 -
/// n))^2, with which consolidation at large strain has a closed form (Gibson, England & Hussey 1967).
inline double permeability_factor(PermeabilityChange change, double n, double n0) {
  const double grains = (1 - n0) / (1 - n);
  switch (change) {
    case PermeabilityChange::none:
      return 1;
    case PermeabilityChange::kozeny_carman:
      return grains * grains * (n / n0) * (n / n0) * (n / n0);
    case PermeabilityChange::grain_share:
      return grains * grains;
  }
  return 1;
}

}  // namespace talus
