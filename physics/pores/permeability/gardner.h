#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/pores/permeability/wetness.h"
#include "scene/required.h"

namespace talus {

/// k_rl = exp(-alpha s), Gardner (1958); the gas takes what the water leaves, k_rg = 1 - S_e.
struct GardnerPermeability {
  static constexpr const char *name = "gardner";
  static constexpr const char *meaning = "exponential in suction, Gardner (1958)";
  double decay_suction = required;  ///< 1 / alpha [Pa]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("decay_suction", decay_suction, pascal, Range{1, 1e9, {300, 1e7}},
             "suction 1 / alpha over which permeability falls by a factor e");
  }

  double liquid(const Wetness &w) const { return std::exp(-w.suction / decay_suction); }
  double gas(const Wetness &w) const { return w.dry; }
};

}  // namespace talus
