#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/pores/permeability/wetness.h"
#include "scene/required.h"

namespace talus {

/// k_rl = S_e^((2 + 3 l) / l), k_rg = (1 - S_e)^2 [1 - S_e^((2 + l) / l)]. Source: Brooks & Corey (1964), eqs. (14),
/// (15), after Burdine (1953).
struct BrooksCoreyPermeability {
  static constexpr const char *name = "brooks_corey";
  static constexpr const char *meaning = "Brooks & Corey (1964) after Burdine (1953)";
  double pore_size_index = required;  ///< l [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("pore_size_index", pore_size_index, one, Range{0.05, 20, {0.1, 5}},
             "exponent lambda, as in the retention curve");
  }

  double liquid(const Wetness &w) const { return std::pow(w.wet, 3 + 2 / pore_size_index); }
  double gas(const Wetness &w) const {
    return -w.dry * w.dry * std::expm1(log_wet(w.wet, w.dry) * (1 + 2 / pore_size_index));
  }
};

}  // namespace talus
