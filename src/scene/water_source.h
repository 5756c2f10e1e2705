#pragma once
/// [water] and [gas]: the fluids in the pores.
#include "base/units.h"
#include "scene/function.h"
#include "scene/water_table.h"

namespace talus {

enum class Compression { linear, exponential };
enum class PoreStress { net, bishop };
enum class PoreDrag { over_step, at_start };
enum class PoreStorage { mass, rate };
enum class PoreIntegration { at_start, at_end, automatic };

/// Pore water given as a function of place and time (phase model `drained`).
struct Water {
  bool given = false;                                    ///< the scene has a [water] table
  double density = 1000;                                 ///< [kg/m3]
  double bulk_modulus = 2.2e9;                           ///< K_l [Pa]
  double viscosity = 1e-3;                               ///< mu_l [Pa s]
  Compression compression = Compression::linear;         ///< density over pressure
  PoreStress stress = PoreStress::net;                   ///< what the pores take off the total stress
  PoreDrag drag = PoreDrag::over_step;                   ///< implicit in a step, or from the velocities at its start
  PoreStorage storage = PoreStorage::mass;               ///< what pressure follows from
  PoreIntegration pressure = PoreIntegration::at_start;  ///< whose forces act in a step
  Function suction;             ///< above the table, function of x, y, z [Pa]; not given: hydrostatic
  WaterTable table;             ///< pressure is hydrostatic below it
  Function level = 0.0;         ///< added to the elevation of the table, function of t [m]
  Function excess = 0.0;        ///< added to the hydrostatic pressure, function of x, y, z, t and `table` [Pa]
  bool open_water_load = true;  ///< open water above the ground rests on submerged faces
  template <class Visitor>
  void fields(Visitor &&v) {
    given = true;
    v.number("density", density, kilogram_per_cubic_metre, Range{1, 1e4, {950, 1250}}, "density of the pore water");
    v.number("bulk_modulus", bulk_modulus, pascal, Range{1e3, 1e11, {1e6, 3e9}}, "bulk modulus K_l of the pore water");
    v.number("viscosity", viscosity, pascal_second, Range{1e-8, 1e3, {2e-4, 2e-3}},
             "dynamic viscosity of the pore water");
    v.choice("compression", compression, {{"linear", Compression::linear}, {"exponential", Compression::exponential}},
             "density as a function of pressure P: rho_0 (1 + P / K_l) or rho_0 exp(P / K_l)");
    v.choice("stress", stress, {{"net", PoreStress::net}, {"bishop", PoreStress::bishop}},
             "stress pressure (total minus effective stress): the larger of the pressures of liquid and gas, or their "
             "mean weighted by saturation");
    v.choice("drag", drag, {{"implicit", PoreDrag::over_step}, {"explicit", PoreDrag::at_start}},
             "drag between soil and pore fluids: integrated implicitly over a step, or explicitly from the velocities "
             "at its start; explicit is for comparison (low permeability limits the step) and needs integrator.kind = "
             "\"euler\"");
    v.choice(
        "storage", storage, {{"mass", PoreStorage::mass}, {"rate", PoreStorage::rate}},
        "computation of pore pressure: from the mass of water in the pores, or by its rate from the present storage "
        "coefficient; rate is for comparison (it loses water near saturation) and needs phases = \"unsaturated\"");
    v.choice(
        "pressure", pressure,
        {{"explicit", PoreIntegration::at_start},
         {"implicit", PoreIntegration::at_end},
         {"auto", PoreIntegration::automatic}},
        "pore pressures that act in a step: those at its start, or those at its end, with which the step is that of "
        "dry soil; implicit needs phases = \"saturated\" or \"unsaturated\" and integrator.kind = \"euler\"; auto is "
        "implicit where that takes less time and the scene allows it");
    v.function("suction", suction, pascal, Range{0, 1e9, {0, 1e6}}, of::place,
               "initial suction above the water table, function of x, y, z; default: hydrostatic");
    v.water_table("table", table, metre,
                  "water table: polyline of points [x, elevation], or an expression of the level place for its "
                  "elevation, such as that of a grid, water(x, y); pressure is hydrostatic below it");
    v.function("level", level, metre, Range{-1e4, 1e4}, of::time, "rise of the whole water table, function of t");
    v.function(
        "excess", excess, pascal, Range{-1e9, 1e9, {-1e7, 1e7}}, of::place_time_and_table,
        "excess pressure, added to the hydrostatic pressure, function of x, y, z, t and `table` (elevation of "
        "the water table there); where it does not vanish at the surface of the soil it loads the surface too, so "
        "that a uniform excess has no effect");
    v.flag("open_water_load", open_water_load,
           "the weight of open water above the ground acts on the submerged ground");
  }
};

/// Pore gas of the phase model `three-phase`; pressures are gauge.
struct Gas {
  bool given = false;            ///< the scene has a [gas] table
  double density = 1.2;          ///< at atmospheric pressure [kg/m3]
  double bulk_modulus = 101325;  ///< K_g; an ideal gas has its absolute pressure [Pa]
  double viscosity = 1.8e-5;     ///< mu_g [Pa s]
  Function pressure = 0.0;       ///< initial, where gas is free, function of x, y, z [Pa]
  template <class Visitor>
  void fields(Visitor &&v) {
    given = true;
    v.number("density", density, kilogram_per_cubic_metre, Range{1e-6, 1e3, {0.5, 2}},
             "density of the pore gas at atmospheric pressure");
    v.number("bulk_modulus", bulk_modulus, pascal, Range{1, 1e9, {5e4, 1.5e5}},
             "bulk modulus K_g; for an ideal gas it is the atmospheric pressure");
    v.number("viscosity", viscosity, pascal_second, Range{1e-9, 1e3, {1e-5, 3e-5}},
             "dynamic viscosity of the pore gas");
    v.function("pressure", pressure, pascal, Range{-1e6, 1e9, {-1e5, 1e6}}, of::place,
               "initial gauge pressure of the gas above the water table, function of x, y, z");
  }
};

}  // namespace talus
