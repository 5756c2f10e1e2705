#pragma once
/// The list of retention curves: one line to add one. A curve is a plain struct:
/// - `effective(s)`: effective saturation S_e at a suction s [Pa]; 1 at s <= 0; falls monotonically
/// - `slope(s)`: dS_e / ds [1/Pa]
/// - `suction(wet, dry)`: the inverse for 0 < wet = S_e <= 1; dry = 1 - S_e is handed over as well, without its
/// round-off
/// - `residual_saturation`, `fields`, `problem` as for laws
#include <variant>

#include "physics/pores/retention/brooks_corey.h"
#include "physics/pores/retention/gardner.h"
#include "physics/pores/retention/linear.h"
#include "physics/pores/retention/tabulated.h"
#include "physics/pores/retention/van_genuchten.h"

namespace talus {

using Retention = std::variant<VanGenuchten, BrooksCorey, Gardner, LinearRetention, TabulatedRetention>;

inline double residual_saturation(const Retention &curve) {
  return std::visit([](const auto &one) { return static_cast<double>(one.residual_saturation); }, curve);
}
/// Degree of saturation S_l at a suction [Pa], docs/theory/pores.md (1.1).
inline double saturation(const Retention &curve, double suction) {
  const double residual = residual_saturation(curve);
  return residual + (1 - residual) * std::visit([&](const auto &one) { return one.effective(suction); }, curve);
}
/// dS_l / ds [1/Pa], not positive.
inline double saturation_slope(const Retention &curve, double suction) {
  return (1 - residual_saturation(curve)) * std::visit([&](const auto &one) { return one.slope(suction); }, curve);
}
/// Suction [Pa] at effective saturation `wet` = 1 - `dry`.
inline double suction_at(const Retention &curve, double wet, double dry) {
  return std::visit([&](const auto &one) { return one.suction(wet, dry); }, curve);
}

}  // namespace talus
