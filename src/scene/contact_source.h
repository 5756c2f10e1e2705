#pragma once
/// [contact.NAME]: how two groups of bodies that move apart act on each other where they meet.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/function.h"

namespace talus {

struct ContactSource {
  std::string name;                  ///< the table's own name, [contact.NAME]
  std::vector<std::string> between;  ///< the two groups
  Function friction_angle;           ///< [rad]
  Function adhesion = 0.0;           ///< [Pa]
  double tensile_strength = 0;       ///< [Pa]
  bool bonded = false;               ///< the groups move as one where they meet
  template <class Visitor>
  void fields(Visitor &&v) {
    v.texts("between", between, "the two groups, names of contact_group of bodies");
    v.function("friction_angle", friction_angle, degree, {0, 89, {0, 45}}, of::place_and_time,
               "friction angle between both, function of x, y, z, t; 0: smooth");
    v.function("adhesion", adhesion, pascal, {0, 1e9, {100, 1e7, or_zero}}, of::place_and_time,
               "shear stress that both bear without normal stress, function of x, y, z, t");
    v.number("tensile_strength", tensile_strength, pascal, Range{0, 1e9, {100, 1e7, or_zero}},
             "tension that both bear while they touch: tension cut-off; 0: they part freely");
    v.flag("bonded", bonded, "they move as one body where they meet, and never part");
  }
  std::string problem() const {
    if (between.size() != 2 || between[0] == between[1]) return "between must name two different groups";
    if (bonded && (friction_angle.given() || tensile_strength > 0))
      return "bonded must be left out beside friction_angle or tensile_strength: a bond does not slide";
    if (!bonded && !friction_angle.given())
      return "needs friction_angle, the friction between both groups: 0 where it is smooth; or bonded = true";
    return "";
  }
};

}  // namespace talus
