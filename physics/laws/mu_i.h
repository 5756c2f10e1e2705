#pragma once
#include <string>

#include "physics/laws/history.h"
#include "physics/laws/isotropic_elastic.h"
#include "scene/quantity.h"

namespace talus {

/// Dense granular flow: tau = mu(I) p with mu(I) = mu_s + (mu_2 - mu_s) / (1 + I_0 / I) and the inertial number
/// I = gamma_dot d / sqrt(p / rho_s), tau = sqrt(J2), gamma_dot = sqrt(2 D:D); elastic below mu_s p, no volume change
/// in shear, no tension. Sources: Jop, Forterre & Pouliquen (2006), Nature 441, eq. (1), (2); Dunatunga & Kamrin
/// (2015), J. Fluid Mech. 779, sec. 2 (elasto-plastic form; the implicit step is a quadratic).
struct MuI : IsotropicElastic {
  static constexpr const char *name = "mu_i";
  static constexpr const char *meaning = "dense granular flow with the friction mu(I)";
  static constexpr auto history = shear_history;
  using History = std::array<double, history.size()>;
  static constexpr bool rate_dependent = true;
  static constexpr const char *no_reduction =
      "has a friction that depends on the rate of strain, which is zero in equilibrium";

  double static_friction = required;    ///< mu_s, tau / p at rest [-]
  double limiting_friction = required;  ///< mu_2, tau / p of fast flow [-]
  double inertial_number = 0.3;         ///< I_0, where mu is half way [-]
  double grain_size = required;         ///< d [m]
  double solid_density = 2650;          ///< rho_s [kg/m3]

  template <class Visitor>
  void fields(Visitor &&v) {
    IsotropicElastic::fields(v);
    v.number("static_friction", static_friction, one, Range{0, 2, {0.1, 1}},
             "mu_s: ratio of shear stress to pressure at which flow begins");
    v.number("limiting_friction", limiting_friction, one, Range{0, 4, {0.2, 1.5}},
             "mu_2: ratio of shear stress to pressure in fast flow");
    v.number("inertial_number", inertial_number, one, Range{1e-6, 1e3, {0.01, 2}},
             "I_0: inertial number at which friction is the mean of mu_s and mu_2");
    v.number("grain_size", grain_size, metre, Range{1e-7, 10, {1e-5, 1}}, "diameter of the grains");
    v.number("solid_density", solid_density, kilogram_per_cubic_metre, Range{100, 1e4, {2000, 3500}},
             "density of the grains in I");
  }
  std::string problem() const {
    if (limiting_friction >= static_friction) return "";
    return "limiting_friction must not be below static_friction, " + shortest(static_friction);
  }
  bool comes_apart() const { return true; }

  double rate = 0;  ///< I_0 / (d sqrt(rho_s)), set by prepare() [1/(s sqrt(Pa))]
  void prepare() {
    IsotropicElastic::prepare();
    rate = inertial_number / (grain_size * std::sqrt(solid_density));
  }

  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &s, History &history, const Surroundings &around) const {
    const Invariants<dim, Number> trial(s);
    const Number pressure = trial.p < 0 ? -trial.p : Number(0);
    // Between rest = mu_s p and limit = mu_2 p the rate is gamma_dot = xi (tau - rest) / (limit - tau), xi = rate
    // sqrt(p). With tau = trial - G dt gamma_dot: tau^2 - b tau + c = 0, of which the smaller root is the one below the
    // limit.
    const Number rest = static_friction * pressure, limit = limiting_friction * pressure;
    const Number H = (G * around.time_step * rate) * sqrt(pressure);
    const Number b = trial.q + limit + H, c = trial.q * limit + H * rest;
    const Number apart = trial.q - limit;
    const Number root = sqrt(apart * apart + H * (H + 2 * (trial.q - rest) + 2 * (limit - rest)));
    const Number flowing = b > 0 ? 2 * c / (b + root) : b;
    const Number q = trial.q <= rest ? trial.q : flowing;
    const Number shrink = trial.q > 0 ? (trial.q - q) / trial.q : 0;
    const Number lift = trial.p + pressure;
    trial.take_off(s, shrink, lift);
    auto &[plastic_strain] = history;
    plastic_strain += value_of(trial.q - q) * (1 / (std::sqrt(3.) * G));
  }
};

}  // namespace talus
