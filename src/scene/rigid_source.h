#pragma once
/// [rigid.NAME]: a rigid body or wall, its shape and its motion.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/function.h"

namespace talus {

struct RigidSource {
  std::string name;                          ///< the table's own name, [rigid.NAME]
  std::vector<std::vector<double>> polygon;  ///< corners of the section [m]
  std::vector<double> centre;                ///< about which it turns; empty: that of the polygon's area [m]
  std::vector<Function> velocity;            ///< of the centre, functions of t [m/s]
  Function rotation;                         ///< counter-clockwise, function of t [rad/s]
  double density = 0;                        ///< of a body that moves freely [kg/m3] ...
  double mass = 0, inertia = 0;              ///< ... or its mass [kg], and moment of inertia about the centre [kg m2]
  std::vector<double> initial_velocity;      ///< of a body that moves freely [m/s]
  std::vector<Function> force;               ///< on a body that moves freely, functions of t [N]
  double largest_speed = 0;                  ///< of a body that moves freely; 0: no limit [m/s]
  Function friction_angle;                   ///< [rad]
  Function adhesion = 0.0;                   ///< [Pa]
  template <class Visitor>
  void fields(Visitor &&v) {
    constexpr Unit newton{"N", 1, {1, 1, -2}}, kilogram{"kg", 1, {1}}, kilogram_square_metre{"kg m2", 1, {1, 2}},
        radian_per_second{"rad/s", 1, {0, 0, -1, 1}};
    v.points("polygon", polygon, metre, "corners of the section in their order, clockwise or counter-clockwise");
    v.point("centre", centre, metre,
            "point whose motion is that of the body, about which it turns; default: the centre of the polygon's area");
    v.functions("velocity", velocity, metre_per_second, of::time,
                "velocity of the centre, one function of t per component; default: at rest, or free with density or "
                "mass");
    v.function("rotation", rotation, radian_per_second, {-1e4, 1e4, {-10, 10}}, of::time,
               "rate of rotation about the centre, counter-clockwise, function of t; default: none, or free with "
               "density or inertia");
    v.number("density", density, kilogram_per_cubic_metre, Range{0, 1e5, {100, 20000, or_zero}},
             "density of a body that moves freely, under gravity and the pressure of the soil");
    v.number("mass", mass, kilogram, Range{0, 1e12}, "mass per metre of width, in place of density");
    v.number("inertia", inertia, kilogram_square_metre, Range{0, 1e15},
             "moment of inertia about the centre per metre of width, with mass; 0: that of a uniform density");
    v.point("initial_velocity", initial_velocity, metre_per_second,
            "velocity at the start of a body that moves freely");
    v.functions("force", force, newton, of::time,
                "force per metre of width on a body that moves freely, at its centre, one function of t per component");
    v.number("largest_speed", largest_speed, metre_per_second, Range{0, 1e4, {1e-6, 100, or_zero}},
             "speed of the centre of a body that moves freely that gravity and force do not exceed; 0: no limit");
    v.function("friction_angle", friction_angle, degree, {0, 89, {0, 45}}, of::place_and_time,
               "friction angle between the body and the soil, function of x, y, z, t; 0: smooth");
    v.function("adhesion", adhesion, pascal, {0, 1e9, {100, 1e7, or_zero}}, of::place_and_time,
               "shear stress that the body bears without normal stress, function of x, y, z, t");
  }
  /// Does it move as gravity, force and soil make it move?
  bool is_free() const { return density > 0 || mass > 0; }
  std::string problem() const {
    if (!friction_angle.given())
      return "needs friction_angle, the friction between body and soil: 0 where it is smooth";
    if (density > 0 && mass > 0) return "mass must be left out beside density, from which it follows";
    if (inertia > 0 && mass == 0) return "inertia must be given with mass";
    if (is_free() && !velocity.empty())
      return "velocity must be left out of a body that moves freely (density, mass): give initial_velocity or force";
    if (!is_free() && (!force.empty() || !initial_velocity.empty() || largest_speed > 0))
      return "needs density or mass to move freely under a force, an initial_velocity or a largest_speed; give "
             "velocity "
             "to move it as prescribed";
    return "";
  }
};

}  // namespace talus
