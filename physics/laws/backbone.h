#pragma once
#include <array>
#include <cmath>
#include <string>

#include "base/units.h"

namespace talus {

/// Shear stress of soil that is sheared for the first time, tau = G gamma / (1 + (gamma / gamma_r)^a), as straight
/// pieces: springs of shear stiffness g_k in parallel, each with a slider that yields at the shear stress t_k, and one
/// spring without (Iwan 1967). Unloaded and reloaded they follow Masing's rules.
/// Sources: Hardin & Drnevich (1972), J. Soil Mech. Found. Div. 98 (a = 1); Darendeli (2001), Ph.D. thesis, University
/// of Texas at Austin, eqs. (9.2) (a = 0.919) and table 8.12 (gamma_r from the plasticity index).
struct Backbone {
  static constexpr int sliders = 12;

  double reference_strain = 0;         ///< gamma_r, at which G has halved [-]; 0: that of the plasticity index
  double curvature = 0.919;            ///< a [-]; below 0.78 springs of a negative stiffness would follow
  double plasticity_index = -1;        ///< [%]; negative: not given
  double mean_pressure = 101325;       ///< mean effective pressure in situ, for the plasticity index [Pa]
  double overconsolidation_ratio = 1;  ///< likewise [-]

  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("reference_strain", reference_strain, one, Range{0, 0.1, {1e-5, 0.02, or_zero}},
             "angle of shear at which the secant shear modulus is half of that at small strain; or give "
             "plasticity_index");
    v.number("curvature", curvature, one, Range{0.8, 1},
             "exponent a of G / G_max = 1 / (1 + (gamma / reference_strain)^a); 1: hyperbola of Hardin & Drnevich "
             "(1972)");
    v.number("plasticity_index", plasticity_index, one, Range{-1, 300, {0, 200}},
             "plasticity index in per cent, in place of reference_strain, which then follows from it, mean_pressure "
             "and overconsolidation_ratio by Darendeli (2001)");
    v.number("mean_pressure", mean_pressure, pascal, Range{1, 1e8, {5e3, 3e6}},
             "mean effective pressure in situ, beside plasticity_index");
    v.number("overconsolidation_ratio", overconsolidation_ratio, one, Range{1, 100, {1, 20}},
             "overconsolidation ratio, beside plasticity_index");
  }
  std::string problem() const {
    if ((reference_strain > 0) == (plasticity_index >= 0))
      return "reference_strain must be above 0, or plasticity_index must stand in its place: give one of them";
    return "";
  }

  /// gamma_r [-].
  double reference() const {
    if (plasticity_index < 0) return reference_strain;
    constexpr double atmosphere = 101325, per_cent = 0.01;
    return per_cent * (0.0352 + 0.0010 * plasticity_index * std::pow(overconsolidation_ratio, 0.3246)) *
           std::pow(mean_pressure / atmosphere, 0.3483);
  }
  /// tau over G of the curve itself [-].
  double over_modulus(double gamma) const { return gamma / (1 + std::pow(gamma / reference(), curvature)); }

  // Set by discretise().
  std::array<double, sliders> stiffness{}, limit{};  ///< g_k, t_k [Pa]
  double lasting = 0;                                ///< stiffness of the spring without slider [Pa]
  /// The pieces end on the curve at strains from 1/50 to 20 reference strains; the first one, of the modulus at small
  /// strain, begins at 0. Beyond the last one the curve goes on along its tangent.
  void discretise(double shear_modulus) {
    constexpr double first = 0.02, ratio = 1.873817422860384;  // 1000^(1/11)
    const double unit = reference(), last = first * 1000, y = std::pow(last, curvature);
    lasting = shear_modulus * (1 + (1 - curvature) * y) / ((1 + y) * (1 + y));
    std::array<double, sliders> strain, slope;
    strain[0] = first * unit, slope[0] = 1;
    double stress = strain[0];
    for (int k = 1; k < sliders; ++k) {
      strain[k] = ratio * strain[k - 1];
      slope[k] = (over_modulus(strain[k]) - stress) / (strain[k] - strain[k - 1]);
      stress = over_modulus(strain[k]);
    }
    for (int k = 0; k < sliders; ++k) {
      stiffness[k] = shear_modulus * slope[k] - (k + 1 < sliders ? shear_modulus * slope[k + 1] : lasting);
      limit[k] = stiffness[k] * strain[k];
    }
  }
};

}  // namespace talus
