#pragma once
#include "physics/laws/frictional_strength.h"
#include "physics/laws/history.h"
#include "physics/laws/isotropic_elastic.h"

namespace talus {

enum class Cone { outer, inner, compromise, plane_strain };

/// Non-associated Drucker-Prager cone sqrt(J2) + eta p = xi c, elastic within it, with softening.
/// Sources: de Souza Neto, Peric & Owen (2008), sec. 6.4.4 (cones through the outer or inner edges of the Mohr-Coulomb
/// pyramid and the plane-strain match), sec. 8.3 (return to cone and apex, exact); Zienkiewicz et al. (1978), Numerical
/// methods in offshore engineering, ch. 12 (compromise: the mean of outer and inner).
struct DruckerPrager : IsotropicElastic, FrictionalStrength {
  static constexpr const char *name = "drucker_prager";
  static constexpr const char *meaning = "Drucker-Prager cone with dilation and strain softening";
  static constexpr auto history = frictional_history;
  using History = std::array<double, history.size()>;

  Cone cone = Cone::outer;

  template <class Visitor>
  void fields(Visitor &&v) {
    IsotropicElastic::fields(v);
    FrictionalStrength::fields(v);
    v.choice(
        "cone", cone,
        {{"outer", Cone::outer},
         {"inner", Cone::inner},
         {"compromise", Cone::compromise},
         {"plane_strain", Cone::plane_strain}},
        "Mohr-Coulomb strength that the cone matches: triaxial compression, extension, their mean, or plane strain");
  }

  bool strength_varies() const { return FrictionalStrength::strength_varies(); }

  // Of the parameters alone, set by prepare().
  double of_outer = 0, of_inner = 0, of_plane_strain = 0;  ///< weights of the cones in steepness()
  void prepare() {
    IsotropicElastic::prepare();
    FrictionalStrength::prepare();
    const double root3 = std::sqrt(3.);
    of_outer = cone == Cone::outer ? 2 * root3 : cone == Cone::compromise ? root3 : 0;
    of_inner = cone == Cone::inner ? 2 * root3 : cone == Cone::compromise ? root3 : 0;
    of_plane_strain = cone == Cone::plane_strain ? root3 : 0;
  }
  /// eta / sin(phi) and xi / cos(phi), of an angle's sine.
  template <class Number>
  [[gnu::always_inline]] Number steepness(const Number &s) const {
    return of_outer / (3 - s) + of_inner / (3 + s) + of_plane_strain / sqrt(3 + s * s);
  }

  template <class Number = double>
  struct Strength {
    Number eta, eta_bar;  ///< of the cone and of the flow potential [-]
    Number limit;         ///< xi c [Pa]
    Number apex;          ///< mean stress there [Pa]
  };
  /// After a plastic strain, with the shares of the place.
  template <class Number>
  [[gnu::always_inline]] Strength<Number> strength(const Number &plastic_strain, const Surroundings &around) const {
    const auto now = faded<true>(plastic_strain, around);
    const Number sin_phi = sine(now.phi), c_cos_phi = now.c * sine(right_angle - now.phi);
    const Number sin_psi = now.sin_psi < sin_phi ? now.sin_psi : sin_phi;
    const Number steep = steepness(sin_phi), quotient = c_cos_phi / sin_phi;
    return {steep * sin_phi, steepness(sin_psi) * sin_psi, steep * c_cos_phi, sin_phi > 0 ? quotient : unlimited};
  }

  /// Share of the present strength that a stress takes; 1 at the yield surface [-].
  template <int dim>
  double share_of_strength(const Stress<dim> &stress, double plastic_strain, const Surroundings &around) const {
    const Strength<> m = strength(plastic_strain, around);
    const Invariants<dim> s(stress);
    const double limit = m.limit - m.eta * s.p;
    return limit > 0 ? s.q / limit : 1;
  }

  /// Calls `use` with this law as the simpler of its cases.
  template <class Use>
  void as_case(Use use) const;
};

/// The cone compiled with one strength for all points, or with that of each point: its plastic strain and its place.
template <bool varies>
struct DruckerPragerCase : DruckerPrager {
  static constexpr bool by_place = varies;
  Strength<> peak;
  double over_stiffness = 0;  ///< slip per excess of f at the peak [1/Pa]

  void prepare() {
    DruckerPrager::prepare();
    peak = strength(0., Surroundings{0});
    over_stiffness = 1 / (G + K * peak.eta_bar * peak.eta);
  }

  /// Strength that varies is found twice.
  template <int dim>
  [[gnu::always_inline]] bool admits(const Stress<dim> &s, const History &history,
                                     const Surroundings &around) const requires varies {
    const Invariants<dim> trial(s);
    const Strength<> now = strength(history[0], around);
    return (trial.q + now.eta * trial.p - now.limit <= 0) & (trial.p < now.apex);
  }

  /// Returns an elastic trial stress to the cone. The strength is that after the plastic strain which the strength at
  /// the start of the step would cause, as in MohrCoulomb.
  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &s, History &history, const Surroundings &around) const {
    auto &[plastic_strain, dilation] = history;
    const Invariants<dim, Number> trial(s);
    struct End {
      Number p, q, sheared_p;  ///< the last is that of shear alone, the trial's where the apex takes over
    };
    const auto end_of = [&](const Strength<Number> &m, const Number &over) __attribute__((always_inline)) {
      const Number f = trial.q + m.eta * trial.p - m.limit, to_cone = (f > 0 ? f : Number(0)) * over;
      const Number cone_p = trial.p - K * m.eta_bar * to_cone, cone_q = trial.q - G * to_cone;
      const bool sheared = cone_p < m.apex;
      return End{sheared ? cone_p : m.apex, sheared ? cone_q : Number(0), sheared ? cone_p : trial.p};
    };
    const double shearing = 1 / (std::sqrt(3.) * G);  // plastic strain per loss of q
    End end;
    if constexpr (varies) {
      const auto after = [&](const Number &strain) __attribute__((always_inline)) {
        const Strength<Number> m = strength(strain, around);
        return end_of(m, 1 / (G + K * m.eta_bar * m.eta));
      };
      end = after(plastic_strain + (trial.q - after(Number(plastic_strain)).q) * shearing);
    } else {
      end = end_of({peak.eta, peak.eta_bar, peak.limit, peak.apex}, over_stiffness);
    }
    const Number shrink = trial.q > 0 ? (trial.q - end.q) / trial.q : 0;
    trial.take_off(s, shrink, trial.p - end.p);
    plastic_strain += value_of(trial.q - end.q) * shearing;
    dilation += value_of(trial.p - end.sheared_p) * (1 / K);
  }
};

template <class Use>
void DruckerPrager::as_case(Use use) const {
  strength_varies() ? use(DruckerPragerCase<true>{*this, {}}) : use(DruckerPragerCase<false>{*this, {}});
}

}  // namespace talus
