#pragma once
#include "physics/boundary/friction.h"

namespace talus {

/// A base with friction that heats itself as soil slides on it: the water in the shear zone expands, and what pressure
/// does not drain away takes off the effective stress that rubs, docs/theory (6.8)-(6.11). Quasi-static stages take it
/// fresh and cold.
struct HeatedFriction : Friction {
  static constexpr const char *name = "heated_friction";
  static constexpr const char *meaning =
      "base with friction whose shear zone is heated by sliding and loses friction to excess pore pressure";
  ShearZone zone;
  template <class Visitor>
  void fields(Visitor &&v) {
    Friction::fields(v);
    zone.fields(v);
  }
  std::string problem() const { return zone.problem(); }
  const ShearZone &shear_zone() const { return zone; }
};

}  // namespace talus
