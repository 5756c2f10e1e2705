#pragma once
#include "physics/laws/newtonian.h"

namespace talus {

/// Bingham fluid: at rest below its yield stress, flowing above it with tau = tau_y + mu gamma_dot (Bingham 1922). At
/// rest it is elastic, so no regularised viscosity is needed: the two branches meet exactly at tau_y.
struct Bingham : Newtonian {
  static constexpr const char *name = "bingham";
  static constexpr const char *meaning = "viscous fluid with a yield stress: mud, debris";

  double yield_stress = required;  ///< tau_y, in simple shear [Pa]

  template <class Visitor>
  void fields(Visitor &&v) {
    Newtonian::fields(v);
    v.number("yield_stress", yield_stress, pascal, Range{0, 1e9, {0, 1e6}}, "yield stress in simple shear");
  }

  template <int dim, class Number>
  [[gnu::always_inline]] void correct(Stress<dim, Number> &s, History &history, const Surroundings &around) const {
    flow(s, history, around, yield_stress);
  }
};

}  // namespace talus
