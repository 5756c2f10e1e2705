#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/pores/retention/residual.h"
#include "scene/required.h"

namespace talus {

/// S_e = 1 - s / s_d, for tests and rough soils. Below `tail` it falls exponentially instead, without a kink, so that
/// every water content has one suction.
struct LinearRetention : ResidualWater {
  static constexpr const char *name = "linear";
  static constexpr const char *meaning = "saturation decreases linearly with suction, exponentially below 2 %";
  static constexpr double tail = 0.02;
  double drying_suction = required;  ///< s_d [Pa]
  template <class Visitor>
  void fields(Visitor &&v) {
    ResidualWater::fields(v);
    v.number("drying_suction", drying_suction, pascal, Range{1, 1e9, {300, 1e7}},
             "suction at which the line reaches zero effective saturation");
  }

  double effective(double s) const {
    const double line = 1 - s / drying_suction;
    return s <= 0 ? 1 : line > tail ? line : tail * std::exp(line / tail - 1);
  }
  double slope(double s) const { return s > 0 ? -std::min(1., effective(s) / tail) / drying_suction : 0; }
  double suction(double wet, double dry) const {
    return drying_suction * (wet > tail ? dry : 1 - tail * (1 + std::log(wet / tail)));
  }
};

}  // namespace talus
