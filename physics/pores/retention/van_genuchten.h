#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/pores/permeability/wetness.h"
#include "physics/pores/retention/residual.h"
#include "scene/required.h"

namespace talus {

/// S_e = [1 + (s / P_0)^(1 / (1 - l))]^(-l). Source: van Genuchten (1980), with Mualem's restriction m = 1 - 1/n, so l
/// = m. His alpha is rho_w g / P_0 per metre of head.
struct VanGenuchten : ResidualWater {
  static constexpr const char *name = "van_genuchten";
  static constexpr const char *meaning = "smooth retention curve of van Genuchten (1980)";
  double reference_suction = required;  ///< P_0 [Pa]
  double shape = required;              ///< l = 1 - 1/n [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    ResidualWater::fields(v);
    v.number("reference_suction", reference_suction, pascal, Range{1, 1e9, {300, 1e7}},
             "suction P_0 = rho_w g / alpha that scales the curve");
    v.number("shape", shape, one, Range{0.02, 0.95, {0.1, 0.85}}, "exponent lambda = 1 - 1/n");
  }

  double effective(double s) const {
    return s > 0 ? std::pow(1 + std::pow(s / reference_suction, 1 / (1 - shape)), -shape) : 1;
  }
  double slope(double s) const {
    if (!(s > 0)) return 0;
    const double x = std::pow(s / reference_suction, 1 / (1 - shape));
    return -shape / (1 - shape) * x / s * std::pow(1 + x, -shape - 1);
  }
  double suction(double wet, double dry) const {
    return reference_suction * std::pow(std::expm1(-log_wet(wet, dry) / shape), 1 - shape);
  }
};

}  // namespace talus
