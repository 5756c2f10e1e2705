#pragma once
#include <string>

#include "physics/laws/history.h"
#include "physics/laws/isotropic_elastic.h"
#include "physics/laws/lanes.h"
#include "physics/laws/principal.h"

namespace talus {

/// Mohr-Coulomb with non-associated flow, tension cut-off and softening; Tresca where phi = 0. In principal stresses
/// s1 >= s2 >= s3 a pair yields where (1 + sin phi) s_i - (1 - sin phi) s_j = 2 c cos phi and flows with psi for phi;
/// the cut-off s_i <= T flows along its normal. The return is exact to face, edges, apex, cut-off and their
/// intersections. Sources: Clausen, Damkilde & Andersen (2006, 2007), Comput. Struct. 85 (regions in principal space);
/// de Souza Neto, Peric & Owen (2008), sec. 8.2 (which edge); Alonso, Yerro & Pinyol (2015), eqs. (18), (19)
/// (softening).
struct MohrCoulomb : IsotropicElastic {
  static constexpr const char *name = "mohr_coulomb";
  static constexpr auto history = plastic_strains;
  using History = std::array<double, history.size()>;

  double cohesion = required;           ///< c, peak [Pa]
  double friction_angle = required;     ///< phi, peak [rad]
  double dilation_angle = 0;            ///< psi, never above the current phi [rad]
  double tension_cutoff = -1;           ///< T [Pa]; negative: none, the apex is the limit
  double residual_cohesion = -1;        ///< [Pa]; negative: the peak
  double residual_friction_angle = -1;  ///< [rad]; negative: the peak
  double shape_factor = 0;              ///< eta: strength falls with exp(-eta plastic_strain) [-]
  double reference_size = 0;            ///< h_ref: eta is multiplied by h / h_ref [m]; 0: it is not

  template <class Visitor>
  void fields(Visitor &&v) {
    IsotropicElastic::fields(v);
    v.number("cohesion", cohesion, pascal, Range{0, 1e9}, "cohesion c, at its peak if the soil softens");
    v.number("friction_angle", friction_angle, degree, Range{0, 70},
             "friction angle phi, at its peak if the soil softens");
    v.number("dilation_angle", dilation_angle, degree, Range{0, 70},
             "dilation angle psi; held at phi where phi falls below it");
    v.number("tension_cutoff", tension_cutoff, pascal, Range{-1, 1e9},
             "largest tension; negative is none but the apex");
    v.number("residual_cohesion", residual_cohesion, pascal, Range{-1, 1e9},
             "cohesion at large strain; negative is the peak");
    v.number("residual_friction_angle", residual_friction_angle, degree, Range{-1, 70},
             "friction angle at large strain; negative is the peak");
    v.number("shape_factor", shape_factor, one, Range{0, 1e6}, "eta: strength falls with exp(-eta plastic_strain)");
    v.number("reference_size", reference_size, metre, Range{0, 1e4},
             "element size that shape_factor belongs to; in cells of size h it is scaled by h / reference_size; 0 is "
             "no scaling");
  }

  std::string problem() const {
    if (dilation_angle > friction_angle) return "dilation_angle must not exceed friction_angle";
    if (residual_cohesion > cohesion) return "residual_cohesion must not exceed cohesion";
    if (residual_friction_angle > friction_angle) return "residual_friction_angle must not exceed friction_angle";
    return "";
  }

  bool cohesionless() const { return cohesion == 0; }

  struct Strength {
    double sin_phi, sin_psi;
    double twice_c_cos_phi;  ///< [Pa]
    double tension;          ///< largest principal stress: cut-off or apex [Pa]
    /// Yield function of one pair of principal stresses [Pa].
    double yield(double greater, double less) const {
      return (1 + sin_phi) * greater - (1 - sin_phi) * less - twice_c_cos_phi;
    }
  };

  [[gnu::always_inline]] Strength strength(double plastic_strain, const Surroundings &around) const {
    const double residual_c = residual_cohesion < 0 ? cohesion : residual_cohesion;
    const double residual_phi = residual_friction_angle < 0 ? friction_angle : residual_friction_angle;
    const double eta = shape_factor * (reference_size > 0 && around.size > 0 ? around.size / reference_size : 1);
    const double left = exponential(-eta * plastic_strain);  // of the way from residual to peak
    const double sin_phi = sine(residual_phi + (friction_angle - residual_phi) * left), sin_psi = sine(dilation_angle);
    const double cos_phi = std::sqrt(1 - sin_phi * sin_phi);
    const double c_cos_phi = (residual_c + (cohesion - residual_c) * left) * cos_phi;
    const double apex = sin_phi > 0 ? c_cos_phi / sin_phi : 1e100;
    const double cutoff = tension_cutoff < 0 ? 1e100 : tension_cutoff;
    return {sin_phi, sin_psi < sin_phi ? sin_psi : sin_phi, 2 * c_cos_phi, cutoff < apex ? cutoff : apex};
  }

  /// The principal stresses that plastic flow leaves of an elastic trial.
  [[gnu::always_inline]] Principal admissible(const Principal &s, const Strength &m) const {
    const double G = shear_modulus(), lambda = lame_modulus();
    // What unit slip of a pair takes off its greater, the third, and its lesser principal stress.
    const double side = 2 * lambda * m.sin_psi, greater = side + 2 * G * (1 + m.sin_psi),
                 less = side - 2 * G * (1 - m.sin_psi);

    const double f = m.yield(s.s1, s.s3);
    const double own = (1 + m.sin_phi) * greater - (1 - m.sin_phi) * less;  // drop of f by slip of this pair
    const double slip = (f > 0 ? f : 0) / own;
    const Principal face{s.s1 - slip * greater, s.s2 - slip * side, s.s3 - slip * less};

    // Edge s1 = s2 (triaxial compression) if the trial is nearer to it, else s2 = s3; a second pair slips.
    const bool upper = (1 - m.sin_psi) * s.s1 - 2 * s.s2 + (1 + m.sin_psi) * s.s3 <= 0;
    const double f2 = upper ? m.yield(s.s2, s.s3) : m.yield(s.s1, s.s2);
    const double other =
        upper ? (1 + m.sin_phi) * side - (1 - m.sin_phi) * less : (1 + m.sin_phi) * greater - (1 - m.sin_phi) * side;
    const double over_det = 1 / ((own - other) * (own + other));
    const double slip1 = (own * f - other * f2) * over_det, slip2 = (own * f2 - other * f) * over_det;
    const Principal edge{s.s1 - slip1 * greater - slip2 * (upper ? side : greater),
                         s.s2 - slip1 * side - slip2 * (upper ? greater : less),
                         s.s3 - slip1 * less - slip2 * (upper ? less : side)};
    const bool on_face = face.s1 >= face.s2 && face.s2 >= face.s3;
    const Principal sheared{on_face ? face.s1 : edge.s1, on_face ? face.s2 : edge.s2, on_face ? face.s3 : edge.s3};

    // The cut-off alone: plane s1 = T, line s1 = s2 = T, or its corner.
    const double T = m.tension, drag = lambda / (lambda + 2 * G);
    const double opened2 = s.s2 - drag * (s.s1 - T);
    const bool both = opened2 > T;
    const double opened3 = s.s3 - (both ? lambda / (lambda + G) * ((s.s1 + s.s2) / 2 - T) : drag * (s.s1 - T));
    const Principal opened{T, both ? T : opened2, opened3 < T ? opened3 : T};

    // Shear face and cut-off together: their line s1 = T, s3 = low, whose ends lie on the edges.
    const double low = ((1 + m.sin_phi) * T - m.twice_c_cos_phi) / (1 - m.sin_phi);
    const double drop1 = s.s1 - T, drop3 = s.s3 - low, det = 4 * G * (1 - m.sin_psi) * (lambda + G);
    const double line_slip = (lambda * drop1 - (lambda + 2 * G) * drop3) / det;
    const double line_opening = (greater * drop3 - less * drop1) / det;
    const double middle = s.s2 - side * line_slip - lambda * line_opening;
    const Principal corner{T, middle > T ? T : middle < low ? low : middle, low};

    const bool keep = sheared.s1 <= T, open = m.yield(opened.s1, opened.s3) <= 0;
    return {keep ? sheared.s1 : T,
            keep   ? sheared.s2
            : open ? opened.s2
                   : corner.s2,
            keep   ? sheared.s3
            : open ? opened.s3
                   : corner.s3};
  }

  /// Equivalent deviatoric plastic strain of a return.
  [[gnu::always_inline]] double shearing(const Principal &change) const {
    const double d12 = change.s1 - change.s2, d23 = change.s2 - change.s3, d31 = change.s3 - change.s1;
    return std::sqrt(d12 * d12 + d23 * d23 + d31 * d31) * (1. / 3) * 1.4142135623730951 / (2 * shear_modulus());
  }

  /// Brings an elastic trial stress back to the surface. The strength is that of the plastic strain which the strength
  /// at the start would cause: first order in the step, with half the error of the strength at the start.
  template <int dim>
  [[gnu::always_inline]] void correct(Stress<dim> &stress, History &history, const Surroundings &around) const {
    auto &[plastic_strain, plastic_volume] = history;
    const PrincipalAxes<dim> axes(stress);
    const Principal trial = axes.values();
    const auto change = [&](const Strength &strength) __attribute__((always_inline)) {
      const Principal end = admissible(trial, strength);
      return Principal{trial.s1 - end.s1, trial.s2 - end.s2, trial.s3 - end.s3};
    };
    const double predicted = plastic_strain + shearing(change(strength(plastic_strain, around)));
    const Principal taken = change(strength(predicted, around));
    axes.subtract(taken, stress);
    plastic_strain += shearing(taken);
    plastic_volume += (taken.s1 + taken.s2 + taken.s3) / (3 * bulk_modulus());
  }
};

}  // namespace talus
