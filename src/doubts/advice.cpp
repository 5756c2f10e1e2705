// What `check` advises: particles, cells, softening, stages, steps, water. Doubts are in doubts.h.
#include <algorithm>
#include <cmath>

#include "base/rounded.h"
#include "doubts/needs.h"
#include "doubts/scales.h"
#include "particles/body.h"
#include "physics/boundary/boundary.h"
#include "physics/laws/laws.h"
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
bool unscaled(const Law &law) { return softens(law) && frictional_strength(law)->reference_size == 0; }

/// Peak friction angle less dilation angle [rad]; 0 for soil without them.
double flow_off_normal(const Law &law) {
  const FrictionalStrength *strength = frictional_strength(law);
  return strength ? strength->friction_angle - strength->dilation_angle : 0;
}

/// Share of its shear strength that soil bears on a slip surface, Davis (1968).
double davis_share(const Law &law) {
  const FrictionalStrength *strength = frictional_strength(law);
  if (!strength) return 1;
  const double phi = strength->friction_angle, psi = strength->dilation_angle;
  return std::cos(phi) * std::cos(psi) / (1 - std::sin(phi) * std::sin(psi));
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
      if (b.law.as<Umat>())
        say("body." + b.body.name +
            " runs the library of its UMAT, which can do whatever a program can; --no-umat refuses it.");
    if (!needs_.burst_failure.empty()) say("The run breaks off in its first steps: " + needs_.burst_failure + ".");
    for (const std::string &remark : needs_.mesh.remarks) say(remark);
    for (const BodyNeeds &b : needs_.bodies)
      if (b.there()) particles(b), softening(b), flow(b);
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
    start();
    bases();
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
    const auto moves = [](const Stage &stage) { return !stage.is_static() && stage.pore_flow; };
    if (fluids_move(scene_.phases) && std::ranges::any_of(scene_.stage, moves) && fewest < (plane ? 6 : 8))
      say(std::to_string(fewest) + each +
          "if soil with pore fluids flows far: a column of saturated sand ran out a fifth "
          "less far with 3 per triangle than with 6 or 12; look with `talus converge --by particles`.");
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
      if (!stage.settles_soil()) continue;
      if (loaded && loads.empty()) loads = stage.name;
      loaded = true;
    }
    if (!loads.empty())
      say(off + "the load at which stage " + loads + " finds no more equilibrium is not unique: " + not_unique + ".");
    if (scene_.root->has("factor_of_safety") || scene_.finds_factor())
      say(off +
          "its factor of safety differs by some per cent from mesh to mesh; compute it with two. It is given "
          "between an upper bound, psi = phi, and a lower estimate, the strength of Davis (1968), " +
          digits(davis_share(b.law), 2) + " of its shear strength.");
  }

  void start() {
    const auto found =  // the first in which soil moves or comes to rest
        std::ranges::find_if(scene_.stage, [](const Stage &stage) { return stage.soil_moves(); });
    if (needs_.gravity == 0 || found == scene_.stage.end() || found->is_static()) return;
    const Stage &first = *found;
    const bool stressed =
        std::all_of(scene_.body.begin(), scene_.body.end(), [](const auto &b) { return !b.stress.empty(); });
    if (stressed || first.gravity_ramp() > 0 || first.damping() > 0) return;
    const auto at_rest = [](const Stage &stage) { return stage.settles_soil(); };
    if (const auto later = std::ranges::find_if(scene_.stage, at_rest); later != scene_.stage.end())
      say("Stage " + later->name + " would bring the soil to rest under its weight, but comes after " + first.name +
          ", in which soil without stress falls under it at once.");
    else
      say("Gravity is applied at once to soil without stress, which oscillates up to twice the static strain; give "
          "body.NAME.stress, or a first stage with gravity_ramp = " +
          digits(20 * needs_.layer.transit, 1) + " s (20 wave transits) and damping.");
  }

  /// Bases whose friction depends on slip or heat, in stages that do not let them slip for good.
  void bases() {
    for (const BoundarySource &source : scene_.boundary) {
      if (!read_boundary(source.kind).remembers) continue;
      for (const Stage &stage : scene_.stage)
        if (stage.settles_soil())
          say("Stage " + stage.name + " takes boundary." + source.name +
              " at a slip of 0 and cold: finite elements do not follow its slip.");
        else if (!stage.is_static() && stage.gravity_ramp() > 0 && stage.softening)
          say("Stage " + stage.name + " builds up the stress while boundary." + source.name +
              " counts slip and heat; softening = false keeps it fresh and cold until the loads come.");
    }
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
    const bool gas_moves = scene_.phases == PhaseModel::three_phase,
               bishop = scene_.water->stress == PoreStress::bishop;
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
