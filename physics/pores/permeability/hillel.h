#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/pores/permeability/wetness.h"

namespace talus {

/// k_rl = S_e^m, k_rg = (1 - S_e)^m. Source: Hillel (1971), with m = 3.
struct Hillel {
  static constexpr const char *name = "hillel";
  static constexpr const char *meaning = "a power of saturation, Hillel (1971)";
  double exponent = 3;  ///< m [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("exponent", exponent, one, Range{0.5, 20, {1, 10}}, "power of the effective saturation");
  }

  double liquid(const Wetness &w) const { return std::pow(w.wet, exponent); }
  double gas(const Wetness &w) const { return std::pow(w.dry, exponent); }
};

}  // namespace talus
