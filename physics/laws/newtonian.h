#pragma once
#include "physics/laws/history.h"
#include "physics/laws/isotropic_elastic.h"

namespace talus {

/// Weakly compressible viscous fluid, docs/theory/laws/viscous_fluids.md. Pressure p = -K ln J, K the `bulk_modulus`;
/// shear is Maxwell's: an elastic strain of modulus G in series with the viscosity mu, so that the stress of steady
/// flow is 2 mu D exactly, is reached within some mu / G, and the critical step is that of the wave speeds. Shear
/// stress and rate are tau = sqrt(J2) and sqrt(2 D:D). The step is implicit (Simo & Hughes 1998, sec. 2.7:
/// viscoplasticity).
struct Newtonian : IsotropicElastic {
  static constexpr const char *name = "newtonian";
  static constexpr const char *meaning = "weakly compressible viscous fluid";
  static constexpr auto history = shear_history;
  using History = std::array<double, history.size()>;
  static constexpr bool rate_dependent = true;
  static constexpr const char *no_reduction = "is a fluid, whose shear stress depends on the rate of strain";

  double viscosity = required;  ///< mu [Pa s]

  template <class Visitor>
  void fields(Visitor &&v) {
    IsotropicElastic::fields(v);
    v.number("viscosity", viscosity, pascal_second, Range{1e-9, 1e15, {1e-4, 1e10}}, "dynamic viscosity mu");
  }

  bool comes_apart() const { return true; }

  /// Viscous flow during the step, driven by the shear stress above `threshold` [Pa]. Tension is removed.
  template <int dim, class Number>
  [[gnu::always_inline]] void flow(Stress<dim, Number> &s, History &history, const Surroundings &around,
                                   double threshold) const {
    const Invariants<dim, Number> trial(s);
    const Number over = trial.q - threshold, excess = over > 0 ? over : 0;
    const Number slip =
        excess * (around.time_step / (viscosity + G * around.time_step));  // rate of shear times the step
    const Number shrink = trial.q > 0 ? G * slip / trial.q : 0;
    const Number p = trial.p < 0 ? trial.p : 0;
    trial.take_off(s, shrink, trial.p - p);
    auto &[plastic_strain] = history;
    plastic_strain += value_of(slip) * 0.57735026918962576;  // 1 / sqrt(3)
  }

  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &s, History &history, const Surroundings &around) const {
    flow(s, history, around, 0);
  }
};

}  // namespace talus
