#pragma once
#include <string>

#include "physics/laws/history.h"
#include "physics/laws/isotropic_elastic.h"

namespace talus {

enum class Cone { outer, inner, compromise, plane_strain };

/// Non-associated, perfectly plastic Drucker-Prager cone sqrt(J2) + eta p = xi c around an elastic inside.
/// Sources: de Souza Neto, Peric & Owen (2008), sec. 6.4.4 (cones through the outer or inner edges of the Mohr-Coulomb
/// pyramid and the plane-strain match), sec. 8.3 (return to cone and apex, exact); Zienkiewicz et al. (1978), Numerical
/// methods in offshore engineering, ch. 12 (compromise: the mean of outer and inner).
struct DruckerPrager : IsotropicElastic {
  static constexpr const char *name = "drucker_prager";
  static constexpr const char *meaning = "Drucker-Prager cone with dilation";
  static constexpr auto history = plastic_strains;
  using History = std::array<double, history.size()>;

  double cohesion = required;        ///< c [Pa]
  double friction_angle = required;  ///< phi [rad]
  double dilation_angle = 0;         ///< psi [rad]
  Cone cone = Cone::outer;

  template <class Visitor>
  void fields(Visitor &&v) {
    IsotropicElastic::fields(v);
    v.number("cohesion", cohesion, pascal, Range{0, 1e9}, "cohesion c");
    v.number("friction_angle", friction_angle, degree, Range{0, 70}, "friction angle phi");
    v.number("dilation_angle", dilation_angle, degree, Range{0, 70}, "dilation angle psi");
    v.choice(
        "cone", cone,
        {{"outer", Cone::outer},
         {"inner", Cone::inner},
         {"compromise", Cone::compromise},
         {"plane_strain", Cone::plane_strain}},
        "which Mohr-Coulomb strength the cone takes: triaxial compression, extension, their mean, or plane strain");
  }

  std::string problem() const {
    return dilation_angle > friction_angle ? "dilation_angle must not exceed friction_angle" : "";
  }

  bool cohesionless() const { return cohesion == 0; }

  // Of the parameters alone, set by prepare().
  double eta = 0, eta_bar = 0, xi = 0;  ///< of the cone [-]
  double over_stiffness = 0;            ///< slip per excess of f [1/Pa]
  double apex = 0;                      ///< mean stress at the apex [Pa]
  void prepare() {
    IsotropicElastic::prepare();
    xi = xi_of(friction_angle);
    eta = xi * std::tan(friction_angle);
    eta_bar = xi_of(dilation_angle) * std::tan(dilation_angle);
    over_stiffness = 1 / (G + K * eta_bar * eta);
    apex = eta > 0 ? xi * cohesion / eta : 1e100;
  }

  /// xi of the cone for an angle of friction, over which eta = xi tan(phi), or of dilation.
  double xi_of(double angle) const {
    const double sine = std::sin(angle), cosine = std::cos(angle), root3 = std::sqrt(3.);
    switch (cone) {
      case Cone::outer:
        return 6 * cosine / (root3 * (3 - sine));
      case Cone::inner:
        return 6 * cosine / (root3 * (3 + sine));
      case Cone::compromise:
        return 18 * cosine / (root3 * (9 - sine * sine));
      case Cone::plane_strain:
        return 3 * cosine / std::sqrt(9 * cosine * cosine + 12 * sine * sine);
    }
    return 0;
  }

  /// Brings an elastic trial stress back to the cone.
  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &s, History &history, const Surroundings &) const {
    const Invariants<dim, Number> trial(s);
    const Number f = trial.q + eta * trial.p - xi * cohesion;
    const Number to_cone = (f > 0 ? f : 0) * over_stiffness;
    const Number cone_p = trial.p - K * eta_bar * to_cone, cone_q = trial.q - G * to_cone;
    const Number p = cone_p < apex ? cone_p : apex;
    const Number q = cone_p < apex ? cone_q : 0;
    const Number shrink = trial.q > 0 ? (trial.q - q) / trial.q : 0;
    trial.take_off(s, shrink, trial.p - p);
    auto &[plastic_strain, plastic_volume] = history;
    plastic_strain += value_of(trial.q - q) * (1 / (std::sqrt(3.) * G));
    plastic_volume += value_of(trial.p - p) * (1 / K);
  }
};

}  // namespace talus
