#pragma once
#include <algorithm>
#include <string>

#include "base/units.h"
#include "physics/laws/lanes.h"
#include "physics/laws/stress.h"
#include "scene/quantity.h"
#include "scene/required.h"

namespace talus {

/// Cohesion, friction and dilation, which may decrease with plastic strain: the strength of the frictional laws. Source
/// of the softening: Alonso, Yerro & Pinyol (2015), eqs. (18), (19).
///
/// With `reads_shares` a point has the shares Surroundings::cohesion of c and Surroundings::friction of phi, peak and
/// residual alike. A scene that gives c or phi as a function of the place sets it and leaves NaN in the function's
/// place, which strength_by_place.h replaces by the function's largest value; others may set it too.
struct FrictionalStrength {
  double cohesion = required;                   ///< c, peak [Pa]
  double friction_angle = required;             ///< phi, peak [rad]
  bool reads_shares = false;                    ///< c and phi of a point are shares of these
  bool consolidates = false;                    ///< stages set the shares (SHANSEP), which are then part of the state
  double dilation_angle = 0;                    ///< psi, never above the current phi [rad]
  double residual_cohesion = -1;                ///< [Pa]; negative: the peak
  double residual_friction_angle = -degree.si;  ///< [rad]; negative: the peak
  double residual_dilation_angle = -degree.si;  ///< [rad]; negative: the peak
  double shape_factor = 0;                      ///< eta: strength falls with exp(-eta plastic_strain) [-]
  double reference_size = 0;                    ///< h_ref: eta is multiplied by h / h_ref [m]; 0: it is not
  double residual_ratio = -1;                   ///< of c and tan(phi) to those of the peak [-]; negative: not given

  template <class Visitor>
  void fields(Visitor &&v) {
    v.by_place("cohesion", cohesion, reads_shares, pascal, Range{0, 1e9, {100, 1e8, or_zero}},
               "cohesion c, at its peak if the soil softens");
    v.by_place("friction_angle", friction_angle, reads_shares, degree, Range{0, 70, {5, 50, or_zero}},
               "friction angle phi, at its peak if the soil softens");
    v.number("dilation_angle", dilation_angle, degree, Range{0, 70, {0, 35}},
             "dilation angle psi; limited to phi where phi falls below it. Take psi = phi for a factor of safety to "
             "compare with limit equilibrium; with psi < phi it is smaller. Where soil slides, 0, or give it an end by "
             "residual_dilation_angle: its volume grows as long as it shears");
    v.number("residual_cohesion", residual_cohesion, pascal, Range{-1, 1e9, {100, 1e8, or_zero}},
             "cohesion at large strain; negative: the peak value");
    v.number("residual_friction_angle", residual_friction_angle, degree, Range{-1, 70, {3, 45, or_zero}},
             "friction angle at large strain; negative: the peak value");
    v.number("residual_dilation_angle", residual_dilation_angle, degree, Range{-1, 70, {0, 35}},
             "dilation angle at large strain; negative: the peak value");
    v.number(
        "residual_ratio", residual_ratio, one, Range{-1, 1},
        "c and tan(phi) at large strain over those of the peak, also where the peak is a function of place; in place "
        "of residual_cohesion and residual_friction_angle; negative: not given");
    v.number("shape_factor", shape_factor, one, Range{0, 1e6, {0.1, 1e3, or_zero}},
             "eta: strength falls with exp(-eta plastic_strain)");
    v.number("reference_size", reference_size, metre, Range{0, 1e4, {1e-3, 50, or_zero}},
             "element size to which shape_factor belongs; in cells of size h it is multiplied by h / reference_size; "
             "0: no scaling");
  }

  std::string problem() const {
    const auto above = [](const char *key, const char *limit, double value, Unit unit) {
      return std::string(key) + " must not exceed " + limit + ", " + shortest(std::round(1e6 * value / unit.si) / 1e6) +
             " " + unit.name;
    };
    if ((std::isnan(cohesion) && residual_cohesion > 0) || (std::isnan(friction_angle) && residual_friction_angle > 0))
      return std::string(std::isnan(cohesion) && residual_cohesion > 0 ? "residual_cohesion"
                                                                       : "residual_friction_angle") +
             " must be 0, or negative (the peak), where the peak is a function of place: one number is no residual "
             "value of many peaks; residual_ratio gives each its own";
    if (residual_ratio >= 0 && (residual_cohesion >= 0 || residual_friction_angle >= 0))
      return "residual_ratio must not stand beside residual_cohesion or residual_friction_angle, whose place it takes";
    if (dilation_angle > friction_angle) return above("dilation_angle", "friction_angle", friction_angle, degree);
    if (residual_cohesion > cohesion) return above("residual_cohesion", "cohesion", cohesion, pascal);
    if (residual_friction_angle > friction_angle)
      return above("residual_friction_angle", "friction_angle", friction_angle, degree);
    if (residual_dilation_angle > dilation_angle)
      return above("residual_dilation_angle", "dilation_angle", dilation_angle, degree);
    const bool given = residual_cohesion >= 0 || residual_friction_angle >= 0 || residual_dilation_angle >= 0;
    if ((given || residual_ratio >= 0) && shape_factor == 0)
      return "a residual strength needs a shape_factor above 0, the rate at which it is reached";
    if (shape_factor > 0 && !given && residual_ratio < 0)
      return "shape_factor must have a residual strength beside it, to which the soil softens: give residual_cohesion, "
             "residual_friction_angle, residual_ratio or residual_dilation_angle, or leave it out";
    if (reference_size > 0 && shape_factor == 0)
      return "reference_size must have a shape_factor beside it, which it scales; leave it out for soil that does not "
             "soften";
    return "";
  }

  bool softens() const { return shape_factor > 0; }
  /// Cohesion bears tension up to the apex of the yield surface, and without friction it has none.
  bool comes_apart() const { return friction_angle > 0 || cohesion == 0; }
  bool strength_varies() const { return softens() || reads_shares; }

  /// Divides c and tan(phi), of peak and residual, by `factor`; psi is at most the reduced phi.
  /// docs/theory/finite_elements.md (5.1).
  void reduce_strength(double factor) {
    const auto reduce_angle = [factor](double &phi) { phi = std::atan(std::tan(phi) / factor); };
    cohesion /= factor, reduce_angle(friction_angle);
    if (residual_cohesion > 0) residual_cohesion /= factor;
    if (residual_friction_angle > 0) reduce_angle(residual_friction_angle);
    dilation_angle = std::min(dilation_angle, friction_angle);
  }

  // Set by prepare().
  double residual_c = 0, residual_phi = 0;               ///< [Pa], [rad]
  double sin_psi_peak = 0, sin_psi_residual = 0;         ///< [-]
  double over_size = 0;                                  ///< 1 / h_ref [1/m]
  static constexpr double right_angle = 90 * degree.si;  ///< [rad]
  static constexpr double unlimited = 1e100;             ///< stress of an apex that is not there [Pa]
  void prepare() {
    const double ratio = residual_ratio < 0 ? 1 : residual_ratio;
    residual_c = residual_cohesion < 0 ? ratio * cohesion : residual_cohesion;
    residual_phi = residual_friction_angle >= 0 ? residual_friction_angle
                   : residual_ratio < 0         ? friction_angle
                                                : std::atan(ratio * std::tan(friction_angle));
    sin_psi_peak = std::sin(dilation_angle);
    sin_psi_residual = residual_dilation_angle < 0 ? sin_psi_peak : std::sin(residual_dilation_angle);
    over_size = reference_size > 0 ? 1 / reference_size : 0;
  }

  template <class Number>
  struct Faded {
    Number c, phi, sin_psi;  ///< [Pa], [rad], [-]; psi may exceed phi
  };
  /// Share of the way from residual to peak strength that is left after a plastic strain [-].
  template <class Number>
  [[gnu::always_inline]] Number share_left(const Number &plastic_strain, const Surroundings &around) const {
    const double scale = around.size * over_size, eta = scale > 0 ? shape_factor * scale : shape_factor;
    return exponential(-eta * plastic_strain);
  }
  /// Strength that is left after a plastic strain, at a point that has the shares of its place if `by_place`. sin psi
  /// decreases as c and phi do.
  template <bool by_place, class Number>
  [[gnu::always_inline]] Faded<Number> faded(const Number &plastic_strain, const Surroundings &around) const {
    const Number left = share_left(plastic_strain, around);
    Faded<Number> now{residual_c + (cohesion - residual_c) * left,
                      residual_phi + (friction_angle - residual_phi) * left,
                      sin_psi_residual + (sin_psi_peak - sin_psi_residual) * left};
    if constexpr (by_place) now.c *= around.cohesion, now.phi *= around.friction;
    return now;
  }
  /// What results show of it.
  Faded<double> present(double plastic_strain, const Surroundings &around) const {
    return faded<true>(plastic_strain, around);
  }
};

}  // namespace talus
