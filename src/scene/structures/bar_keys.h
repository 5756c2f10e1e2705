#pragma once
/// Keys that all bars in the soil have.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/required.h"

namespace talus {

inline constexpr Unit newton{"N", 1, {1, 1, -2}}, newton_per_metre{"N/m", 1, {1, 0, -2}};

/// Values of one bar, or of a metre of width of a geogrid.
struct BarKeys {
  std::vector<std::vector<double>> points;  ///< line from the head to the end in the ground [m]
  double axial_stiffness = required;        ///< E A [N]
  double tensile_capacity = required;       ///< axial force at which it yields [N]
  double rupture_strain = 0;                ///< plastic strain at which it tears; 0: it does not [-]
  double spacing = 0;                       ///< out of plane, of plane strain; 0: not given [m]
  double compressive_capacity = 0;          ///< 0: it becomes slack [N]
  double bond_strength = 0;                 ///< force per length that its bond bears at most [N/m]
  double perimeter = 0;                     ///< on which adhesion and friction act [m]
  double bond_adhesion = 0;                 ///< [Pa]
  double bond_friction_angle = 0;           ///< [rad]
  double bond_stiffness = 0;                ///< force per length and slip; 0: from the soil [Pa]
  double plate_capacity = 0;                ///< force between the head and the soil under its plate; 0: no plate [N]
  double free_length = 0;                   ///< from the head, without bond [m]
  double prestress = 0;                     ///< of the free length when it is installed [N]
  bool reduce_strength = false;             ///< by a factor of safety
  bool sheet = false;                       ///< lies flat: the stress across it gives its friction; else all around it

 protected:
  template <class Visitor>
  void strength(Visitor &&v, Unit force) {
    v.points("points", points, metre, "line of the structure, from its head to its end in the ground");
    v.number("axial_stiffness", axial_stiffness, force, Range{1, 1e15}, "axial stiffness E A");
    v.number("tensile_capacity", tensile_capacity, force, Range{1e-3, 1e12}, "axial force at which it yields");
    v.number("rupture_strain", rupture_strain, one, Range{0, 10, {0.005, 0.5, or_zero}},
             "plastic strain at which it tears; 0: it yields without end");
  }
  template <class Visitor>
  void bond(Visitor &&v) {
    v.number("bond_adhesion", bond_adhesion, pascal, Range{0, 1e9, {100, 1e7, or_zero}},
             "shear stress that the bond bears without normal stress");
    v.number("bond_friction_angle", bond_friction_angle, degree, Range{0, 89, {5, 50, or_zero}},
             "friction angle of the bond, under the effective normal stress of the soil around");
    v.number("bond_stiffness", bond_stiffness, pascal, Range{0, 1e15},
             "force of the bond per length and slip; 0: ten times the shear modulus of the soil around");
  }
  template <class Visitor>
  void factor(Visitor &&v) {
    v.flag("reduce_strength", reduce_strength,
           "a factor of safety divides the capacities and the bond too; false: they are design values already");
  }
  template <class Visitor>
  void rod(Visitor &&v) {
    strength(v, newton);
    v.number("spacing", spacing, metre, Range{0, 1e3, {0.2, 20, or_zero}},
             "distance of the bars across the section, in plane strain; forces are those of one bar");
    v.number("bond_strength", bond_strength, newton_per_metre, Range{0, 1e9},
             "force per length that the bond bears at most, in place of diameter with bond_adhesion and "
             "bond_friction_angle");
    bond(v);
    factor(v);
  }
};

}  // namespace talus
