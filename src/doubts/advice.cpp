// What `check` advises: particles, cells, softening, stages, steps, water. Doubts are in doubts.h.
#include <algorithm>
#include <cmath>

#include "base/rounded.h"
#include "doubts/needs.h"
#include "doubts/scales.h"
#include "particles/body.h"
#include "physics/boundary/boundary.h"
#include "physics/pores/hyperbolicity.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/mesh_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/stress_at_rest.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"

namespace talus {
namespace {

std::string digits(double value, int count = 3) { return rounded(value, count); }

/// Does softening depend on the size of the cells?
bool unscaled(const Law &law) {
  return std::visit(
      [](const auto &one) {
        if constexpr (requires { one.softens(); }) return one.softens() && one.reference_size == 0;
        return false;
      },
      law);
}

/// Peak friction angle less dilation angle [rad]; 0 for soil without them.
double flow_off_normal(const Law &law) {
  return std::visit(
      [](const auto &one) {
        if constexpr (requires { one.friction_angle, one.dilation_angle; })
          return one.friction_angle - one.dilation_angle;
        return 0.;
      },
      law);
}

/// Share of its shear strength that soil bears on a slip surface, Davis (1968).
double davis_share(const Law &law) {
  return std::visit(
      [](const auto &one) {
        if constexpr (requires { one.friction_angle, one.dilation_angle; })
          return std::cos(one.friction_angle) * std::cos(one.dilation_angle) /
                 (1 - std::sin(one.friction_angle) * std::sin(one.dilation_angle));
        return 1.;
      },
      law);
}

constexpr const char *not_unique =
    "it differs from mesh to mesh by some per cent, in fine cells too; repeat with other sizes (`talus "
    "converge`), and compare with associated flow and the strength of Davis (1968)";

/// From here on loads at failure scatter from mesh to mesh [rad]: vaiont with 42 degrees does, and selborne's with 26
/// falls smoothly as cells get smaller.
constexpr double flow_far_off_normal = 30 * degree.si;

class Adviser {
 public:
  Adviser(const Scene &scene, const Needs &needs) : scene_(scene), needs_(needs) {}

  std::vector<std::string> all() {
    for (const BodyNeeds &b : needs_.bodies)
      if (std::holds_alternative<Umat>(b.law))
        say("body." + b.body.name +
            " runs the library of its UMAT, which can do whatever a program can; --no-umat refuses it.");
    if (!needs_.burst_failure.empty()) say("The run breaks off in its first steps: " + needs_.burst_failure + ".");
    for (const std::string &remark : needs_.mesh.remarks) say(remark);
    for (const BodyNeeds &b : needs_.bodies)
      if (b.there()) particles(b), locking(b), softening(b), flow(b), yielding_ground(b);
    if (!needs_.function_fault.empty())
      say(needs_.function_fault +
          ". A run ends where it needs such a value; the function was tried all over the soil and "
          "the stages.");
    if (!needs_.downhill_fault.empty())
      say(needs_.downhill_fault + ". That place lies downhill of the soil: the run ends if a slide comes so far.");
    for (const std::string &doubt : needs_.doubts) say(doubt);
    if (needs_.particles() == 0) {
      say("Stages add all soil, and none is there at the start: steps, times and scales are not known before a run. "
          "Without `add` in the stages check estimates them of the whole soil.");
      return std::move(advice_);
    }
    if (!scene_.root->has("gravity"))
      say("The scene gives no gravity, so that soil has no weight; gravity = 0 says that this is meant.");
    stiffness();
    start();
    for (std::size_t i = 0; i < scene_.stage.size(); ++i) stage(scene_.stage[i]);
    bases();
    step();
    transfer();
    dimension();
    water();
    suction();
    gas_without_drag();
    return std::move(advice_);
  }

 private:
  void say(const std::string &sentence) { advice_.push_back(sentence); }

  void particles(const BodyNeeds &b) {
    const int fewest = b.body.fewest_per_cell;
    const bool plane = scene_.dimension == 2;
    const std::string each = " particles per cell in " + b.body.name + " are few ";
    const auto moves = [](const Stage &stage) { return !is_static(stage.kind) && stage.pore_flow; };
    if (fluids_move(scene_.phases) && std::ranges::any_of(scene_.stage, moves) && fewest < (plane ? 6 : 8))
      say(std::to_string(fewest) + each +
          "if soil with pore fluids flows far: a column of saturated sand ran out a fifth "
          "less far with 3 per triangle than with 6 or 12; look with `talus converge --by particles`.");
    const int usual = plane ? particles_per_cell<2>(BodySource()) : particles_per_cell<3>(BodySource());
    if (fewest >= usual) return;
    const std::string wanted =
        "take " + std::to_string(usual) + " or more per " + (plane ? "triangle." : "tetrahedron.");
    say(fewest == 1 ? "One particle per cell in " + b.body.name + " is too few: the error of stress was " +
                          (plane ? "10 % at rest and 23 % in motion, compared with 1.2 % and 5 % with three; "
                                 : "13 to 18 %; ") +
                          wanted
                    : std::to_string(fewest) + each + "where cells lose particles; " + wanted);
  }

  void locking(const BodyNeeds &b) {
    const double K = bulk_modulus(b.law), G = shear_modulus(b.law), nu = (3 * K - 2 * G) / (2 * (3 * K + G));
    if (nu > 0.45 && scene_.transfer->locking == Locking::none)
      say("Poisson's ratio " + digits(nu) + " in " + b.body.name +
          " makes linear cells lock (the load of a footing was 45 % too high at 0.49) without transfer.locking.");
  }

  void softening(const BodyNeeds &b) {
    const double slope = b.softening.slope;
    if (slope == 0) return;
    constexpr double resolved =
        0.8;  // of the averaging length: of larger cells the next one hardly counts in the average
    const double largest = resolved * b.averaging_length;
    if (b.averaging_length > 0 && b.body.cell_size > largest)
      say("Cells of " + b.body.name + ", " + digits(b.body.cell_size) + " m, do not resolve its averaging_length of " +
          digits(b.averaging_length) + " m, and the soil seems stronger than it is; take at most " + digits(largest) +
          " m.");
    if (flow_off_normal(b.law) > flow_far_off_normal)
      say("Soil of " + b.body.name + " softens, and its friction angle exceeds its dilation angle by " +
          digits(flow_off_normal(b.law) / degree.si) + " degrees: a load at failure is then not unique: " + not_unique +
          ".");
    if (b.averaging_length > 0) return;  // bands are wider than a cell, and cells do not snap back alone
    if (unscaled(b.law))
      say(b.body.name +
          " softens without a reference_size: shear bands are one cell wide, so the result depends on the "
          "mesh; give the element size to which shape_factor belongs, or an averaging_length.");
    constexpr double snap_back =
        0.87;  // sqrt(3) / 2: strength of simple shear falls as fast as elastic strain gives way
    if (slope > snap_back / 2)
      say("Strength of " + b.body.name + " decreases with plastic strain at " + digits(slope, 2) +
          " of 2 G in cells of " + digits(b.body.cell_size) + " m, " +
          (slope > snap_back ? "above the " : "near the ") + digits(snap_back) +
          " at which a sheared cell snaps back; take smaller cells with a reference_size, or a smaller shape_factor.");
  }

  /// Soil that keeps its strength, where finite elements are asked how much it bears. The first stage at rest is mostly
  /// that of its own weight.
  void flow(const BodyNeeds &b) {
    if (b.softening.slope != 0 || flow_off_normal(b.law) <= flow_far_off_normal) return;
    const std::string off = "The friction angle of " + b.body.name + " exceeds its dilation angle by " +
                            digits(flow_off_normal(b.law) / degree.si) + " degrees: ";
    bool loaded = false;
    std::string loads;
    for (const Stage &stage : scene_.stage) {
      if (stage.kind != StageKind::quasi_static && stage.kind != StageKind::consolidation) continue;
      if (loaded && loads.empty()) loads = stage.name;
      loaded = true;
    }
    if (!loads.empty())
      say(off + "the load at which stage " + loads + " finds no more equilibrium is not unique: " + not_unique + ".");
    if (scene_.root->has("factor_of_safety"))
      say(off +
          "its factor of safety differs by some per cent from mesh to mesh; compute it with two. It is given "
          "between an upper bound, psi = phi, and a lower estimate, the strength of Davis (1968), " +
          digits(davis_share(b.law), 2) + " of its shear strength.");
  }

  void stiffness() {
    const LayerNeeds &layer = needs_.layer;
    if (layer.gravity_strain > 0.1)
      say("The weight of the soil strains it by " + digits(100 * layer.gravity_strain) +
          " %: soil that falls by its height arrives at " +
          digits(100 * scales::fall_speed(layer.height, needs_.gravity) / layer.wave_speed) +
          " % of the wave speed and bounces.");
  }

  void start() {
    const auto found =  // the first in which soil moves or comes to rest
        std::ranges::find_if(scene_.stage, [](const Stage &stage) { return stage.kind != StageKind::seepage; });
    if (needs_.gravity == 0 || found == scene_.stage.end() || is_static(found->kind)) return;
    const Stage &first = *found;
    const bool stressed =
        std::all_of(scene_.body.begin(), scene_.body.end(), [](const auto &b) { return !b.stress.empty(); });
    if (stressed || first.gravity_ramp > 0 || first.damping > 0) return;
    const auto at_rest = [](const Stage &stage) { return is_static(stage.kind) && stage.kind != StageKind::seepage; };
    if (const auto later = std::ranges::find_if(scene_.stage, at_rest); later != scene_.stage.end())
      say("Stage " + later->name + " would bring the soil to rest under its weight, but comes after " + first.name +
          ", in which soil without stress falls under it at once.");
    else
      say("Gravity is applied at once to soil without stress, which oscillates up to twice the static strain; give "
          "body.NAME.stress, or a first stage with gravity_ramp = " +
          digits(20 * needs_.layer.transit, 1) + " s (20 wave transits) and damping.");
  }

  /// Elastic soil at rest presses sideways with nu / (1 - nu); where that is less than the soil needs to stand, all of
  /// it yields.
  void yielding_ground(const BodyNeeds &b) {
    const bool by_weight = std::any_of(scene_.stage.begin(), scene_.stage.end(), [](const Stage &s) {
      return s.kind == StageKind::quasi_static && s.initial_stress == InitialStress::kept;
    });
    if (!by_weight || begins_at_rest(scene_, b.body.name) || !std::holds_alternative<MohrCoulomb>(b.law) ||
        needs_.gravity == 0)
      return;
    const double phi = b.body.strength.friction_angle[0];  // the least asks for most
    const double K = bulk_modulus(b.law), G = shear_modulus(b.law), nu = (3 * K - 2 * G) / (2 * (3 * K + G));
    if (std::sin(phi) >= 1 - 2 * nu || phi == 0) return;
    const double enough = (1 - std::sin(phi)) / 2;
    constexpr double locks = 0.45;
    say("Elastic ground of " + b.body.name +
        " at rest has the lateral stress ratio nu / (1 - nu) = " + digits(nu / (1 - nu), 2) +
        ", less than its friction angle requires without cohesion: much of it yields under its weight alone; take "
        "initial_stress = \"k0\"" +
        (enough < locks ? ", or poisson_ratio above " + digits(enough, 2) + " (sin phi > 1 - 2 nu)." : "."));
  }

  void stage(const Stage &stage) {
    if (is_static(stage.kind)) return;
    if (stage.until == StopWhen::equilibrium && stage.damping == 0)
      say("Stage " + stage.name + " waits for equilibrium without damping, so waves hardly decay.");
    if (stage.until == StopWhen::equilibrium && stage.duration < 20 * needs_.layer.transit)
      say("Stage " + stage.name + " lasts " + digits(stage.duration / needs_.layer.transit) +
          " wave transits, too short for equilibrium; give it " + digits(50 * needs_.layer.transit, 1) + " s or more.");
  }

  /// Bases whose friction depends on slip or heat, in stages that do not let them slip for good.
  void bases() {
    for (const BoundarySource &source : scene_.boundary) {
      if (!read_boundary(source.kind).remembers) continue;
      for (const Stage &stage : scene_.stage)
        if (is_static(stage.kind) && stage.kind != StageKind::seepage)
          say("Stage " + stage.name + " takes boundary." + source.name +
              " at a slip of 0 and cold: finite elements do not follow its slip.");
        else if (!is_static(stage.kind) && stage.gravity_ramp > 0 && stage.softening)
          say("Stage " + stage.name + " builds up the stress while boundary." + source.name +
              " counts slip and heat; softening = false keeps it fresh and cold until the loads come.");
    }
  }

  void step() {
    if (needs_.fixed_step && needs_.step < needs_.usual_step / 2)
      say("The fixed step is " + digits(needs_.step / needs_.critical_step, 2) +
          " of the critical step; without integrator.step it would be " +
          digits(needs_.usual_step / needs_.critical_step, 2) + " of it.");
    const BodyReport &b = needs_.slowest_body().body;
    if (b.critical_step > 0.4 * b.mean_critical_step) return;
    std::string at = std::string("(") + digits(b.slowest_cell[0]) + ", " + digits(b.slowest_cell[1]) +
                     (scene_.dimension == 3 ? ", " + digits(b.slowest_cell[2]) : "") + ") m";
    for (std::size_t i = 0; i < scene_.mesh->refine.size(); ++i)
      if (inside(scene_.mesh->refine[i], b.slowest_cell)) at += ", in mesh.refine." + std::to_string(i) + ",";
    say("Small cells at " + at + " determine the step: it is " + digits(b.critical_step / b.mean_critical_step, 2) +
        " of the mean critical step of the cells of " + b.name + ".");
  }

  bool inside(const RefineBox &box, const std::array<double, 3> &x) const {
    for (int d = 0; d < 2; ++d)
      if (x[d] < box.from[d] || x[d] > box.to[d]) return false;
    return true;
  }

  void transfer() {
    const Transfer &t = *scene_.transfer;
    if (t.remap_interval == 0)
      say("A remap in every step costs twice the time or more and adds cell-crossing noise; transfer.remap_interval "
          "= " +
          digits(Transfer().remap_interval) + " is the default.");
    if (t.velocity == Velocity::pic)
      say("transfer.velocity = \"pic\" damps motion at each remap: a slide is slower and comes less far.");
    if (t.integration == Integration::particle || t.integration == Integration::mixed)
      say("Integration by particle volumes was four to nine times less accurate than \"blended\" where particles cross "
          "cells.");
    constexpr long long few = 5000;
    if (needs_.ranks > 1 && needs_.particles() / needs_.ranks < few)
      say("A rank has " + std::to_string(needs_.particles() / needs_.ranks) + " particles; below " +
          std::to_string(few) + " communication takes longer than the computation it shares.");
  }

  void dimension() {
    if (!needs_.mesh.one_element_slice) return;
    // measured on the gallery's column: with four particles a cell a step costs 7 times, and 1.6 times as many are
    // needed
    constexpr double per_particle_in_cell = 2.8;
    double cells = 0;
    for (const BodyNeeds &b : needs_.bodies) cells += static_cast<double>(b.body.cells);
    say("A slice of one element gives the result of plane strain on triangles at about " +
        digits(per_particle_in_cell * static_cast<double>(needs_.particles()) / cells, 2) +
        " times the cost; set dimension = 2.");
  }

  void water() {
    const Drainage &d = needs_.drainage;
    if (d.time == 0) return;
    const std::string bounds = std::string("k above ") + digits(d.drained_above, 1) + " m/s", time = spoken(d.time);
    const std::string undrained = digits(d.undrained_below, 1) + " m/s";
    if (scene_.phases == PhaseModel::drained && needs_.drainage.computed)
      say("The water stands still while the soil moves: right where soil drains in the " + time +
          " of the dynamic stages, " + bounds + ".");
    else if (scene_.phases == PhaseModel::drained)
      say("A prescribed pore pressure is right where soil drains in the " + time + " of the stages, " + bounds +
          "; below " + undrained + " failure is undrained: use total-stress strengths.");
    else if (fluids_move(scene_.phases) && !needs_.drainage.computed)
      say("Moving pore water is needed for k between " + undrained + " (undrained in the " + time +
          " of the stages) and " + digits(d.drained_above, 1) + " m/s (drained).");
    else if (!fluids_move(scene_.phases))
      say("phases = \"dry\" is right for soil without water, or with total-stress strengths; with water the soil would "
          "be "
          "drained in " +
          time + " for " + bounds + " and undrained below " + undrained + ".");
  }

  SoilPores pores_of(std::size_t b) const {
    return {scene_.body[b], scene_.water->density * (needs_.gravity > 0 ? needs_.gravity : 9.81),
            scene_.water->viscosity};
  }

  /// Gas that drag hardly holds: its waves between cells lose less of their speed than they gain at a wetting front.
  void gas_without_drag() {
    constexpr double held = 0.2;  // share of the angular frequency of a wave of two cells; 0.25 held, 0.1 did not
    if (scene_.phases != PhaseModel::three_phase) return;
    const PoreGas gas(*scene_.gas);
    for (std::size_t b = 0; b < scene_.body.size(); ++b) {
      if (!needs_.bodies[b].there()) continue;
      const SoilPores soil = pores_of(b);
      const double lost = soil.porosity() * gas.viscosity / (soil.gas_permeability() * gas.density),
                   turns = 2 * std::sqrt(gas.bulk_modulus / gas.density) / needs_.bodies[b].body.cell_size;
      if (lost < held * turns)
        say("Gas moves through " + scene_.body[b].name +
            " with hardly any drag, gains energy where water comes in and may throw "
            "soil out; a gas_permeability below " +
            digits(lost / (held * turns) * soil.gas_permeability(), 2) + " m2 holds it.");
    }
  }

  /// Gas shares at which waves of some body grow without bound.
  void suction() {
    const bool gas_moves = scene_.phases == PhaseModel::three_phase, bishop = scene_.water->stress == PoreStress::bishop;
    if (scene_.phases != PhaseModel::unsaturated && !gas_moves) return;
    const Liquid liquid(*scene_.water);
    for (std::size_t b = 0; b < scene_.body.size(); ++b) {
      const SoilPores soil = pores_of(b);
      double first = 0, last = 0;
      for (double share = 2 * residual_gas; share < 0.99 * soil.largest_gas_share(); share *= 1.05) {
        if (hyperbolic(soil, liquid, PoreGas(*scene_.gas), constrained_modulus(needs_.bodies[b].law),
                       scene_.body[b].grain_density, share, gas_moves, bishop))
          continue;
        if (first == 0) first = share;
        last = share;
      }
      if (first > 0)
        say("The equations of " + scene_.body[b].name + " are not hyperbolic at " +
            (last > first ? "saturations from " + digits(1 - last, 4) + " to " : std::string("a saturation of ")) +
            digits(1 - first, 4) +
            " with net stress and no drag: short waves grow there unless permeability is low; set water.stress = "
            "\"bishop\", or take stiffer soil or water.");
    }
  }

  const Scene &scene_;
  const Needs &needs_;
  std::vector<std::string> advice_;
};

}  // namespace

std::vector<std::string> advise(const Scene &scene, const Needs &needs) { return Adviser(scene, needs).all(); }

std::string spoken(double seconds) {
  const std::pair<double, const char *> units[] = {{86400, "d"}, {3600, "h"},  {60, "min"},
                                                   {1, "s"},     {1e-3, "ms"}, {1e-6, "us"}};
  for (const auto &[size, name] : units)
    if (seconds >= size) return digits(seconds / size) + " " + name;
  return digits(seconds) + " s";
}

}  // namespace talus
