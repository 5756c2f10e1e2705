#pragma once
#include <algorithm>
#include <string>

#include "physics/laws/dual.h"
#include "physics/laws/mohr_coulomb.h"

namespace talus {

/// Hoek-Brown of rock masses, 2018 edition (Hoek & Brown 2019, J. Rock Mech. Geotech. Eng. 11), docs/theory/laws/
/// hoek_brown.md. In principal stresses positive in compression sigma_1 = sigma_3 + sigma_ci (m_b sigma_3 / sigma_ci +
/// s)^a, with a tension cut-off at the apex sigma_3 = -s sigma_ci / m_b or before it. Each point of the surface is the
/// tangent plane of a Mohr-Coulomb pyramid (Balmer 1952), to which stress returns as in mohr_coulomb.h; the plane is
/// that which touches the surface where the return ends. Strength is divided as Hammah et al. (2005) do, the shear
/// strength at each normal stress: the tangents then have c / F and tan(phi) / F, without fitting another curve.
struct HoekBrown : IsotropicElastic {
  static constexpr const char *name = "hoek_brown";
  static constexpr const char *meaning = "Hoek-Brown of rock masses (2018 edition): GSI, m_i, D and sigma_ci";
  static constexpr auto history = frictional_history;
  using History = std::array<double, history.size()>;

  double intact_strength = required;            ///< sigma_ci [Pa]
  double geological_strength_index = required;  ///< GSI [-]
  double intact_constant = required;            ///< m_i [-]
  double disturbance_factor = 0;                ///< D [-]
  double dilation_angle = 0;                    ///< psi, never above the phi of the tangent [rad]
  double tension_cutoff = -1;                   ///< [Pa]; negative: the apex is the limit
  double divisor = 1;                           ///< F, of the shear strength [-]
  /// A point has the share Surroundings::cohesion of the shear strength: trials of a factor of safety set it.
  bool reads_shares = false;

  template <class Visitor>
  void fields(Visitor &&v) {
    IsotropicElastic::fields(v);
    v.number("intact_strength", intact_strength, pascal, Range{1e3, 1e9, {1e6, 3e8}},
             "sigma_ci: uniaxial compressive strength of the intact rock");
    v.number("geological_strength_index", geological_strength_index, one, Range{1, 100, {5, 95}},
             "GSI: geological strength index of the rock mass");
    v.number("intact_constant", intact_constant, one, Range{0.5, 60, {2, 35}}, "m_i: constant of the intact rock");
    v.number("disturbance_factor", disturbance_factor, one, Range{0, 1},
             "D: disturbance by blasting and stress relief; 0: undisturbed");
    v.number("dilation_angle", dilation_angle, degree, Range{0, 90},
             "dilation angle psi; limited to the friction angle of the envelope at each stress, which 90 always is");
    v.number("tension_cutoff", tension_cutoff, pascal, Range{-1, 1e9, {0, 1e7}},
             "tensile strength; negative: that of the apex, s sigma_ci / m_b");
  }
  std::string problem() const { return ""; }

  bool strength_varies() const { return reads_shares; }
  bool comes_apart() const { return true; }
  /// Divides the shear strength of each normal stress, and a tension cut-off; the apex stays.
  void reduce_strength(double factor) {
    divisor *= factor;
    if (tension_cutoff > 0) tension_cutoff /= factor;
  }

  // Of the parameters alone, set by prepare().
  double m_b = 0, s = 0, a = 0;  ///< of the rock mass [-]
  double scale = 0, least = 0;   ///< sigma_ci / m_b [Pa]; x next to the apex, where the surface ends on its tangent [-]
  double apex = 0, limit = 0;    ///< tension at the apex, and the largest principal stress [Pa]
  double sin_psi = 0;
  MohrCoulomb pyramid;  ///< the return to the tangent planes, which reads its elasticity
  void prepare() {
    IsotropicElastic::prepare();
    m_b = intact_constant * std::exp((geological_strength_index - 100) / (28 - 14 * disturbance_factor));
    s = std::exp((geological_strength_index - 100) / (9 - 3 * disturbance_factor));
    a = 0.5 + (std::exp(-geological_strength_index / 15) - std::exp(-20. / 3)) / 6;
    scale = intact_strength / m_b, least = 1e-6 * s, apex = s * scale;
    limit = tension_cutoff >= 0 && tension_cutoff < apex ? tension_cutoff : apex;
    sin_psi = std::sin(dilation_angle);
    pyramid.young_modulus = young_modulus, pyramid.poisson_ratio = poisson_ratio;
    pyramid.cohesion = pyramid.friction_angle = 0;
    pyramid.prepare();
  }

  /// A tangent of the envelope, and where the Mohr circle of its point begins.
  template <class Number = double>
  struct Tangent {
    Number sin_phi, twice_c_cos_phi;  ///< [-], [Pa]
    Number sigma_3;                   ///< [Pa]
    MohrCoulomb::Strength<Number> strength(double sin_psi, double tension) const {
      return {sin_phi, sin_phi > sin_psi ? Number(sin_psi) : sin_phi, twice_c_cos_phi, Number(tension)};
    }
  };
  /// At x = m_b sigma_3 / sigma_ci + s of the whole strength, of which `share` is there. Balmer's normal and shear
  /// stress are sigma_3 + d / (2 + d') and d sqrt(1 + d') / (2 + d') with d = sigma_1 - sigma_3 and d' its slope.
  template <class Number>
  [[gnu::always_inline]] Tangent<Number> tangent(const Number &x, double share) const {
    const Number d = intact_strength * exponential(a * logarithm(x)), rise = a * m_b * d / (intact_strength * x);
    const Number root = sqrt(1 + rise), over = 1 / (2 + rise);
    const Number normal = (x - s) * scale + d * over, shear = share * d * root * over;
    const Number slope = share * rise / (2 * root), cosine = 1 / sqrt(1 + slope * slope);
    return {slope * cosine, 2 * (shear - normal * slope) * cosine, normal + shear * slope - shear / cosine};
  }

  /// c [Pa] and phi [rad] of the tangent that touches the circle of this largest principal stress.
  struct Line {
    double c, phi;
  };
  Line line_at(double largest) const {
    const Tangent<> at = tangent(std::max(least, s - largest / scale), 1.);
    const double phi = std::asin(at.sin_phi);
    return {at.twice_c_cos_phi / (2 * std::cos(phi)), phi};
  }
  /// Shear strength of a circle about this mean stress, positive in compression [Pa].
  double radius_at(double mean) const {
    double low = least, high = (mean + apex) / scale;
    if (high <= low) return 0;
    for (int k = 0; k < 100; ++k) {  // mean = sigma_3 + radius
      const double x = std::sqrt(low * high), radius = intact_strength * std::pow(x, a) / 2;
      ((x - s) * scale + radius < mean ? low : high) = x;
    }
    return intact_strength * std::pow(low, a) / 2;
  }
  /// Share of the strength that a stress takes; 1 at the surface, the tension cut-off among it [-].
  template <int dim>
  double share_of_strength(const Stress<dim> &stress, double, const Surroundings &around) const {
    const Principal<> t = PrincipalAxes<dim>(stress).values();
    constexpr double round_off = 1e-6;
    if (limit - t.s1 <= round_off * (std::abs(t.s1) + std::abs(t.s3))) return 1;
    const double mean = -(t.s1 + t.s3) / 2, share = (reads_shares ? around.cohesion : 1) / divisor;
    return (t.s1 - t.s3) / (2 * share * radius_at(mean));
  }

  /// By how much sigma_3 after the return to the tangent at x exceeds that of the tangent's own point, over `scale`.
  template <class Number, class Stress>
  [[gnu::always_inline]] Number excess(const Principal<Stress> &trial, const Number &x, double share) const {
    const Tangent<Number> at = tangent(x, share);
    const Principal<Number> from{Number(trial.s1), Number(trial.s2), Number(trial.s3)};
    return (-pyramid.admissible(from, at.strength(sin_psi, limit)).s1 - at.sigma_3) * (1 / scale);
  }
  /// The x at which the return ends: Newton's method, kept in a bracket. It needs 3 to 16 steps, so that points go
  /// through this law one by one.
  double solve(const Principal<> &trial, double share) const {
    constexpr int most = 60;
    constexpr double round_off = 1e-15, unbounded = 1e300;
    double x = std::max(least, s - trial.s1 / scale), low = least, high = unbounded;
    for (int k = 0; k < most; ++k) {
      Dual<1> at(x);
      at.slope[0] = 1;
      const Dual<1> e = excess(trial, at, share);
      (e.value < 0 ? high : low) = x;
      const double plain = x + e.value, newton = e.slope[0] < 0 ? x - e.value / e.slope[0] : plain;
      if (std::abs(newton - x) <= round_off * x) return x;
      const double middle = high < unbounded ? std::sqrt(low * high) : plain;
      x = low <= newton && newton < high ? newton : std::max(low, middle);
    }
    return x;
  }

  /// Calls `use` with this law as the simpler of its cases.
  template <class Use>
  void as_case(Use use) const;
};

/// The law compiled with its whole strength, or with a share of it, which may be that of the place.
template <bool divided>
struct HoekBrownCase : HoekBrown {
  static constexpr bool by_place = divided;

  template <int dim>
  [[gnu::always_inline]] bool admits(const Stress<dim> &trial, const History &, const Surroundings &) const
      requires(!divided) {
    const Principal<> t = PrincipalAxes<dim>(trial).values();
    const double of_trial = s - t.s1 / scale, x = of_trial > least ? of_trial : least;
    const auto touched = tangent(x, 1.).strength(sin_psi, limit);
    return (touched.yield(t.s1, t.s3) <= 0) & (t.s1 <= limit);
  }

  /// Returns an elastic trial stress to the surface. The last step of Newton's method carries the derivatives of x.
  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &stress, History &history, const Surroundings &around) const {
    auto &[plastic_strain, dilation] = history;
    const PrincipalAxes<dim, Number> axes(stress);
    const auto trial = axes.values();
    using Value = decltype(trial.s1);
    double share = 1;
    if constexpr (divided) share = around.cohesion / divisor;
    const double found = solve({value_of(trial.s1), value_of(trial.s2), value_of(trial.s3)}, share);
    Dual<1> at(found);
    at.slope[0] = 1;
    const double slope =
        excess(Principal<>{value_of(trial.s1), value_of(trial.s2), value_of(trial.s3)}, at, share).slope[0];
    const Value step = excess(trial, Value(found), share) * (slope < 0 ? 1 / slope : 0);
    const Value free = found - step, x = found > least ? free : Value(found);
    const auto m = tangent(x, share).strength(sin_psi, limit);
    const Principal<Value> end = pyramid.admissible(trial, m);
    const Principal<Value> taken{trial.s1 - end.s1, trial.s2 - end.s2, trial.s3 - end.s3};
    const bool torn = !(end.s1 < m.tension);
    axes.subtract(taken, stress);
    plastic_strain += value_of(pyramid.shearing(taken));
    dilation += torn ? 0 : value_of(taken.s1 + taken.s2 + taken.s3) * (1 / (3 * K));
  }
};

template <class Use>
void HoekBrown::as_case(Use use) const {
  reads_shares || divisor != 1 ? use(HoekBrownCase<true>{*this}) : use(HoekBrownCase<false>{*this});
}

}  // namespace talus
