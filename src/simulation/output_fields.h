#pragma once
/// The list of what results hold: fields of particles and Gauss points, and columns of history.csv. Whoever adds one
/// adds an entry here, behind a condition where a phase model or a kind of point does not have it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/phases.h"
#include "output/output_field.h"
#include "particles/escaped_particles.h"
#include "physics/any_soil_motion.h"
#include "physics/boundary/rigid_bodies.h"
#include "physics/boundary/soil_contact.h"
#include "physics/laws/present_strength.h"
#include "physics/laws/strength_by_place.h"
#include "physics/structures/structures.h"
#include "simulation/energy_sums.h"

namespace talus {

/// A particle as results show it, also within the Lagrangian part of a step.
template <int dim>
struct ParticleState {
  static constexpr int dimension = dim;
  static constexpr const char *noun = "particle";
  int body = 0;
  Vec<dim> position{}, displacement{}, velocity{};          ///< [m], [m], [m/s]
  std::array<double, stress_size<dim>> stress{};            ///< [Pa]
  double volume = 0, mass = 0;                              ///< [m3], [kg]
  double pore_pressure = 0, gas_pressure = 0, suction = 0;  ///< [Pa]
  double saturation = 0, porosity = 0;
  bool surface = false;         ///< fluids may pass through a side of its cell
  SofteningInput softened_by;   ///< what its law takes for softening
  StrengthShares strength;      ///< of the body's law
  std::vector<double> history;  ///< internal variables of the body's law

  ParticleState() = default;
  /// Particle `i` of `source`, the body number `b`.
  ParticleState(const PhaseTraits &phases, const AnySoilMotion<dim> &motion, const Body<dim> &source, int b, int i)
      : body(b), history(source.history_count()) {
    const ParticleArrays<dim> &p = source.particles();
    motion.present(source, i, &position, &velocity);
    velocity = motion.moving_velocity(source, i);
    motion.state(b, i, stress.data(), history.data(), &volume);
    for (int d = 0; d < dim; ++d) displacement[d] = position[d] - p.reference[i][d];
    mass = p.mass[i];
    softened_by = motion.softened_by(b, i);
    if (p.cohesion_share) strength = {p.cohesion_share[i], p.friction_share[i]};
    if (phases.prescribed) pore_pressure = motion.pore_pressure(p.cell[i], position);
    if (phases.liquid) {
      const PoreReport pores = motion.pores(source, i);
      pore_pressure = pores.liquid, gas_pressure = pores.gas, suction = pores.suction, saturation = pores.saturation;
      surface = pores.surface;
      porosity = 1 - mass / (source.grain_density() * volume);
    }
    pore_pressure += make_effective(source.law(), stress.data(), history.data());
  }
};

/// A Gauss point of a quasi-static stage as results show it.
template <int dim>
struct GaussPointState {
  static constexpr int dimension = dim;
  static constexpr const char *noun = "Gauss point";
  int body = 0;
  Vec<dim> position{}, displacement{};            ///< [m]
  std::array<double, stress_size<dim>> stress{};  ///< [Pa]
  double volume = 0, mass = 0;                    ///< [m3], [kg]
  double shear_strain = 0;
  double pore_pressure = 0, suction = 0;  ///< [Pa]
  double saturation = 0;                  ///< [-]
  SofteningInput softened_by;             ///< what its law takes for softening
  StrengthShares strength;                ///< of the body's law
  const double *history = nullptr;        ///< internal variables of the body's law
};

template <class Point>
Invariants<Point::dimension> invariants_of(const Point &p) {
  Stress<Point::dimension> stress;
  std::memcpy(&stress, p.stress.data(), sizeof stress);
  return Invariants<Point::dimension>(stress);
}

/// Adds what follows from the stress of frictional soil; nothing where no soil is frictional.
template <class Point>
void add_mobilised_strength(OutputFields<Point> &fields,
                            const std::vector<std::unique_ptr<Body<Point::dimension>>> &bodies) {
  auto soils = std::make_shared<std::vector<PresentStrength>>();
  for (const auto &body : bodies) soils->emplace_back(body->law());
  if (std::ranges::none_of(*soils, [](const PresentStrength &soil) { return soil.known(); })) return;
  const auto mobilised = [soils](const Point &p) -> std::array<double, 2> {
    const PresentStrength &soil = (*soils)[p.body];
    if (!soil.known()) return {std::nan(""), std::nan("")};
    Stress<Point::dimension> stress;
    std::memcpy(&stress, p.stress.data(), sizeof stress);
    const Surroundings around{.size = p.softened_by.size,
                              .suction = p.suction,
                              .cohesion = p.strength.cohesion,
                              .friction = p.strength.friction};
    const Mobilised found = soil(stress, p.softened_by.plastic_strain, around);
    return {found.friction_angle / degree.si, static_cast<double>(found.state)};
  };
  fields.add("mobilised_friction", "deg",
             "friction angle that the stress mobilises with the present cohesion c and friction angle phi: sin = (s1 - "
             "s3) / (2 c cot(phi) - s1 - s3)",
             Tracked::value, [mobilised](const Point &p) { return mobilised(p)[0]; });
  fields.add("state", "-", "strength of the point: 0 elastic, 1 peak, 2 softening, 3 residual", Tracked::value,
             [mobilised](const Point &p) { return mobilised(p)[1]; });
}

/// The fields of particles (`Point` is a ParticleState) or Gauss points (GaussPointState).
template <class Point>
OutputFields<Point> output_fields(const PhaseTraits &phases,
                                  const std::vector<std::unique_ptr<Body<Point::dimension>>> &bodies) {
  constexpr bool particles = requires(Point p) { p.velocity; };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string of_point = std::string(" of the ") + Point::noun;
  OutputFields<Point> fields;
  fields.add("position", "m", "place" + of_point, Tracked::coordinates, [](const Point &p) { return p.position; });
  fields.add("displacement", "m", "displacement since the start or the last reset", Tracked::vector,
             [](const Point &p) { return p.displacement; });
  if constexpr (particles)
    fields.add("velocity", "m/s", "velocity of the soil skeleton", Tracked::magnitude,
               [](const Point &p) { return p.velocity; });
  fields.add("stress", "Pa", phases.pressure ? "effective stress, positive in tension" : "stress, positive in tension",
             Tracked::components, [](const Point &p) { return p.stress; });
  fields.add("mean_pressure", "Pa",
             phases.pressure ? "p', mean effective stress, positive in compression"
                             : "p, mean stress, positive in compression",
             Tracked::value, [](const Point &p) { return -invariants_of(p).p; });
  fields.add("deviator", "Pa", "q = sqrt(3/2 s : s) of the deviator s of stress", Tracked::value,
             [](const Point &p) { return std::sqrt(3.) * invariants_of(p).q; });
  fields.add("volume", "m3", "volume" + of_point, Tracked::no, [](const Point &p) { return p.volume; });
  fields.add("mass", "kg", "mass" + of_point, Tracked::no, [](const Point &p) { return p.mass; });
  if constexpr (!particles)
    fields.add("shear_strain", "-", "sqrt(2/3 e : e) of the deviator e of strain, since displacement was last reset",
               Tracked::no, [](const Point &p) { return p.shear_strain; });
  if (phases.pressure)
    fields.add("pore_pressure", "Pa", "pore pressure, positive in compression", Tracked::value,
               [](const Point &p) { return p.pore_pressure; });
  if constexpr (particles) {
    if (phases.gas)
      fields.add("gas_pressure", "Pa", "gauge pressure of the pore gas", Tracked::value,
                 [](const Point &p) { return p.gas_pressure; });
    if (phases.suction)
      fields.add("suction", "Pa", "gas less liquid pressure, where positive", Tracked::value,
                 [](const Point &p) { return p.suction; });
  }
  if (phases.suction)
    fields.add("saturation", "-", "degree of saturation", Tracked::value, [](const Point &p) { return p.saturation; });
  if constexpr (particles)
    if (phases.liquid) {
      fields.add("porosity", "-", "porosity", Tracked::no, [](const Point &p) { return p.porosity; });
      fields.add("surface", "-",
                 "1 in cells with a side through which fluids may pass, named or the soil's surface where it is now; 0 "
                 "elsewhere",
                 Tracked::no, [](const Point &p) { return p.surface; });
    }
  if (std::ranges::any_of(bodies, [](const auto &body) { return reads_shares(body->law()); })) {
    std::vector<StrengthRange> of_body;
    for (const auto &body : bodies)
      of_body.push_back(no_strength_reduction(body->law())[0] ? StrengthRange{{nan, nan}, {nan, nan}}
                                                              : strength_of(body->law()));
    fields.add("cohesion", "Pa", "cohesion of the place, at its peak if the soil softens", Tracked::no,
               [of_body](const Point &p) { return of_body[p.body].cohesion[1] * p.strength.cohesion; });
    fields.add(
        "friction_angle", "deg", "friction angle of the place, at its peak if the soil softens", Tracked::no,
        [of_body](const Point &p) { return of_body[p.body].friction_angle[1] / degree.si * p.strength.friction; });
  }
  add_mobilised_strength(fields, bodies);
  if (particles && std::ranges::any_of(bodies, [](const auto &b) { return b->averaging_length() > 0; }))
    fields.add("averaged_plastic_strain", "-",
               "plastic strain by which the soil softens: that of the cell, averaged over averaging_length where its "
               "body has one",
               Tracked::no, [](const Point &p) { return p.softened_by.plastic_strain; });
  // The internal variables of the laws. A body whose law does not have a variable shows NaN there.
  for (const auto &body : bodies)
    for (const HistoryField &variable : history_fields(body->law())) {
      if (variable.of_tensor) continue;
      const std::string name = variable.name;
      if (std::ranges::any_of(fields.list(), [&](const auto &field) { return field.name == name; })) continue;
      std::vector<int> index(bodies.size(), -1);  // of the variable in each body's history
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto own = history_fields(bodies[b]->law());
        for (std::size_t k = 0; k < own.size(); ++k)
          if (own[k].name == name) index[b] = static_cast<int>(k);
      }
      fields.add(name, variable.unit.name, variable.meaning, name == "plastic_strain" ? Tracked::value : Tracked::no,
                 [index](const Point &p) { return index[p.body] < 0 ? nan : p.history[index[p.body]]; });
    }
  return fields;
}

/// A boundary in history.csv.
template <int dim>
struct BoundaryRow {
  std::string name;
  bool loads = false;  ///< it loads the soil: the mean displacement of its faces is shown, otherwise the force by which
                       ///< it supports the soil
  bool of_water = false;                  ///< it is one of the water in the pores alone, and has neither
  bool inflow = false;                    ///< the water that enters through it is shown
  bool is_base = false;                   ///< its friction, and the clearance of the soil over it, are shown
  bool remembers = false, heats = false;  ///< a base: its slip is shown; and the heat of its shear zone
  Vec<dim> value{};                       ///< displacement [m] or force [N]
  double water = 0;                       ///< entering [m3/s]
  double clearance = 0;                   ///< of the soil over a base [m]
  typename RigidBases<dim>::Report base{};
};

/// A rigid body in history.csv, in its freedoms: components, then rotations.
template <int dim>
struct RigidRow {
  std::string name;
  typename RigidBodies<dim>::Report report{};
  double elapsed = 0;  ///< since the row before [s]
};

/// A contact between two groups in history.csv.
template <int dim>
struct ContactRow {
  std::string name;
  typename SoilContact<dim>::Report report{};
  double elapsed = 0;  ///< since the row before [s]
};

/// A structure in history.csv, in the forces of one bar.
template <int dim>
struct StructureRow {
  std::string name;
  typename Bar<dim>::Report report{};
};

/// Motion of the ground: of the base or, where a wave comes in, of the outcrop that [[earthquake]] states [m/s2],
/// [m/s], [m].
struct GroundRow {
  std::array<double, 3> acceleration{}, velocity{}, displacement{};
};

/// The whole run in a row of history.csv: sums over all ranks.
template <int dim>
struct RunRow {
  EnergySums energy;
  double potential = 0;             ///< energy in gravity [J]
  double mass = 0;                  ///< of the particles [kg]
  double particles = 0;             ///< their number
  double load_time = 0;             ///< time that functions of the scene see [s]
  std::optional<GroundRow> ground;  ///< where some stage shakes
  bool balanced = true;             ///< energy has a balance: not that of a mechanism, whose size is free
  EscapedSums escaped;              ///< what left the mesh and was taken out
  std::vector<FluidLedger> fluids;  ///< that move on their own: water, then gas
  std::vector<double> first_fluid;  ///< their masses at the start, those that had left by then among them [kg]
  std::vector<double> handed;       ///< FluidBooks::handed; empty where no stage hands states over [kg]
  std::vector<BoundaryRow<dim>> boundaries;
  std::vector<RigidRow<dim>> rigid;
  std::vector<ContactRow<dim>> contacts;
  std::vector<StructureRow<dim>> structures;

  /// Calls column(HistoryColumn, value) for each column, in the order of the file.
  template <class Visitor>
  void visit(Visitor &&column) const {
    using std::string;
    const auto of_run = [&](const string &quantity, const string &unit, double value) {
      column(HistoryColumn{history_column(quantity, unit), quantity, unit, "run", ""}, value);
    };
    const auto part = [&](const string &name, const string &quantity, const string &which, const string &unit,
                          double value) {
      column(HistoryColumn{history_column(name, unit), quantity, unit, "run", which}, value);
    };
    const auto joules = [&](const string &which, double value) { part(which, "energy", which, "J", value); };
    const auto of = [&](const BoundaryRow<dim> &b, const string &quantity, const string &unit, double value) {
      column(column_of("boundary", b.name, quantity, unit), value);
    };
    joules("kinetic", energy.balance.kinetic);
    joules("strain", energy.balance.strain);
    joules("potential", potential);
    of_run("mass", "kg", mass);
    of_run("particles", "-", particles);
    of_run("load_time", "s", load_time);
    for (int d = 0; ground && d < dim; ++d) {
      const string axis(1, "xyz"[d]);
      part("ground_acceleration_" + axis, "ground_acceleration", axis, "m/s2", ground->acceleration[d]);
      part("ground_velocity_" + axis, "ground_velocity", axis, "m/s", ground->velocity[d]);
      part("ground_displacement_" + axis, "ground_displacement", axis, "m", ground->displacement[d]);
    }
    of_run("escaped_particles", "-", escaped.particles);
    of_run("escaped_mass", "kg", escaped.mass);
    for (int d = 0; d < dim; ++d) {
      const string axis(1, "xyz"[d]);
      part("escaped_momentum_" + axis, "escaped_momentum", axis, "kg m/s", escaped.momentum[d]);
    }
    joules("escaped_energy", escaped.energy);
    for (std::size_t a = 0; a < fluids.size(); ++a) {
      const string fluid = a ? "gas" : "water";
      const double first = a < first_fluid.size() ? first_fluid[a] : 0;
      const auto ledger = [&](const string &which, double value) {
        part(which == "stored" ? fluid : fluid + "_" + which, fluid + "_ledger", which, "kg", value);
      };
      ledger("stored", fluids[a].stored);
      ledger("out", fluids[a].out);
      ledger("given", fluids[a].prescribed);
      ledger("escaped", escaped.fluid_mass[a]);
      if (!handed.empty()) ledger("handed", handed[a]);
      ledger("error", owned(a) - first);
    }
    for (const auto &b : boundaries)
      if (b.inflow) of(b, "inflow", "m3/s", b.water);
    for (const auto &b : boundaries)
      for (int d = 0; d < dim && !b.of_water; ++d)
        of(b, string(b.loads ? "displacement_" : "force_") + "xyz"[d], b.loads ? "m" : "N", b.value[d]);
    for (const auto &b : boundaries) {
      if (b.remembers) of(b, "slip", "m", b.base.slip);
      if (b.is_base) of(b, "friction", "-", b.base.friction), of(b, "clearance", "m", b.clearance);
      if (!b.heats) continue;
      of(b, "temperature", "K", b.base.temperature);
      of(b, "hottest", "K", b.base.hottest);
      of(b, "excess_pressure", "Pa", b.base.pressure);
      joules(b.name + "_heat", b.base.heat);
    }
    for (const RigidRow<dim> &b : rigid) {
      const auto moves = [&](const string &quantity, const string &unit, double value) {
        column(column_of("rigid", b.name, quantity, unit), value);
      };
      const auto &[place, velocity, impulse] = b.report;
      for (int d = 0; d < dim; ++d) moves(string(1, "xyz"[d]), "m", place[d]);
      moves("rotation", "deg", place[dim] / degree.si);
      for (int d = 0; d < dim; ++d) moves(string("velocity_") + "xyz"[d], "m/s", velocity[d]);
      moves("spin", "deg/s", velocity[dim] / degree.si);
      const double per_time = b.elapsed > 0 ? 1 / b.elapsed : 0;
      for (int d = 0; d < dim; ++d) moves(string("force_") + "xyz"[d], "N", impulse[d] * per_time);
      moves("moment", "N m", impulse[dim] * per_time);
    }
    for (const ContactRow<dim> &c : contacts) {
      const auto shows = [&](const string &quantity, const string &unit, double value) {
        column(column_of("contact", c.name, quantity, unit), value);
      };
      for (int d = 0; d < dim; ++d)
        shows(string("force_") + "xyz"[d], "N", c.elapsed > 0 ? c.report.impulse[d] / c.elapsed : 0);
      shows("friction", "-", c.report.friction), shows("sliding", "m/s", c.report.sliding);
    }
    const auto behind_boundaries = [&](std::size_t k) {
      return boundaries.size() + k < energy.of_boundary.size() ? energy.of_boundary[boundaries.size() + k] : 0;
    };
    for (std::size_t k = 0; k < contacts.size(); ++k)
      joules("work_" + contacts[k].name, behind_boundaries(rigid.size() + k));
    for (const StructureRow<dim> &s : structures) {
      const auto of_structure = [&](const string &quantity, const string &unit, double value) {
        column(column_of("structure", s.name, quantity, unit), value);
      };
      of_structure("head_force", "N", s.report.head), of_structure("axial_force", "N", s.report.largest);
      of_structure("bond_slip", "m", s.report.slip), of_structure("slipping", "-", s.report.slipping);
      of_structure("utilisation", "-", s.report.utilisation);
    }
    for (std::size_t k = 0; k < rigid.size(); ++k) joules("work_" + rigid[k].name, behind_boundaries(k));
    for (std::size_t s = 0; s < boundaries.size(); ++s)
      if (!boundaries[s].of_water)
        joules("work_" + boundaries[s].name, s < energy.of_boundary.size() ? energy.of_boundary[s] : 0);
    joules("work_gravity", energy.work.gravity), joules("work_imposed", energy.work.imposed);
    joules("work_damping", energy.work.damping);
    joules("dissipated", balanced ? energy.dissipated() : std::numeric_limits<double>::quiet_NaN());
  }
  /// Mass of a fluid that the boundaries do not account for: it stays what it is [kg].
  double owned(std::size_t a) const {
    return fluids[a].stored + fluids[a].out - fluids[a].prescribed + escaped.fluid_mass[a] -
           (handed.empty() ? 0 : handed[a]);
  }
};

}  // namespace talus
