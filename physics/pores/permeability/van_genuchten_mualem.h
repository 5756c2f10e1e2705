#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/pores/permeability/wetness.h"
#include "scene/required.h"

namespace talus {

/// k_rl = sqrt(S_e) [1 - (1 - S_e^(1/l))^l]^2, k_rg = sqrt(1 - S_e) (1 - S_e^(1/l))^(2 l). Sources: van Genuchten
/// (1980), eq. (8), after Mualem (1976); Parker, Lenhard & Kuppusamy (1987), eq. (17), for the gas.
struct VanGenuchtenMualem {
  static constexpr const char *name = "van_genuchten_mualem";
  static constexpr const char *meaning = "van Genuchten (1980) after Mualem (1976)";
  double shape = required;  ///< l [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("shape", shape, one, Range{0.02, 0.95, {0.2, 0.85}},
             "exponent lambda = 1 - 1/n, as in the retention curve");
  }

  double liquid(const Wetness &w) const {
    const double film = 1 - std::pow(empty(w), shape);
    return std::sqrt(w.wet) * film * film;
  }
  double gas(const Wetness &w) const { return std::sqrt(w.dry) * std::pow(empty(w), 2 * shape); }

 private:
  double empty(const Wetness &w) const { return -std::expm1(log_wet(w.wet, w.dry) / shape); }  // 1 - S_e^(1/l)
};

}  // namespace talus
