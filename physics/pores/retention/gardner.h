#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/pores/permeability/wetness.h"
#include "physics/pores/retention/residual.h"
#include "scene/required.h"

namespace talus {

/// S_e = exp(-alpha s). Source: Gardner (1958); with the relative permeability of the same name and rate Richards'
/// equation is linear.
struct Gardner : ResidualWater {
  static constexpr const char *name = "gardner";
  static constexpr const char *meaning = "exponential retention curve, Gardner (1958)";
  double decay_suction = required;  ///< 1 / alpha [Pa]
  template <class Visitor>
  void fields(Visitor &&v) {
    ResidualWater::fields(v);
    v.number("decay_suction", decay_suction, pascal, Range{1, 1e9, {300, 1e7}},
             "suction 1 / alpha over which effective saturation falls by a factor e");
  }

  double effective(double s) const { return s > 0 ? std::exp(-s / decay_suction) : 1; }
  double slope(double s) const { return s > 0 ? -std::exp(-s / decay_suction) / decay_suction : 0; }
  double suction(double wet, double dry) const { return -decay_suction * log_wet(wet, dry); }
};

}  // namespace talus
