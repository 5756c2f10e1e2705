#pragma once
#include <cmath>

#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/function.h"

namespace talus {

/// Contact with a rigid base: no penetration, free to separate, Coulomb friction and adhesion against sliding,
/// docs/theory (6.1), (6.2) and finite_elements.md section 2.1. Friction and adhesion may change with the slip of the
/// base at the place, theory (6.7). At a true edge each side is a constraint of its own, since one averaged normal
/// distorts the contact just where shearing starts; relief has one normal (node_normals.h).
struct Friction {
  static constexpr const char *name = "friction";
  static constexpr OnSoil in_motion = OnSoil::contact, quasi_static = OnSoil::contact;
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::wall;
  Function friction_angle = 0.0;
  Function base_adhesion = 0.0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.function("friction_angle", friction_angle, degree, {0, 89, {3, 45, or_zero}}, of::place_time_and_slip,
               "friction angle phi_b of the base, function of x, y, z, t and of the slip of the base at the place [m]");
    v.function("adhesion", base_adhesion, pascal, {0, 1e9, {100, 1e7, or_zero}}, of::place_time_and_slip,
               "adhesion of the base, function of x, y, z, t, slip");
  }
  double friction_coefficient(double x, double y, double z, double t, double slip) const {
    return std::tan(friction_angle(x, y, z, t, 0, slip));
  }
  double adhesion(double x, double y, double z, double t, double slip) const {
    return base_adhesion(x, y, z, t, 0, slip);
  }
  bool depends_on_slip() const { return friction_angle.uses("slip") || base_adhesion.uses("slip"); }
};

}  // namespace talus
