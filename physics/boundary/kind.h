#pragma once
/// What a boundary kind states about itself. A kind is a struct with a `name`, its parameters in `fields`, and four
/// statements, none of which may be left out:
///
///     static constexpr OnSoil in_motion = ...;     // what it does to the skeleton in dynamic stages
///     static constexpr OnSoil quasi_static = ...;  // the same in quasi-static stages
///     static constexpr OnWater water = ...;        // what it does to the pore liquid
///     static constexpr OnGas gas = ...;            // what it does to the pore gas
///
/// Each value of a statement asks for the members that are named beside it below. All code that applies boundaries
/// (Conditions, PoreConditions, SurfaceLoads, and the finite elements of solvers/quasi_static) reads these statements
/// and never asks for a kind by its name. A missing statement, a missing member, and a member that no statement asks
/// for do not compile.
#include <array>
#include <concepts>
#include <vector>

#include "base/vec.h"
#include "physics/boundary/shear_zone.h"

namespace talus {

/// What a boundary does to the soil's skeleton.
enum class OnSoil {
  none,     ///< nothing
  support,  ///< prescribes the velocity in some directions: `precedence`, `directions`, and `speed` where they move
  contact,  ///< is a rigid base, which soil does not enter and which rubs: `friction_coefficient`, `adhesion`, and
            ///< `shear_zone` where rubbing heats it
  load,     ///< exerts a force per area: `load`, `follows`
  tied,     ///< consists of two opposite sides that move alike; a support may stand in for them
  dashpot,  ///< exerts a force per area against the velocity: `dashpot`; a support may stand in for it
  refused   ///< cannot act in such stages, and a scene that has one is refused
};

/// What a boundary does to the liquid in the pores.
enum class OnWater {
  surface,   ///< none of its own: the face is part of the soil's surface (atmosphere, or the kind on `free_surface`)
  wall,      ///< no liquid passes
  pressure,  ///< the liquid beyond has the pressure `outside` and moves in and out freely: `open_water`
  seepage,   ///< the same, but where `outside` is not above zero no more than `supply` enters: `open_water`
  flux,      ///< the volume `inflow` enters per area and time
  outflow    ///< liquid may leave and does not enter
};

/// What a boundary does to the gas in the pores.
enum class OnGas {
  surface,     ///< none of its own: the face is part of the soil's surface
  wall,        ///< no gas passes
  atmosphere,  ///< gas moves in and out freely, beyond the face is the atmosphere
  pressure     ///< gas moves in and out freely, beyond the face it has the pressure `gas_outside`
};

/// The liquid beyond a place on a face.
struct LiquidBeyond {
  double unit_weight = 0;  ///< [N/m3]
  double elevation = 0;    ///< of the place [m]
};

/// The members of a kind that its statements ask for.
namespace member {

/// `directions<dim>(n)`: unit vectors along which a facet of outer normal n prescribes the velocity.
template <class Kind>
concept directions = requires(const Kind &kind) {
  kind.template directions<2>(Vec<2>{}).begin();
};
/// `precedence`: where supports meet at a node, those with the smallest number count first, and the others only in what
/// they add: 0 for plates that move, 1 for nodes that are fixed, 2 for rollers.
template <class Kind>
concept precedence = requires {
  { Kind::precedence } -> std::convertible_to<int>;
};
/// `speed<dim>(direction, x, t)`: prescribed velocity along one of the directions [m/s]; without it they stand still.
template <class Kind>
concept speed = requires(const Kind &kind) {
  { kind.template speed<2>(Vec<2>{}, Vec<2>{}, 0.) } -> std::same_as<double>;
};
/// `load<dim>(n, x, t)`: force per area on a face of outer normal n at x [Pa].
template <class Kind>
concept load = requires(const Kind &kind) {
  { kind.template load<2>(Vec<2>{}, Vec<2>{}, 0.) } -> std::same_as<Vec<2>>;
};
/// `follows()`: is the load one per area of the face as it is now, where it is now (true), or per undeformed area at
/// the undeformed place (false)?
template <class Kind>
concept follows = requires(const Kind &kind) {
  { kind.follows() } -> std::same_as<bool>;
};
/// `friction_coefficient(x, y, z, t, slip)`: largest shear stress over effective normal stress on the base at a place
/// that has slipped by `slip` [m].
template <class Kind>
concept friction_coefficient = requires(const Kind &kind) {
  { kind.friction_coefficient(0., 0., 0., 0., 0.) } -> std::same_as<double>;
};
/// `adhesion(x, y, z, t, slip)`: shear stress that the base bears without normal stress [Pa].
template <class Kind>
concept adhesion = requires(const Kind &kind) {
  { kind.adhesion(0., 0., 0., 0., 0.) } -> std::same_as<double>;
};
/// `depends_on_slip()`: do friction or adhesion change with slip? Without it they do not.
template <class Kind>
concept depends_on_slip = requires(const Kind &kind) {
  { kind.depends_on_slip() } -> std::same_as<bool>;
};
/// `shear_zone()`: the zone that friction heats, whose excess pore pressure lowers friction; without it the base stays
/// cold.
template <class Kind>
concept shear_zone = requires(const Kind &kind) {
  { kind.shear_zone() } -> std::convertible_to<const ShearZone &>;
};
/// `dashpot<dim>({rho c_p, rho c_s}, n)`: force per area and velocity, a symmetric matrix, in soil of these impedances
/// behind a facet of normal n [kg/(m2 s)].
template <class Kind>
concept dashpot = requires(const Kind &kind) {
  { kind.template dashpot<2>(std::array<double, 2>{}, Vec<2>{}) } -> std::same_as<Square<2>>;
};
/// `incoming_wave`: does the other end of the dashpot move as the ground in an earthquake? Without it it does not.
template <class Kind>
concept incoming_wave = requires(const Kind &kind) {
  { kind.incoming_wave } -> std::convertible_to<bool>;
};
/// `has_column`: is the other end of the dashpot free ground, of which a column is computed beside the mesh? Without it
/// it is not.
template <class Kind>
concept has_column = requires(const Kind &kind) {
  { kind.has_column } -> std::convertible_to<bool>;
};
/// `outside(x, y, z, t, LiquidBeyond)`: pressure of the liquid beyond the face [Pa].
template <class Kind>
concept outside = requires(const Kind &kind) {
  { kind.outside(0., 0., 0., 0., LiquidBeyond{}) } -> std::same_as<double>;
};
/// `open_water`: the liquid beyond is water that rests on the face with its weight, so that its pressure grows with
/// depth and loads the skeleton.
template <class Kind>
concept open_water = requires {
  { Kind::open_water } -> std::convertible_to<bool>;
};
/// `supply(x, y, z, t, upward)`: volume of liquid that may enter per area and time [m/s] by a face whose outer normal
/// has the component `upward` against gravity [-].
template <class Kind>
concept supply = requires(const Kind &kind) {
  { kind.supply(0., 0., 0., 0., 1.) } -> std::same_as<double>;
};
/// `inflow(x, y, z, t)`: volume of liquid that enters per area and time [m/s].
template <class Kind>
concept inflow = requires(const Kind &kind) {
  { kind.inflow(0., 0., 0., 0.) } -> std::same_as<double>;
};
/// `gas_outside(x, y, z, t)`: gauge pressure of the gas beyond the face [Pa].
template <class Kind>
concept gas_outside = requires(const Kind &kind) {
  { kind.gas_outside(0., 0., 0., 0.) } -> std::same_as<double>;
};

}  // namespace member

template <class Kind>
concept StatesSoil = requires {
  { Kind::in_motion } -> std::convertible_to<OnSoil>;
  { Kind::quasi_static } -> std::convertible_to<OnSoil>;
};
template <class Kind>
concept StatesWater = requires {
  { Kind::water } -> std::convertible_to<OnWater>;
};
template <class Kind>
concept StatesGas = requires {
  { Kind::gas } -> std::convertible_to<OnGas>;
};

/// Can the program act on the skeleton as the kind states? Dashpots and ties act in motion only, and a contact acts in
/// motion if it acts at all. A support acts in all stages, or stands in for a dashpot or a tie.
template <StatesSoil Kind>
constexpr bool possible_on_soil() {
  constexpr OnSoil moving = Kind::in_motion, still = Kind::quasi_static;
  const bool stands_in = still == OnSoil::support && moving != OnSoil::support;
  return moving != OnSoil::refused && (still != OnSoil::contact || moving == OnSoil::contact) &&
         still != OnSoil::dashpot && still != OnSoil::tied &&
         (!stands_in || moving == OnSoil::dashpot || moving == OnSoil::tied);
}
/// Does the kind have the members that its statements about the skeleton ask for, and no others?
template <StatesSoil Kind>
constexpr bool complete_on_soil() {
  constexpr auto acts = [](OnSoil action) { return Kind::in_motion == action || Kind::quasi_static == action; };
  constexpr auto has_all = [](bool asked, auto... present) { return ((present == asked) && ...); };
  const bool moves = member::speed<Kind>, remembers = member::depends_on_slip<Kind> || member::shear_zone<Kind>;
  return has_all(acts(OnSoil::support), member::directions<Kind>, member::precedence<Kind>) &&
         (!moves || acts(OnSoil::support)) && (!remembers || acts(OnSoil::contact)) &&
         has_all(acts(OnSoil::contact), member::friction_coefficient<Kind>, member::adhesion<Kind>) &&
         has_all(acts(OnSoil::load), member::load<Kind>, member::follows<Kind>) &&
         has_all(acts(OnSoil::dashpot), member::dashpot<Kind>);
}
/// Can the program act on the fluids as the kind states? A wall stops both fluids, and the surface of the soil acts on
/// both. (A face that stops the liquid alone has an inflow of zero.)
template <class Kind>
requires StatesWater<Kind> && StatesGas<Kind>
constexpr bool possible_on_fluids() {
  constexpr bool wall[] = {Kind::water == OnWater::wall, Kind::gas == OnGas::wall};
  constexpr bool surface[] = {Kind::water == OnWater::surface, Kind::gas == OnGas::surface};
  return wall[0] == wall[1] && surface[0] == surface[1];
}
/// Does the kind have the members that its statements about the fluids ask for, and no others?
template <class Kind>
requires StatesWater<Kind> && StatesGas<Kind>
constexpr bool complete_on_fluids() {
  constexpr OnWater water = Kind::water;
  constexpr auto has_all = [](bool asked, auto... present) { return ((present == asked) && ...); };
  const bool pressure = water == OnWater::pressure || water == OnWater::seepage;
  return has_all(pressure, member::outside<Kind>, member::open_water<Kind>) &&
         has_all(water == OnWater::seepage, member::supply<Kind>) &&
         has_all(water == OnWater::flux, member::inflow<Kind>) &&
         has_all(Kind::gas == OnGas::pressure, member::gas_outside<Kind>);
}

template <class Kind>
concept PossibleOnSoil = possible_on_soil<Kind>();
template <class Kind>
concept CompleteOnSoil = complete_on_soil<Kind>();
template <class Kind>
concept PossibleOnFluids = possible_on_fluids<Kind>();
template <class Kind>
concept CompleteOnFluids = complete_on_fluids<Kind>();
template <class Kind>
concept BoundaryKind = PossibleOnSoil<Kind> && CompleteOnSoil<Kind> && PossibleOnFluids<Kind> && CompleteOnFluids<Kind>;

/// Absorbs waves that arrive along the normal n (Lysmer & Kuhlemeyer 1969): rho c_p n n + rho c_s (1 - n n), from the
/// impedances {rho c_p, rho c_s}.
template <int dim>
Square<dim> absorbing(const std::array<double, 2> &impedance, const Vec<dim> &n) {
  Square<dim> matrix;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j)
      matrix(i, j) = (impedance[0] - impedance[1]) * n[i] * n[j] + (i == j ? impedance[1] : 0);
  return matrix;
}

/// The unit vectors of all axes, for kinds that prescribe the whole velocity.
template <int dim>
std::vector<Vec<dim>> all_axes() {
  std::vector<Vec<dim>> axes(dim, Vec<dim>{});
  for (int d = 0; d < dim; ++d) axes[d][d] = 1;
  return axes;
}

}  // namespace talus
