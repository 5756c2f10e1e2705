#pragma once
#include <string>

#include "physics/laws/frictional_strength.h"
#include "physics/laws/history.h"
#include "physics/laws/isotropic_elastic.h"
#include "physics/laws/principal.h"

namespace talus {

/// Mohr-Coulomb with non-associated flow, tension cut-off, softening and strength from suction,
/// docs/theory/laws/mohr_coulomb.md; Tresca where phi = 0. In principal stresses s1 >= s2 >= s3 a pair yields where (1
/// + sin phi) s_i - (1 - sin phi) s_j = 2 c cos phi and flows with psi for phi; the cut-off s_i <= T flows along its
/// normal. The return is exact to face, edges, apex, cut-off and their intersections. Sources: Clausen, Damkilde &
/// Andersen (2006, 2007), Comput. Struct. 85 (regions in principal space); de Souza Neto, Peric & Owen (2008), sec. 8.2
/// (which edge); Alonso, Yerro & Pinyol (2015), eqs. (14) to (17) (suction), (18), (19) (softening).
struct MohrCoulomb : IsotropicElastic, FrictionalStrength {
  static constexpr const char *name = "mohr_coulomb";
  static constexpr const char *meaning =
      "Mohr-Coulomb with dilation, tension cut-off, strain softening and strength from suction; Tresca where "
      "friction_angle = 0";
  static constexpr auto history = frictional_history;
  using History = std::array<double, history.size()>;

  double tension_cutoff = -1;        ///< T [Pa]; negative: none, the apex is the limit
  double suction_cohesion = 0;       ///< dc_max: what suction adds to c at most [Pa]
  double suction_cohesion_rate = 0;  ///< B over P_atm: dc_max (1 - exp(-B s / P_atm)) is added [1/Pa]
  double suction_friction_rate = 0;  ///< A over P_atm: A s / P_atm is added to phi [rad/Pa]

  template <class Visitor>
  void fields(Visitor &&v) {
    IsotropicElastic::fields(v);
    FrictionalStrength::fields(v);
    v.number("tension_cutoff", tension_cutoff, pascal, Range{-1, 1e9, {0, 1e7}},
             "tensile strength; negative: no cut-off below the apex");
    v.number("suction_cohesion", suction_cohesion, pascal, Range{0, 1e9, {0, 1e6}},
             "largest increase of cohesion by suction: c = c' + suction_cohesion (1 - exp(-suction_cohesion_rate s))");
    v.number("suction_cohesion_rate", suction_cohesion_rate, per_pascal, Range{0, 1e-4},
             "rate of the increase of cohesion with suction, per pressure, such as \"0.0007 1/kPa\"");
    v.number("suction_friction_rate", suction_friction_rate, degree_per_pascal, Range{0, 1e-2},
             "increase of the friction angle per suction, such as \"0.0001 deg/kPa\"; phi is at most 80 degrees");
  }

  std::string problem() const {
    if ((suction_cohesion > 0) != (suction_cohesion_rate > 0))
      return "suction_cohesion and suction_cohesion_rate go together: give both above 0, or neither";
    return FrictionalStrength::problem();
  }

  bool comes_apart() const { return FrictionalStrength::comes_apart() || tension_cutoff >= 0; }
  bool reads_suction() const { return suction_cohesion > 0 || suction_friction_rate > 0; }
  bool strength_varies() const { return FrictionalStrength::strength_varies() || reads_suction(); }

  /// Also divides the tension cut-off and what suction adds to the cohesion; suction_friction_rate stays.
  void reduce_strength(double factor) {
    FrictionalStrength::reduce_strength(factor);
    suction_cohesion /= factor;
    if (tension_cutoff > 0) tension_cutoff /= factor;
  }

  // Of the parameters alone, set by prepare().
  double cutoff = 0;                     ///< [Pa]
  double plane_drag = 0, line_drag = 0;  ///< share of a stress relieved by opening that the others lose [-]
  static constexpr double steepest = 80 * degree.si;  ///< of phi with suction [rad]
  void prepare() {
    IsotropicElastic::prepare();
    FrictionalStrength::prepare();
    cutoff = tension_cutoff < 0 ? unlimited : tension_cutoff;
    plane_drag = lambda / (lambda + 2 * G), line_drag = lambda / (lambda + G);
  }

  template <class Number = double>
  struct Strength {
    Number sin_phi, sin_psi;
    Number twice_c_cos_phi;  ///< [Pa]
    Number tension;          ///< largest principal stress: cut-off or apex [Pa]
    /// Yield function of one pair of principal stresses [Pa].
    [[gnu::always_inline]] Number yield(const Number &greater, const Number &less) const {
      return (1 + sin_phi) * greater - (1 - sin_phi) * less - twice_c_cos_phi;
    }
  };

  /// After a plastic strain, with the suction and the shares of the place.
  template <bool with_surroundings, class Number>
  [[gnu::always_inline]] Faded<Number> wetted(const Number &plastic_strain, const Surroundings &around) const {
    Faded<Number> now = faded<with_surroundings>(plastic_strain, around);
    if constexpr (with_surroundings) {
      now.c += suction_cohesion * (1 - exponential(-suction_cohesion_rate * around.suction));
      now.phi += suction_friction_rate * around.suction;
      now.phi = now.phi < steepest ? now.phi : steepest;
    }
    return now;
  }
  Faded<double> present(double plastic_strain, const Surroundings &around) const {
    return wetted<true>(plastic_strain, around);
  }
  template <class Number, bool with_surroundings = true>
  [[gnu::always_inline]] Strength<Number> strength(const Number &plastic_strain, const Surroundings &around) const {
    const auto [c, phi, sin_psi] = wetted<with_surroundings>(plastic_strain, around);
    const Number sin_phi = sine(phi), c_cos_phi = c * sine(right_angle - phi);
    const Number quotient = c_cos_phi / sin_phi, apex = sin_phi > 0 ? quotient : unlimited;
    return {sin_phi, sin_psi < sin_phi ? sin_psi : sin_phi, 2 * c_cos_phi, cutoff < apex ? cutoff : apex};
  }

  /// Share of the present strength that a stress takes; 1 at the yield surface, the tension cut-off among it [-].
  template <int dim>
  double share_of_strength(const Stress<dim> &stress, double plastic_strain, const Surroundings &around) const {
    const Strength<> m = strength(plastic_strain, around);
    const Principal<> s = PrincipalAxes<dim>(stress).values();
    constexpr double round_off = 1e-6;
    if (m.tension - s.s1 <= round_off * (std::abs(s.s1) + std::abs(s.s3))) return 1;
    return (s.s1 - s.s3) / (m.twice_c_cos_phi - m.sin_phi * (s.s1 + s.s3));
  }

  /// The principal stresses that plastic flow leaves of an elastic trial.
  template <class Number>
  [[gnu::always_inline]] Principal<Number> admissible(const Principal<Number> &s, const Strength<Number> &m) const {
    // What unit slip of a pair takes off its greater, the third and its lesser principal stress.
    const Number side = 2 * lambda * m.sin_psi;
    const Number greater = side + 2 * G * (1 + m.sin_psi), less = side - 2 * G * (1 - m.sin_psi);

    // Slip of s1, s3 would pass an edge if it brought one of these gaps below zero: there two pairs slip, which is slip
    // of the mean of the two equal stresses against the third. At the edge s1 = s2 that is triaxial compression.
    const Number f = m.yield(s.s1, s.s3), drop = (1 + m.sin_phi) * greater - (1 - m.sin_phi) * less;
    const Number gap12 = (s.s1 - s.s2) * (1 - m.sin_psi), gap23 = (s.s2 - s.s3) * (1 + m.sin_psi);
    const bool upper = gap12 < gap23;
    const bool on_edge = (upper ? gap12 : gap23) * drop < 2 * G * (1 - m.sin_psi * m.sin_psi) * f;
    const Number mean12 = (s.s1 + s.s2) / 2, mean23 = (s.s2 + s.s3) / 2;
    const Number edge1 = upper ? mean12 : s.s1, edge2 = upper ? mean12 : mean23, edge3 = upper ? s.s3 : mean23;
    const Number flow12 = (greater + side) / 2, flow23 = (side + less) / 2;
    const Number flow1 = upper ? flow12 : greater, flow2 = upper ? flow12 : flow23, flow3 = upper ? less : flow23;
    const Number x1 = on_edge ? edge1 : s.s1, x2 = on_edge ? edge2 : s.s2, x3 = on_edge ? edge3 : s.s3;
    const Number d1 = on_edge ? flow1 : greater, d2 = on_edge ? flow2 : side, d3 = on_edge ? flow3 : less;
    const Number slip = m.yield(x1, x3) / ((1 + m.sin_phi) * d1 - (1 - m.sin_phi) * d3);
    const bool elastic = f <= 0;
    const Number sheared1 = elastic ? s.s1 : x1 - slip * d1;
    const Number sheared2 = elastic ? s.s2 : x2 - slip * d2;
    const Number sheared3 = elastic ? s.s3 : x3 - slip * d3;

    // The cut-off alone: plane s1 = T, line s1 = s2 = T, or its corner.
    const Number T = m.tension;
    const Number plane2 = s.s2 - plane_drag * (s.s1 - T), plane3 = s.s3 - plane_drag * (s.s1 - T);
    const Number line3 = s.s3 - line_drag * (mean12 - T), opened = plane2 > T ? line3 : plane3;
    const Number opened2 = plane2 < T ? plane2 : T, opened3 = opened < T ? opened : T;

    // Shear and cut-off together: the line s1 = T, s3 = low, whose ends lie on the edges.
    const Number over = 1 / ((1 - m.sin_phi) * (1 - m.sin_psi));
    const Number low = ((1 + m.sin_phi) * T - m.twice_c_cos_phi) * (1 - m.sin_psi) * over;
    const Number drop1 = s.s1 - T, drop3 = s.s3 - low, over_det = (1 - m.sin_phi) * over * (1 / (4 * G * (lambda + G)));
    const Number line_slip = (lambda * drop1 - (lambda + 2 * G) * drop3) * over_det;
    const Number line_opening = (greater * drop3 - less * drop1) * over_det;
    const Number middle = s.s2 - side * line_slip - lambda * line_opening;
    const Number below = middle < T ? middle : T, corner2 = below > low ? below : low;

    const bool keep = sheared1 <= T, open = m.yield(T, opened3) <= 0;
    const Number torn2 = open ? opened2 : corner2, torn3 = open ? opened3 : low;
    return {keep ? sheared1 : T, keep ? sheared2 : torn2, keep ? sheared3 : torn3};
  }

  /// Equivalent deviatoric plastic strain of a return.
  template <class Number>
  [[gnu::always_inline]] Number shearing(const Principal<Number> &change) const {
    const Number d12 = change.s1 - change.s2, d23 = change.s2 - change.s3, d31 = change.s3 - change.s1;
    return sqrt(d12 * d12 + d23 * d23 + d31 * d31) * (0.47140452079103168 / (2 * G));  // sqrt(2) / 3
  }

  /// Calls `use` with this law as the simplest of its cases, so that softening, suction and strength that varies with
  /// place cost time only in soil that has them.
  template <class Use>
  void as_case(Use use) const;
};

/// Mohr-Coulomb compiled with or without softening, and with or without what surrounds the point: suction and shares.
template <bool softening, bool with_surroundings>
struct MohrCoulombCase : MohrCoulomb {
  static constexpr bool by_place = with_surroundings;
  Strength<> peak;

  void prepare() {
    MohrCoulomb::prepare();
    peak = strength(0., Surroundings{0});
  }

  /// Softening takes strength and return twice.
  template <int dim>
  [[gnu::always_inline]] bool admits(const Stress<dim> &trial, const History &history,
                                     const Surroundings &around) const requires softening {
    const Principal<> s = PrincipalAxes<dim>(trial).values();
    const Strength<> now = strength<double, by_place>(history[0], around);
    return (now.yield(s.s1, s.s3) <= 0) & (s.s1 <= now.tension);
  }

  /// Returns an elastic trial stress to the yield surface. The strength is that after the plastic strain which the
  /// strength at the start of the step would cause. This is of first order in the step; its error is (softening slope /
  /// 2 G) times the error that the strength at the start would give.
  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &stress, History &history, const Surroundings &around) const {
    auto &[plastic_strain, dilation] = history;
    const PrincipalAxes<dim, Number> axes(stress);
    const auto trial = axes.values();
    using Value = decltype(trial.s1);
    const auto taken_to = [&](const Principal<Value> &end) __attribute__((always_inline)) {
      return Principal<Value>{trial.s1 - end.s1, trial.s2 - end.s2, trial.s3 - end.s3};
    };
    Strength<Value> now{peak.sin_phi, peak.sin_psi, peak.twice_c_cos_phi, peak.tension};
    if constexpr (softening || by_place) now = strength<Value, by_place>(Value(plastic_strain), around);
    if constexpr (softening) {
      const Value predicted = plastic_strain + shearing(taken_to(admissible(trial, now)));
      now = strength<Value, by_place>(predicted, around);
    }
    const Principal<Value> end = admissible(trial, now), taken = taken_to(end);
    const bool torn = !(end.s1 < now.tension);
    axes.subtract(taken, stress);
    plastic_strain += value_of(shearing(taken));
    dilation += torn ? 0 : value_of(taken.s1 + taken.s2 + taken.s3) * (1 / (3 * K));
  }
};

template <class Use>
void MohrCoulomb::as_case(Use use) const {
  if (reads_suction() || reads_shares)
    softens() ? use(MohrCoulombCase<true, true>{*this, {}}) : use(MohrCoulombCase<false, true>{*this, {}});
  else
    softens() ? use(MohrCoulombCase<true, false>{*this, {}}) : use(MohrCoulombCase<false, false>{*this, {}});
}

}  // namespace talus
