#pragma once
/// A boundary of a scene, whatever its kind: the statements of the kind (kind.h) and the functions that they ask for.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/units.h"
#include "physics/boundary/kind.h"
#include "scene/deferred.h"
#include "scene/function.h"

namespace talus {

/// The functions of a boundary that act on the skeleton, as in kind.h; empty where the kind has none.
template <int dim>
struct SoilFunctions {
  std::function<std::vector<Vec<dim>>(const Vec<dim> &normal)> directions;
  std::function<double(const Vec<dim> &direction, const Vec<dim> &x, double t)> speed;
  std::function<Vec<dim>(const Vec<dim> &normal, const Vec<dim> &x, double t)> load;
  std::function<Square<dim>(const std::array<double, 2> &impedance, const Vec<dim> &normal)> dashpot;
};

class Boundary {
 public:
  template <class Kind>
  requires(!std::same_as<Kind, Boundary>) Boundary(Kind kind);  // NOLINT: every kind is a boundary

  OnSoil in_motion, quasi_static;
  OnWater water;
  OnGas gas;
  int precedence = 2;             ///< of a support
  bool follows = false;           ///< of a load
  bool open_water = false;        ///< of a pressure or seepage
  bool incoming_wave = false;     ///< of a dashpot: its other end moves as the ground in an earthquake
  bool has_column = false;        ///< of a dashpot: its other end is free ground, computed beside the mesh
  bool remembers = false;         ///< of a contact: what it bears depends on how far soil has slipped on it
  std::vector<TimeSpan> changes;  ///< when the functions that the scene gives change with time
  /// Keys and numbers of components of the vectors that the scene gives as functions; each must have one per dimension.
  std::vector<std::pair<std::string, int>> vectors;

  template <int dim>
  const SoilFunctions<dim> &on_soil() const {
    if constexpr (dim == 2)
      return on_soil_2d_;
    else
      return on_soil_3d_;
  }
  std::function<double(double x, double y, double z, double t, const LiquidBeyond &)> outside;
  std::function<double(double x, double y, double z, double t)> inflow, gas_outside;
  std::function<double(double x, double y, double z, double t, double upward)> supply;
  std::function<double(double x, double y, double z, double t, double slip)> friction_coefficient, adhesion;
  std::optional<ShearZone> shear_zone;  ///< of a contact that rubbing heats

  /// Does it concern the pore fluids only?
  bool fluids_only() const { return in_motion == OnSoil::none && quasi_static == OnSoil::none; }
  /// Does liquid enter or leave by it, so that its inflow is recorded?
  bool has_inflow() const { return fluids_only() || fluid_face(); }
  /// Does it need a gas that moves?
  bool needs_gas() const { return gas == OnGas::pressure; }
  /// Does it support the skeleton only in quasi-static stages and those that freeze loads, in place of what it does in
  /// motion?
  bool stands_in() const { return quasi_static == OnSoil::support && in_motion != OnSoil::support; }
  /// Does soil stay inside the mesh here? Where facets are rough, a particle would else leave between their nodes.
  bool keeps_soil_inside() const {
    return in_motion == OnSoil::tied || has_column || in_motion == OnSoil::contact ||
           (in_motion == OnSoil::support && !on_soil<2>().speed);
  }
  /// Do the pore fluids have a face of its own here, neither a wall nor the surface of the soil?
  bool fluid_face() const { return water != OnWater::wall && water != OnWater::surface; }
  /// Does it say what happens to the liquid, and not only of itself, as supports do, that none passes?
  bool decides_on_liquid() const { return fluid_face() || (water == OnWater::wall && fluids_only()); }

 private:
  struct FindFunctions;
  template <int dim, class Kind>
  static SoilFunctions<dim> functions_of(const std::shared_ptr<const Kind> &kind);

  SoilFunctions<2> on_soil_2d_;
  SoilFunctions<3> on_soil_3d_;
};

/// A boundary of a scene, with the groups of facets that it holds on.
struct NamedBoundary {
  std::string name;
  std::vector<std::string> groups;
  Boundary kind;
  /// Those of the groups that are the faces of columns beside the mesh, as many as the others and in their order.
  std::vector<std::string> columns{};
};

/// Reads the kind that the table names, out of the list in kinds.h. Throws SceneError.
Boundary read_boundary(const DeferredTable &table);

// ---- templates ----

/// Visits the fields of a kind for its functions: which are vectors, and when do they change with time?
struct Boundary::FindFunctions {
  std::vector<std::pair<std::string, int>> &vectors;
  std::vector<TimeSpan> &changes;
  void add(const Function &function) {
    const std::vector<TimeSpan> its = function.changes();
    changes.insert(changes.end(), its.begin(), its.end());
  }
  void functions(const char *key, const std::vector<Function> &value, Unit, const char *, const char *) {
    if (!value.empty()) vectors.emplace_back(key, static_cast<int>(value.size()));
    for (const Function &component : value) add(component);
  }
  void function(const char *, const Function &value, Unit, Range, const char *, const char *) { add(value); }
  void number(const char *, double &, Unit, Range, const char *) {}
  void flag(const char *, bool &, const char *) {}
  template <class Enum>
  void choice(const char *, Enum &, std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>>,
              const char *) {}
};

template <int dim, class Kind>
SoilFunctions<dim> Boundary::functions_of(const std::shared_ptr<const Kind> &kind) {
  SoilFunctions<dim> on_soil;
  if constexpr (member::directions<Kind>)
    on_soil.directions = [kind](const Vec<dim> &n) { return kind->template directions<dim>(n); };
  if constexpr (member::speed<Kind>)
    on_soil.speed = [kind](const Vec<dim> &direction, const Vec<dim> &x, double t) {
      return kind->template speed<dim>(direction, x, t);
    };
  if constexpr (member::load<Kind>)
    on_soil.load = [kind](const Vec<dim> &n, const Vec<dim> &x, double t) { return kind->template load<dim>(n, x, t); };
  if constexpr (member::dashpot<Kind>)
    on_soil.dashpot = [kind](const std::array<double, 2> &impedance, const Vec<dim> &n) {
      return kind->template dashpot<dim>(impedance, n);
    };
  return on_soil;
}

template <class Kind>
requires(!std::same_as<Kind, Boundary>) Boundary::Boundary(Kind of)
    : in_motion(Kind::in_motion), quasi_static(Kind::quasi_static), water(Kind::water), gas(Kind::gas) {
  static_assert(StatesSoil<Kind>, "a boundary kind states what it does to the skeleton: in_motion and quasi_static");
  static_assert(StatesWater<Kind>, "a boundary kind states what it does to the pore liquid: water");
  static_assert(StatesGas<Kind>, "a boundary kind states what it does to the pore gas: gas");
  static_assert(PossibleOnSoil<Kind>, "no stage can act on the skeleton as this kind states");
  static_assert(PossibleOnFluids<Kind>, "a wall, and the surface of the soil, act on liquid and gas alike");
  static_assert(CompleteOnSoil<Kind>, "members are missing or never asked for: see OnSoil in kind.h");
  static_assert(CompleteOnFluids<Kind>, "members are missing or never asked for: see OnWater and OnGas in kind.h");
  of.fields(FindFunctions{vectors, changes});
  const auto kind = std::make_shared<const Kind>(std::move(of));
  on_soil_2d_ = functions_of<2>(kind), on_soil_3d_ = functions_of<3>(kind);
  if constexpr (member::precedence<Kind>) precedence = Kind::precedence;
  if constexpr (member::follows<Kind>) follows = kind->follows();
  if constexpr (member::incoming_wave<Kind>) incoming_wave = kind->incoming_wave;
  if constexpr (member::has_column<Kind>) has_column = kind->has_column;
  if constexpr (member::open_water<Kind>) open_water = Kind::open_water;
  if constexpr (member::friction_coefficient<Kind>)
    friction_coefficient = [kind](double x, double y, double z, double t, double slip) {
      return kind->friction_coefficient(x, y, z, t, slip);
    };
  if constexpr (member::adhesion<Kind>)
    adhesion = [kind](double x, double y, double z, double t, double slip) { return kind->adhesion(x, y, z, t, slip); };
  if constexpr (member::depends_on_slip<Kind>) remembers = kind->depends_on_slip();
  if constexpr (member::shear_zone<Kind>) shear_zone = kind->shear_zone(), remembers = true;
  if constexpr (member::outside<Kind>)
    outside = [kind](double x, double y, double z, double t, const LiquidBeyond &liquid) {
      return kind->outside(x, y, z, t, liquid);
    };
  if constexpr (member::supply<Kind>)
    supply = [kind](double x, double y, double z, double t, double upward) { return kind->supply(x, y, z, t, upward); };
  if constexpr (member::inflow<Kind>)
    inflow = [kind](double x, double y, double z, double t) { return kind->inflow(x, y, z, t); };
  if constexpr (member::gas_outside<Kind>)
    gas_outside = [kind](double x, double y, double z, double t) { return kind->gas_outside(x, y, z, t); };
}

}  // namespace talus
