#pragma once
/// [body.NAME]: a soil, where it is and how it begins.
#include <string>
#include <vector>

#include "base/units.h"
#include "scene/deferred.h"
#include "scene/function.h"
#include "scene/permeability_change.h"
#include "scene/water_table.h"

namespace talus {

/// A box in which a body gets more particles per cell.
struct DenseBox {
  std::vector<double> from, to;
  int particles_per_cell = 0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("from", from, metre, "corner of the box with the smallest coordinates");
    v.point("to", to, metre, "corner of the box with the largest coordinates");
    v.integer("particles_per_cell", particles_per_cell, Range{1, 1000, {3, 64}},
              "particles per cell at the start, in cells whose centre is in the box");
  }
};

inline constexpr Range weight_of_soil{1e3, 1e5, {10e3, 30e3}};  ///< of unit weights [N/m3]

struct BodySource {
  std::string name;                   ///< the table's own name, [body.NAME]
  std::vector<std::string> region;    ///< physical groups of cells
  std::string contact_group;          ///< bodies of one group stick where they meet; empty: that of all without one
  double unit_weight = 0;             ///< total, above the water table if it differs below it [N/m3]; gives density
  double saturated_unit_weight = 0;   ///< total, below the water table [N/m3]; gives grain_density
  double density = 0;                 ///< total density [kg/m3]; or porosity and grain_density
  double porosity = 0;                ///< [-]
  double grain_density = 0;           ///< [kg/m3]
  double saturation = 0;              ///< of the pores above the water table [-]
  double pore_pressure_ratio = 0;     ///< r_u: pore pressure over the weight of the soil above [-]
  WaterTable water_table;             ///< of its own
  bool reduce_strength = true;        ///< by a factor of safety
  double permeability = 0;            ///< intrinsic, k [m2]; or hydraulic_conductivity
  double hydraulic_conductivity = 0;  ///< k rho_w g / mu_w [m/s]
  double gas_permeability = 0;        ///< intrinsic, of the gas [m2]; 0: that of the liquid
  PermeabilityChange permeability_change = PermeabilityChange::none;  ///< with porosity
  DeferredTable retention;                                            ///< [body.NAME.retention], read by physics/pores
  DeferredTable relative_permeability;                                ///< [body.NAME.relative_permeability], likewise
  int particles_per_cell = 0;                                         ///< 0: 3 a triangle, 4 a tetrahedron
  double k0 = 0;             ///< lateral over vertical effective stress at rest [-]; 0: 1 - sin phi (Jaky 1944)
  double damping_ratio = 0;  ///< of Rayleigh damping, at both frequencies of a stage [-]
  double volume_cap = -1;    ///< largest volume over rest volume; 0: none; -1: 1 for soil that comes apart, else none
  double averaging_length = 0;     ///< l of the average of plastic strain that the law takes for its own [m]; 0: none
  std::vector<Function> velocity;  ///< initial velocity, functions of the place [m/s]
  std::vector<Function> displacement;  ///< initial displacement, functions of the undeformed place [m]
  std::vector<Function> stress;  ///< initial stress, functions of the undeformed place: xx, yy, zz, xy, yz, xz [Pa]
  std::vector<Function> body_acceleration;  ///< beside gravity, functions of the undeformed place and t [m/s2]
  std::vector<DenseBox> dense;
  DeferredTable law;  ///< "law" and its parameters, read by physics/laws
  template <class Visitor>
  void fields(Visitor &&v) {
    v.texts("region", region,
            "name (or list of names) of the physical groups of cells that the body fills at the start");
    v.text(
        "contact_group", contact_group,
        "group to which the body belongs: groups part and slide where they meet, as [contact.NAME] says, and bodies of "
        "one group stick; default: one group, \"default\"");
    v.number("density", density, kilogram_per_cubic_metre, Range{1e-3, 1e5, {800, 3500}},
             "total density, above and below the water table; or give unit_weight, or porosity and grain_density");
    v.number("unit_weight", unit_weight, newton_per_cubic_metre, weight_of_soil,
             "total unit weight in place of density; with saturated_unit_weight that above the water table");
    v.number("saturated_unit_weight", saturated_unit_weight, newton_per_cubic_metre, weight_of_soil,
             "total unit weight of saturated soil: below the water table, with unit_weight above it; where pore fluids "
             "move, with porosity and in place of grain_density");
    v.number("porosity", porosity, one, Range{0, 0.99, {0.05, 0.8}}, "porosity n");
    v.number("grain_density", grain_density, kilogram_per_cubic_metre, Range{1, 1e5, {2000, 3500}},
             "density of the solid grains rho_s");
    v.number("saturation", saturation, one, Range{0, 1}, "degree of saturation above the water table");
    v.number("pore_pressure_ratio", pore_pressure_ratio, one, Range{0, 1, {0, 0.7}},
             "r_u: pore pressure over the weight per area of the soil above, as it lies at the start, in place of that "
             "of [water]; needs phases = \"drained\" and unit_weight");
    v.water_table(
        "water_table", water_table, metre,
        "water table or piezometric line of this soil, given as water.table is and in place of it in the regions that "
        "the body fills at the start; water.level and water.excess apply to it; the pressure may "
        "jump at the border of these regions; needs phases = \"drained\"");
    v.flag(
        "reduce_strength", reduce_strength,
        "a factor of safety divides the strength of this body; false: it keeps its strength, as rock or a structure");
    v.number("permeability", permeability, square_metre, Range{0, 1e-3, {1e-20, 1e-8}},
             "intrinsic permeability k; or give hydraulic_conductivity");
    v.number("hydraulic_conductivity", hydraulic_conductivity, metre_per_second, Range{0, 1e3, {1e-13, 0.1}},
             "hydraulic conductivity k rho_w g / mu_w; or give permeability");
    v.number("gas_permeability", gas_permeability, square_metre, Range{0, 1e-3, {1e-20, 1e-8, or_zero}},
             "intrinsic permeability for the gas; 0: the same as for the liquid");
    v.choice("permeability_change", permeability_change,
             {{"none", PermeabilityChange::none},
              {"kozeny_carman", PermeabilityChange::kozeny_carman},
              {"grain_share", PermeabilityChange::grain_share}},
             "dependence of permeability on porosity n: none, n^3 / (1 - n)^2, or 1 / (1 - n)^2");
    v.deferred_table("retention", retention, "degree of saturation over suction");
    v.deferred_table("relative_permeability", relative_permeability, "permeability over degree of saturation");
    v.integer("particles_per_cell", particles_per_cell, Range{0, 1000, {3, 64, or_zero}},
              "particles per cell at the start; 0: 3 in a triangle, 4 in a tetrahedron");
    v.number("k0", k0, one, Range{0, 10, {0.2, 3, or_zero}},
             "ratio of lateral to vertical effective stress at rest, for stages with initial_stress = \"k0\"; 0: 1 - "
             "sin(friction_angle)");
    v.number("damping_ratio", damping_ratio, one, Range{0, 0.5, {0.002, 0.2, or_zero}},
             "Rayleigh damping: ratio of critical damping that the soil has at both damping_frequencies of a stage, "
             "about a minimum between them; acts in stages with damping_frequencies");
    v.number("volume_cap", volume_cap, one, Range{-1, 100, {-1, 2}},
             "largest ratio of the volume of a particle to that which it has without stress and gaps; 0: no cap; -1: a "
             "cap of 1 for soil that comes apart, where pore fluids do not move");
    v.number("averaging_length", averaging_length, metre, Range{0, 1e4, {1e-3, 50, or_zero}},
             "nonlocal softening: plastic strain is averaged over this length l, with 2 l in place of the cell size; "
             "0: no averaging; l should be 1.25 times the cell size or more");
    v.functions("velocity", velocity, metre_per_second, of::place,
                "initial velocity, one function of x, y, z per component");
    v.functions("displacement", displacement, metre, of::place,
                "initial displacement, one function of the undeformed x, y, z per component");
    v.functions("stress", stress, pascal, of::place,
                "initial stress xx, yy, zz, xy (in 3D also yz, xz), functions of the undeformed x, y, z");
    v.functions("body_acceleration", body_acceleration, metre_per_second_squared, of::place_and_time,
                "acceleration in addition to gravity, functions of the undeformed x, y, z and of t");
    v.list("dense", dense, "boxes with more particles per cell");
    v.deferred("law", law, "soil law; its parameters are keys of the same table");
  }
};

}  // namespace talus
