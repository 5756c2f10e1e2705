#pragma once
/// The scene as plain structs: SI units, radians, defaults; no PETSc, no TOML. `fields` names every key once; the
/// reader, `talus describe`, the header of results and the test that every key is documented all visit it
/// (docs/reference/values.md).
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.h"
#include "scene/deferred.h"
#include "scene/earthquake_source.h"
#include "scene/function.h"
#include "scene/water_table.h"

namespace talus {

/// A number with this initial value has no default: the scene must give it.
inline constexpr double required = std::numeric_limits<double>::quiet_NaN();

enum class PhaseModel { dry, drained, saturated, unsaturated, three_phase };
/// As scenes name it.
inline const char *name_of(PhaseModel phases) {
  constexpr const char *names[] = {"dry", "drained", "saturated", "unsaturated", "three-phase"};
  return names[static_cast<int>(phases)];
}
/// Do pore fluids move on their own?
inline bool fluids_move(PhaseModel phases) { return phases != PhaseModel::dry && phases != PhaseModel::drained; }

/// A box in which cells or particles are finer.
struct RefineBox {
  std::vector<double> from, to;  ///< opposite corners [m]
  double size = required;        ///< cell size inside [m]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("from", from, metre, "corner of the box with the smallest coordinates");
    v.point("to", to, metre, "corner of the box with the largest coordinates");
    v.number("size", size, metre, Range{1e-6, 1e5}, "cell size inside the box");
  }
};

/// The axis along which elevations are counted; gravity acts against it.
enum class Up { y = 1, z = 2 };

enum class WhenOutside { stop, remove };

/// A slip surface: the lower side of an ellipsoid whose first axis points down the dip, the second along the strike.
struct EllipsoidSource {
  bool given = false;                     ///< the scene has the table
  std::vector<double> centre, semi_axes;  ///< x, y, elevation of the map; down the dip, along the strike, normal [m]
  double dip = 0, dip_direction = 0;      ///< [rad]
  template <class Visitor>
  void fields(Visitor &&v) {
    given = true;
    v.point("centre", centre, metre, "centre: x, y and elevation in the coordinates of the terrain file");
    v.point("semi_axes", semi_axes, metre,
            "half lengths of the axes: down the dip, along the strike, along the normal");
    v.number("dip", dip, degree, Range{0, 89}, "angle by which the first axis falls below the horizontal");
    v.number("dip_direction", dip_direction, degree, Range{-360, 360},
             "azimuth, clockwise from north, towards which the first axis falls: 90 deg is east");
  }
};

/// A surface below which soil is of another kind, by a grid.
struct LayerSource {
  std::string name;  ///< the table's own name, [mesh.terrain.layer.NAME], and that of the group of its cells
  std::string file;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path("file", file, "grid of the elevations of the upper surface of the layer, relative to the scene");
  }
};

/// How deep a slip surface is within an outline.
enum class DepthShape { bowl, constant };

/// A terrain file and what is cut out of it.
struct TerrainSource {
  std::string file;            ///< ESRI ASCII, GeoTIFF; empty: no terrain
  std::vector<double> window;  ///< west, south, east, north of the map [m]; empty: all
  int step = 1;                ///< every so many-th row and column
  std::vector<double> base;    ///< elevation of a flat base [m]; empty: the mesh begins at the bed
  double air = 0;              ///< height of free space above the ground [m]
  double far_size = 0;         ///< of cells far from slide and ground [m]; 0: mesh.size
  std::string slip_surface;    ///< a grid; empty: none
  EllipsoidSource ellipsoid;   ///< in place of a grid
  std::string outline;         ///< of the slide, in place of both; polygons of a Shapefile or GeoPackage
  double depth = 0;            ///< largest, within the outline [m]
  DepthShape depth_shape = DepthShape::bowl;
  std::vector<LayerSource> layer;        ///< from top to bottom
  std::vector<std::vector<double>> way;  ///< line x, y of the map, along which cells are as small as in the slide [m]
  double way_width = 0;                  ///< [m]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path("file", file, "terrain file, ESRI ASCII or GeoTIFF with coordinates and elevations in metres");
    v.point("window", window, metre,
            "west, south, east, north in the coordinates of the file, each moved to the nearest column or row of it; "
            "default: all of it");
    v.integer("step", step, Range{1, 1000},
              "decimation: every so many-th row and column of the file is used, and a slip surface and layers "
              "are known at these places alone");
    v.point("base", base, metre,
            "elevation of a flat base: soil is meshed from there to the ground; without it the mesh is the space above "
            "the bed, which is the ground lowered to the slip surface");
    v.number("air", air, metre, Range{0, 1e4}, "height of the free space above the ground, in which soil may move");
    v.number("far_size", far_size, metre, Range{0, 1e5},
             "cell size far from the slide, and from the ground below it; 0: mesh.size everywhere");
    v.path("slip_surface", slip_surface, "grid of the elevations of a slip surface, relative to the scene");
    v.table("ellipsoid", ellipsoid, "slip surface: the lower side of an ellipsoid");
    v.path("outline", outline,
           "outline of a slide, whose slip surface is `depth` below the ground within it: polygons of a Shapefile or "
           "GeoPackage in the projection of the terrain, relative to the scene");
    v.number("depth", depth, metre, Range{0, 1e4}, "largest depth of the slip surface within the outline");
    v.choice("depth_shape", depth_shape, {{"bowl", DepthShape::bowl}, {"constant", DepthShape::constant}},
             "bowl: from 0 at the outline to `depth`, with the same curvature everywhere, as by the sloping local base "
             "level; constant: `depth` everywhere, with a vertical wall along the outline");
    v.named("layer", layer,
            "layers of soil over a flat base, from top to bottom, [mesh.terrain.layer.NAME]: cells below the surface "
            "of a layer are the group NAME in place of `ground`");
    v.points("way", way, metre,
             "line of points [x, y] of the map along which the slide flows: within way_width cells measure mesh.size, "
             "as in the slide");
    v.number("way_width", way_width, metre, Range{0, 1e5}, "width of the strip along the way");
  }
};

/// When the mesh is divided among the ranks in another way.
enum class BalanceRanks { when_it_pays, never, always };

struct MeshSource {
  std::string file;          ///< Gmsh .msh, 2.2 or 4.1, with physical groups
  std::string section;       ///< section, CSV or DXF, meshed by talus-mesh
  TerrainSource terrain;     ///< meshed by talus-mesh
  double size = 0;           ///< cell size of a section or of terrain [m]
  double thickness = 0;      ///< of a 3D body cut from a section [m]; 0: one cell size
  int layers = 1;            ///< element layers over the thickness; 0: free tetrahedra
  std::vector<double> cuts;  ///< z at which regions of a 3D body from a section are parted [m]
  std::vector<RefineBox> refine;
  int halvings = 0;                                   ///< of the edges of all cells, once ranks have their parts
  WhenOutside leaving_particles = WhenOutside::stop;  ///< particles that leave the mesh
  BalanceRanks balance_ranks = BalanceRanks::when_it_pays;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path("file", file, "Gmsh mesh file (.msh, format 2.2 or 4.1) with physical groups, relative to the scene");
    v.path("section", section,
           "section, a CSV file or a DXF drawing, that talus-mesh turns into a mesh; relative to the scene");
    v.number("size", size, metre, Range{0, 1e5},
             "cell size of a mesh made from a section or terrain; of terrain in the slide and at the ground");
    v.number("thickness", thickness, metre, Range{0, 1e5},
             "thickness of a 3D body cut from a section; 0 is one cell size");
    v.integer("layers", layers, Range{0, 1000}, "element layers over the thickness; 0 gives unstructured tetrahedra");
    v.point("cuts", cuts, metre,
            "ascending z that divide the thickness: regions are then named region_1, region_2, ... along z");
    v.list("refine", refine, "boxes with smaller cells, of a section; on terrain see mesh.terrain");
    v.integer("halvings", halvings, Range{0, 4},
              "how often the edges of all cells are halved, each time for 4 times as many triangles or 8 times as many "
              "tetrahedra; ranks do it after the mesh has been divided among them, so that none holds all cells");
    v.table("terrain", terrain, "terrain that talus-mesh turns into a mesh; needs dimension = 3 and up = \"z\"");
    v.choice("leaving_particles", leaving_particles, {{"stop", WhenOutside::stop}, {"remove", WhenOutside::remove}},
             "what becomes of particles that leave the mesh: the run ends with the place, or they are taken out of the "
             "simulation and entered in escaped.csv; may be changed with --resume");
    v.choice(
        "balance_ranks", balance_ranks,
        {{"when_it_pays", BalanceRanks::when_it_pays},
         {"never", BalanceRanks::never},
         {"always", BalanceRanks::always}},
        "when the mesh is divided among the ranks of a run in another way, because the soil has moved: once ranks "
        "have waited for others longer than that takes, never, or at every remap, which shows that the answer does "
        "not depend on it; may be changed with --resume");
  }
};

/// A box in which a body gets more particles per cell.
struct DenseBox {
  std::vector<double> from, to;
  int particles_per_cell = 0;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("from", from, metre, "corner of the box with the smallest coordinates");
    v.point("to", to, metre, "corner of the box with the largest coordinates");
    v.integer("particles_per_cell", particles_per_cell, Range{1, 1000, {1, 64}},
              "particles per cell at the start, in cells whose centre is in the box");
  }
};

enum class PermeabilityChange { none, kozeny_carman, grain_share };

inline constexpr Range weight_of_soil{1e3, 1e5, {10e3, 30e3}};  ///< of unit weights [N/m3]

struct BodySource {
  std::string name;                   ///< the table's own name, [body.NAME]
  std::vector<std::string> region;    ///< physical groups of cells
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
  double k0 = 0;           ///< lateral over vertical effective stress at rest [-]; 0: 1 - sin phi (Jaky 1944)
  double volume_cap = -1;  ///< largest volume over rest volume; 0: none; -1: 1 for soil that comes apart, else none
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
    v.integer("particles_per_cell", particles_per_cell, Range{0, 1000, {1, 64, or_zero}},
              "particles per cell at the start; 0: 3 in a triangle, 4 in a tetrahedron");
    v.number("k0", k0, one, Range{0, 10, {0.2, 3, or_zero}},
             "ratio of lateral to vertical effective stress at rest, for stages with initial_stress = \"k0\"; 0: 1 - "
             "sin(friction_angle)");
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

struct BoundarySource {
  std::string name;                ///< the table's own name, [boundary.NAME]
  std::vector<std::string> group;  ///< physical groups of facets; empty: the table's own name
  DeferredTable kind;              ///< "kind" and its parameters, read by physics/boundary
  template <class Visitor>
  void fields(Visitor &&v) {
    v.texts("group", group, "name (or list of names) of the physical groups of facets; default: the name of the table");
    v.deferred("kind", kind, "kind of boundary; its parameters are keys of the same table");
  }
};

enum class Compression { linear, exponential };
enum class PoreStress { net, bishop };
enum class PoreDrag { over_step, at_start };
enum class PoreStorage { mass, rate };

/// Pore water given as a function of place and time (phase model `drained`).
struct Water {
  bool given = false;                             ///< the scene has a [water] table
  double density = 1000;                          ///< [kg/m3]
  double bulk_modulus = 2.2e9;                    ///< K_l [Pa]
  double viscosity = 1e-3;                        ///< mu_l [Pa s]
  Compression compression = Compression::linear;  ///< density over pressure
  PoreStress stress = PoreStress::net;            ///< what the pores take off the total stress
  PoreDrag drag = PoreDrag::over_step;            ///< implicit in a step, or from the velocities at its start
  PoreStorage storage = PoreStorage::mass;        ///< what pressure follows from
  Function suction;                               ///< above the table, function of x, y, z [Pa]; not given: hydrostatic
  WaterTable table;                               ///< pressure is hydrostatic below it
  Function level = 0.0;                           ///< added to the elevation of the table, function of t [m]
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

enum class StageKind { dynamic, quasi_static, seepage, consolidation };
enum class InitialStress { kept, k0 };
enum class WhenLost { stop, go_on };
enum class StopWhen { duration, equilibrium, rest, failure };

/// Is it solved by finite elements?
inline bool is_static(StageKind kind) { return kind != StageKind::dynamic; }
/// Does pore water flow in it by finite elements?
inline bool water_flows(StageKind kind) { return kind == StageKind::seepage || kind == StageKind::consolidation; }

struct Stage {
  std::string name;
  StageKind kind = StageKind::dynamic;
  double duration = required;  ///< longest duration [s]
  StopWhen until = StopWhen::duration;
  double damping = 0;           ///< local (Cundall) damping factor alpha [-]
  double gravity_ramp = 0;      ///< gravity and pore pressure grow linearly over this time [s]
  double force_ratio = 1e-3;    ///< equilibrium: unbalanced over applied force [-]
  double energy_ratio = 1e-6;   ///< equilibrium: kinetic over strain energy [-]
  double rest_speed = 1e-3;     ///< rest: the root mean square speed of all soil stays below this [m/s]
  std::string failure_point;    ///< failure: named output point that is watched
  double failure_speed = 0.01;  ///< failure: its mean speed passes this [m/s] ...
  double failure_time = 1;      ///< ... over this time [s]
  bool earthquake = false;      ///< the base moves as [[earthquake]] says, from the begin of the stage
  bool pore_flow = true;        ///< pore fluids move; false: pore pressures are those of [water], as in a drained scene
  bool softening = true;        ///< soil remembers plastic strain; false: it keeps the strength it has
  bool hold_loads = false;      ///< functions of time stand still: their t counts only stages that do not hold loads
  bool reset_displacement = false;  ///< displacements, velocities and plastic strain are zeroed when the stage ends
  // quasi-static stages
  int load_steps = 5;  ///< in which loads come; fewer or more as Newton's iterations ask for
  InitialStress initial_stress = InitialStress::kept;
  std::vector<std::string> add, remove;  ///< bodies that come and go with the stage
  WhenLost when_lost = WhenLost::stop;
  bool steady = false;                      ///< seepage: the flow that the loads at the stage's end keep up
  std::vector<double> seismic_coefficient;  ///< pseudo-static inertia over weight, by axis [-]; empty: none
  /// Is the soil brought to rest, so that damping does no harm?
  bool settles() const { return until == StopWhen::equilibrium || gravity_ramp > 0; }
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("name", name, "name of the stage in logs and results; default: its number, from 0");
    v.choice("kind", kind,
             {{"dynamic", StageKind::dynamic},
              {"quasi_static", StageKind::quasi_static},
              {"seepage", StageKind::seepage},
              {"consolidation", StageKind::consolidation}},
             "motion by the material point method, or by finite elements: static equilibrium, flow of pore water "
             "through soil at rest, or consolidation (both in time)");
    v.choice("until", until,
             {{"duration", StopWhen::duration},
              {"equilibrium", StopWhen::equilibrium},
              {"rest", StopWhen::rest},
              {"failure", StopWhen::failure}},
             "criterion that ends the stage before its duration");
    v.number("duration", duration, second, Range{0, 1e12, is_static(kind) ? Usual{} : Usual{0, 86400}},
             "longest duration of the stage. Motion takes steps shorter than a wave through a cell, and slides take "
             "seconds to minutes: what goes on for days belongs to stages of another kind");
    v.number("gravity_ramp", gravity_ramp, second, Range{0, 1e9},
             "time in which gravity and pore pressure increase linearly from 0");
    v.number("damping", damping, one, Range{0, 0.99, settles() ? Usual{0, 0.8} : Usual{0, 0.1}},
             "local (Cundall) damping factor; soil that slides is slowed by it, soil that settles (until = "
             "\"equilibrium\" or a gravity_ramp) comes to rest fastest with 0.7");
    v.point("seismic_coefficient", seismic_coefficient, one, Usual{0, 0.6},
            "pseudo-static earthquake: inertia force over weight, one component per dimension, positive along the "
            "axes, such as [0.15, 0]; it acts on soil and pore water, and the water table stays where it is");
    v.number("force_ratio", force_ratio, one, Range{0, 1, {1e-6, 0.05}},
             "equilibrium: largest ratio of unbalanced to applied nodal forces");
    v.number("energy_ratio", energy_ratio, one, Range{0, 1, {1e-12, 1e-2}},
             "equilibrium: largest ratio of kinetic to elastic strain energy");
    v.number("rest_speed", rest_speed, metre_per_second, Range{0, 1e6, {1e-5, 0.1}},
             "rest: the root mean square speed of all soil remains below this value and does not rise; a stage "
             "does not end while what acts has still to change within its duration, or pore fluids move, unless "
             "hold_loads = true");
    v.flag("earthquake", earthquake,
           "the base moves as [[earthquake]] says, from the begin of the stage on; displacements and velocities are those "
           "relative to it");
    v.text("failure_point", failure_point, "failure: name of the output point whose velocity is tested");
    v.number("failure_speed", failure_speed, metre_per_second, Range{0, 1e6, {1e-4, 1}},
             "failure: speed that the mean velocity of the point over failure_time must exceed");
    v.number("failure_time", failure_time, second, Range{0, 1e9, {0.01, 60}},
             "failure: time of this mean, no shorter than the period of the slowest vibration; from half of it on, the "
             "soil must "
             "store less than a fifth of the energy that it receives");
    v.flag(
        "pore_flow", pore_flow,
        "pore fluids move; if false, pore pressures are those of [water], scaled by the ramp, as for initial stress");
    v.flag(
        "softening", softening,
        "plastic strain is recorded and softens the soil; if false, strength does not change, as for initial stress; "
        "dilation is recorded in any case");
    v.flag("hold_loads", hold_loads,
           "functions of time stand still: their t advances only in stages with hold_loads = false");
    v.flag("reset_displacement", reset_displacement,
           "set displacement, velocity and plastic strain to zero at the end of the stage");
    v.integer(
        "load_steps", load_steps, Range{1, 10000, {1, 200}},
        "quasi-static: number of steps in which loads are applied; a step is halved where Newton's iterations fail");
    v.choice("initial_stress", initial_stress, {{"kept", InitialStress::kept}, {"k0", InitialStress::k0}},
             "quasi-static: stress at the start of the stage: the present stress, or vertical stress from the weight "
             "above and k0 times it laterally");
    v.texts("add", add, "quasi-static: bodies that this stage adds; they are absent before it");
    v.texts("remove", remove, "quasi-static: bodies that this stage removes");
    v.choice(
        "when_lost", when_lost, {{"stop", WhenLost::stop}, {"next_stage", WhenLost::go_on}},
        "quasi-static: if there is no equilibrium under the loads, end with status 1 or continue with the next stage");
    v.flag("steady", steady, "seepage: compute the steady flow under the loads at the end of the stage");
  }
};

enum class Velocity { flip, pic };
enum class Integration { blended, particle, mixed, cell };
enum class Locking { patches, none, nodal };
enum class PoreSmoothing { nodal, none };

/// How particles and nodes exchange what they know (docs/theory section 4).
struct Transfer {
  Velocity velocity = Velocity::flip;
  double relaxation =
      400;  ///< FLIP relaxes to PIC with this time constant, in units of smallest altitude over wave speed; 0: never
  double pic_fraction = 0;  ///< PIC share per remap, beside the relaxation [-]
  Integration integration = Integration::blended;
  bool average_stress = true;  ///< one stress per cell and body, averaged at each remap
  Locking locking = Locking::patches;
  PoreSmoothing pore_smoothing = PoreSmoothing::nodal;  ///< against the noise of equal-order elements in saturated soil
  double remap_interval = 0.1;  ///< remap when a node has moved this share of its mean edge; 0: every step
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice("velocity", velocity, {{"flip", Velocity::flip}, {"pic", Velocity::pic}},
             "how particles take their velocity from the nodes");
    v.number(
        "relaxation", relaxation, one, Range{0, 1e9, {20, 1e4}},
        "time constant of the relaxation of FLIP to PIC, in units of smallest altitude / wave speed; 0: no relaxation");
    v.number("pic_fraction", pic_fraction, one, Range{0, 1, {0, 0.1}},
             "PIC share at each remap, in addition to the relaxation");
    v.choice("integration", integration,
             {{"blended", Integration::blended},
              {"particle", Integration::particle},
              {"mixed", Integration::mixed},
              {"cell", Integration::cell}},
             "integration volume of a cell");
    v.flag("average_stress", average_stress, "one stress per cell and body, averaged at each remap");
    v.choice("locking", locking, {{"patches", Locking::patches}, {"none", Locking::none}, {"nodal", Locking::nodal}},
             "cure of volumetric locking; nodal smooths strain alone, and creates energy in soil that dilates");
    v.choice("pore_smoothing", pore_smoothing, {{"nodal", PoreSmoothing::nodal}, {"none", PoreSmoothing::none}},
             "smoothing of pore pressures and fluid volumes of saturated cells through their nodes");
    v.number("remap_interval", remap_interval, one, Range{0, 0.3},
             "remap when a node of a filled cell has moved by this share of its mean edge; 0: remap in every step");
  }
};

enum class Elements { quadratic, linear, patches };
enum class LinearSolver { automatic, direct, iterative };

/// Finite elements of quasi-static stages (docs/theory/finite_elements.md).
struct QuasiStaticSource {
  Elements elements = Elements::quadratic;
  double tolerance = 1e-8;      ///< Newton: out-of-balance force over the size of the forces [-]
  int iterations = 25;          ///< Newton: most iterations in a load step
  double smallest_step = 1e-3;  ///< share of a stage's loads below which equilibrium counts as lost [-]
  LinearSolver linear_solver = LinearSolver::automatic;
  double step_error = 1e-3;  ///< seepage, consolidation: what a step may miss, of pressure over its largest change and
                             ///< of saturation [-]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice("elements", elements,
             {{"quadratic", Elements::quadratic}, {"linear", Elements::linear}, {"patches", Elements::patches}},
             "displacement of second order, of first order, or of first order with the patches against locking that "
             "the motion of particles uses");
    v.number(
        "tolerance", tolerance, one, Range{1e-14, 1e-2, {1e-12, 1e-4}},
        "Newton's iterations end when the ratio of the out-of-balance force to the applied forces is below this value");
    v.integer("iterations", iterations, Range{1, 1000, {5, 200}},
              "largest number of iterations in a load step, after which the step is halved");
    v.number("smallest_step", smallest_step, one, Range{1e-9, 1, {1e-6, 0.1}},
             "smallest step, as a share of the loads of the stage; equilibrium is lost if a smaller one is needed");
    v.choice("linear_solver", linear_solver,
             {{"automatic", LinearSolver::automatic},
              {"direct", LinearSolver::direct},
              {"iterative", LinearSolver::iterative}},
             "direct: LU (MUMPS); iterative: GMRES with algebraic multigrid (GAMG); automatic: chosen by the number of "
             "unknowns");
    v.number("step_error", step_error, one, Range{1e-8, 1, {1e-5, 0.05}},
             "seepage and consolidation: allowed error of a time step, of pressure relative to its largest change so "
             "far, which counts as a hundredth of the largest pressure at least, and of saturation");
  }
};

/// Where `talus solve --factor-of-safety` divides strength, and how many mechanisms it searches for.
struct FactorSource {
  std::vector<std::vector<double>> within;  ///< polygon x, elevation [m]; empty: everywhere
  std::vector<std::vector<double>> along;   ///< line x, elevation [m]; empty: everywhere
  double width = 0;                         ///< of the band along the line [m]; 0: two cells
  int mechanisms = 1;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.points(
        "within", within, metre,
        "polygon of points [x, elevation] to which the search is confined: strength is divided inside it, elsewhere "
        "soil keeps its strength; in 3D across its whole width");
    v.points(
        "along", along, metre,
        "line of points [x, elevation] along which soil may slip: strength is divided in a band on it, elsewhere soil "
        "keeps its strength; in 3D across its whole width");
    v.number("width", width, metre, Range{0, 1e5}, "width of the band on the line `along`; 0: two cells");
    v.integer("mechanisms", mechanisms, Range{1, 10},
              "number of mechanisms that are searched for: the one with the least factor, then those with the next "
              "larger factors that move other soil");
  }
};

/// A point whose history is written.
struct OutputPoint {
  std::string name;  ///< the table's own name, [output.point.NAME]
  std::vector<double> position;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("position", position, metre,
            "position at the start, in the soil or at its surface; the nearest particle is tracked, stages by finite "
            "elements show the place itself; [x, y] in a 3D body from a section is in the middle of its thickness");
  }
};

/// A line that is followed with the soil.
struct OutputLine {
  std::string name;  ///< the table's own name, [output.line.NAME]
  std::vector<std::vector<double>> points;
  double spacing = 0;  ///< [m]; 0: 40 places
  template <class Visitor>
  void fields(Visitor &&v) {
    v.points("points", points, metre,
             "the line at the start, through these points: an inclinometer, a slip surface; particles along it are "
             "followed, stages by finite elements show the places themselves");
    v.number("spacing", spacing, metre, Range{0, 1e5}, "distance of the places along the line; 0: 40 places");
  }
};

struct Output {
  double interval = 0;             ///< time between snapshots [s]; 0: start and end of stages only
  double history_interval = 0;     ///< [s]; 0: every 200th of the longest stage
  double checkpoint_interval = 0;  ///< [s]; 0: with every snapshot
  std::vector<OutputPoint> point;
  std::vector<OutputLine> line;
  std::vector<std::string>
      picture;  ///< empty: displacement, plastic strain, velocity and pore pressure, as far as there are
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("interval", interval, second, Range{0, 1e9},
             "time between snapshots; 0: only at the start and end of stages");
    v.number("history_interval", history_interval, second, Range{0, 1e9},
             "time between lines of history.csv; 0: a 200th of the longest stage");
    v.number("checkpoint_interval", checkpoint_interval, second, Range{0, 1e9},
             "time between checkpoints, from which --resume continues; 0: one with every snapshot; results do not "
             "depend on them");
    v.named("point", point, "points whose history is written, [output.point.NAME]");
    v.named("line", line,
            "lines that are followed with the soil, [output.line.NAME]; line_NAME.csv has their places at the times of "
            "history.csv");
    v.texts("picture", picture,
            "fields that are drawn: a vector by its magnitude, a tensor by its mean, or one component such as "
            "stress_xy; default: those of displacement, plastic_strain, velocity, pore_pressure, suction, saturation, "
            "surface and mobilised_friction that exist, and state where soil has softened; in 3D also thickness, the "
            "volume of sliding soil per area");
  }
};

/// The run at whose state this one starts.
struct StartFrom {
  std::string folder;               ///< of its results; empty: the run starts at the initial state of the scene
  bool reset_displacement = false;  ///< displacements, velocities and plastic strain are zeroed first
  template <class Visitor>
  void fields(Visitor &&v) {
    v.path("folder", folder,
           "results of another run of the same mesh, bodies and phases, relative to the scene: this run starts at the "
           "state of its last checkpoint, which is its end if it has ended, at time 0 and with stages of its own");
    v.flag("reset_displacement", reset_displacement,
           "set displacement, velocity and plastic strain to zero at the start, as reset_displacement of a stage does "
           "at its end");
  }
};

struct Scene {
  std::string title;
  std::string file;                         ///< path of the scene, for messages and relative paths; not a key
  std::string source;                       ///< the text as read, overrides applied; not a key
  std::shared_ptr<const TableReader> root;  ///< the file's root table, for complaints after reading; not a key
  PhaseModel phases = PhaseModel::dry;
  int dimension = 2;
  Up up = Up::y;
  std::vector<double> gravity;  ///< components [m/s2]; one number points down; empty: no gravity
  StartFrom start_from;
  MeshSource mesh;
  std::vector<BodySource> body;
  std::vector<BoundarySource> boundary;
  Water water;
  Gas gas;
  std::vector<Stage> stage;
  std::vector<EarthquakeSource> earthquake;  ///< components of the motion of the ground
  DeferredTable integrator;  ///< [integrator], read by solvers/
  Transfer transfer;
  QuasiStaticSource quasi_static;
  FactorSource factor_of_safety;
  Output output;
  std::vector<std::string> acknowledge;  ///< names of doubts that are meant
  template <class Visitor>
  void fields(Visitor &&v) {
    v.text("title", title, "one line that says what the scene shows");
    v.choice("phases", phases,
             {{"dry", PhaseModel::dry},
              {"drained", PhaseModel::drained},
              {"saturated", PhaseModel::saturated},
              {"unsaturated", PhaseModel::unsaturated},
              {"three-phase", PhaseModel::three_phase}},
             "phase model");
    v.integer("dimension", dimension, Range{2, 3}, "2: plane strain on triangles, 3: tetrahedra");
    v.point("gravity", gravity, metre_per_second_squared, Usual{9.7, 10},
            "acceleration of gravity, one component per dimension; a single number acts downwards, against `up`");
    v.choice("up", up, {{"y", Up::y}, {"z", Up::z}},
             "axis along which elevations are counted, of water tables, levels and vertical stress; z (as in terrain) "
             "needs dimension = 3");
    v.table("start_from", start_from, "start at the state of another run");
    v.table("mesh", mesh, "background mesh");
    v.named("body", body, "soils, [body.NAME]");
    v.named("boundary", boundary, "conditions on named groups of facets, [boundary.NAME]");
    v.table("water", water, "pore water");
    v.table("gas", gas, "pore gas");
    v.list("stage", stage, "stages in their order, [[stage]]");
    v.list("earthquake", earthquake, "components of the motion of the ground in an earthquake, [[earthquake]]");
    v.deferred_table("integrator", integrator, "time integration");
    v.table("transfer", transfer, "exchange between particles and nodes");
    v.table("quasi_static", quasi_static, "finite elements of quasi-static stages");
    v.table("factor_of_safety", factor_of_safety, "search for the factor of safety");
    v.table("output", output, "results that are written");
    v.texts("acknowledge", acknowledge,
            "doubts that are meant and not to be said: the names in brackets at the end of warnings, such as "
            "[\"damping\"]");
  }

  /// Does the scene acknowledge doubts of this name?
  bool acknowledges(std::string_view doubt) const { return std::ranges::count(acknowledge, doubt) > 0; }
  double gravity_size() const;  ///< magnitude of gravity [m/s2]
  /// Number of the component of a place that is its elevation: the one place that says which way is up.
  int vertical() const { return static_cast<int>(up); }
  /// Unit vector against gravity, without gravity along `up`; zero beyond the dimension.
  std::array<double, 3> upward() const;
  /// The first value of a function that its key does not admit, on this rank; empty if there was none.
  std::string function_fault() const;
  /// Takes faults for never made: those of a trial beyond the end of the run.
  void forget_function_faults() const;
  /// Gravity and the pseudo-static acceleration of a stage, zero beyond the dimension [m/s2].
  std::array<double, 3> acceleration_in(const Stage &one) const;

  /// For what only mesh or soil can tell is wrong: throws the SceneError of TableReader::complain, with the key's place
  /// in the file.
  [[noreturn]] void complain(const std::string &key_path, const std::string &sentence) const;
};

}  // namespace talus
