#pragma once
/// Forces are in balance, and the soil has no kinetic energy to speak of.
#include "base/units.h"
#include "scene/stages/traits.h"

namespace talus {

struct AtEquilibrium {
  static constexpr const char *name = "equilibrium", *meaning = "the soil is in equilibrium";
  static constexpr StopTraits traits{.early = true, .waits_for_loads = true, .settles = true};
  double force_ratio = 1e-3;   ///< unbalanced over applied force [-]
  double energy_ratio = 1e-6;  ///< kinetic over strain energy [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("force_ratio", force_ratio, one, Range{0, 1, {1e-6, 0.05}},
             "equilibrium: largest ratio of unbalanced to applied nodal forces");
    v.number("energy_ratio", energy_ratio, one, Range{0, 1, {1e-12, 1e-2}},
             "equilibrium: largest ratio of kinetic to elastic strain energy");
  }
};

}  // namespace talus
