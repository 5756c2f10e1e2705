// Doubts about relations between keys of a scene: soils, the water table, stages.
#include <cmath>
#include <limits>

#include "base/rounded.h"
#include "doubts/doubts.h"
#include "doubts/needs.h"
#include "earthquake/sources.h"
#include "physics/boundary/boundary.h"
#include "physics/laws/frictional_strength.h"
#include "physics/pores/hyperbolicity.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/quasi_static_source.h"
#include "scene/reader.h"
#include "scene/stage.h"
#include "scene/water_source.h"
#include "simulation/changing_loads.h"

namespace talus {
namespace {

/// Strength, stiffness and pores of a soil. The share of a load that water takes at once where it cannot flow is
/// B = 1 / (1 + n K / K_l), Skempton (1954).
void doubt_soil(const Start &start, std::size_t b, Doubts &doubts) {
  const Scene &scene = start.scene;
  const BodySource &source = scene.body[b];
  const BodyReport &body = start.bodies[b];
  const Law &law = start.laws[b];
  const std::string name = "body." + source.name;
  const bool moves = fluids_move(scene.phases), there = body.particles > 0;
  const FrictionalStrength *strength = frictional_strength(law);
  const Function &excess = scene.water->excess;
  const bool two_weights = (source.saturation > 0 && source.saturation < 1) || source.saturated_unit_weight > 0,
             excess_alone = scene.phases == PhaseModel::drained && (!excess.constant() || excess(0) != 0) &&
                            !scene.water->table.given() && !source.water_table.given() &&
                            source.pore_pressure_ratio == 0;
  doubts.say(
      {{"excess_alone", excess_alone && two_weights,
        "water.excess is the only pore pressure of " + name +
            ": without a water.table all of this soil has the weight above one"},
       {"relative_permeability",
        std::ranges::any_of(scene.stage, [](const Stage &s) { return s.water_flows(); }) && source.retention.reader &&
            !source.relative_permeability.reader,
        name + " has a retention curve and no relative_permeability: it conducts water as if its pores were full"}});
  const double c = body.strength.cohesion[1],
               weight = there ? body.mass / body.volume * scene.gravity_size() * start.depth_of(b) : 0;
  if (strength && source.reduce_strength && c > 0 && weight > 0)
    doubts.say({unusual("strength", name + ": cohesion / weight over the depth", c / weight, one, {1e-4, 100})});
  if (moves && source.porosity > 0)
    doubts.say(
        {unusual("soft_water", name + ": share of an undrained load that the pore water takes, by water.bulk_modulus",
                 1 / (1 + source.porosity * bulk_modulus(law) / scene.water->bulk_modulus), one, {0.8, 1})});
}

/// The water table of [water], which lies level beyond its ends, and where the soil is. Where pore water moves the
/// table is what pores begin with, and no stage looks at it again unless it prescribes the pressure.
void doubt_table(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  const WaterTable &table = scene.water->table;
  const bool changes = scene.water->level.depends_on_time() || scene.water->excess.depends_on_time();
  doubts.say({{"changing_table",
               fluids_move(scene.phases) && changes &&
                   std::ranges::all_of(scene.stage, [](const Stage &s) { return !s.is_static() && s.pore_flow; }),
               "water.level or water.excess changes with time, and pore water moves in all stages: only its value at "
               "the start counts. Water that rises beside the soil is a boundary with kind = \"head\""}});
  if (!table.given() || scene.gravity_size() == 0 || start.height() < 0) return;
  const double level = scene.water->level(0), top = start.high[start.up], bottom = start.low[start.up];
  Span x, elevation;
  for (const auto &point : table.points) x.widen(point[0]), elevation.widen(point[1] + level);
  for (const SoilFace &face : start.surface)
    for (int a = 0; a < scene.dimension && table.points.empty(); ++a) {
      const auto &[east, up, north] = face.corner[a];
      elevation.widen(table.at(east, up, north) + level);
    }
  const bool dry = scene.phases == PhaseModel::drained && !has_seepage(scene) &&
                   !scene.water->level.depends_on_time() && elevation.to <= bottom,
             beside = table.points.size() > 1 && (x.from >= start.high[0] || x.to <= start.low[0]);
  doubts.say(
      {{"water_table", dry || beside || elevation.from > top + 2 * start.height(),
        "water.table lies at " + elevation.text(start.up) + (beside ? ", " + x.text(0) : "") + ", and the soil at " +
            Span{bottom, top}.text(start.up) + (beside ? ", " + Span{start.low[0], start.high[0]}.text(0) : "") +
            (dry ? ": it gives no pore pressure" : ": are both in the same coordinates?")}});
}

/// What never acts in the stages, or is undone by them.
void doubt_stages(const Scene &scene, Doubts &doubts) {
  std::string flowed;  // stage in which water has
  for (const Stage &stage : scene.stage) {
    const std::string name = "stage." + stage.name, longer = " s is longer than the stage: ";
    const auto *fails = stage.motion() ? std::get_if<AtFailure>(&stage.motion()->until) : nullptr;
    const double ramp = stage.gravity_ramp(), failure = fails ? fails->failure_time : 0;
    doubts.say({{"gravity_ramp", ramp > stage.duration,
                 name + ".gravity_ramp = " + rounded(ramp) + longer + "gravity does not come to its full value in it"},
                {"failure_time", failure > stage.duration,
                 name + ".failure_time = " + rounded(failure) + longer + "it finds no failure"},
                {"pore_flow", !stage.pore_flow && !stage.water_flows() && !flowed.empty(),
                 name + ".pore_flow = false gives the pores the pressure of [water] again: what stage." + flowed +
                     " has brought is undone"}});
    if (stage.water_flows()) flowed = stage.name;
  }
  const double end = end_of_loads(scene);
  for (const ChangingLoad &load : changing_loads(scene)) {
    const double begin = std::max(0., std::ranges::min_element(load.when, {}, &TimeSpan::begin)->begin);
    doubts.say({{"late_load", begin >= end,
                 load.key + " changes from t = " + rounded(begin) + " s on, and the loads of the stages end at t = " +
                     rounded(end) + " s: it acts as at t = 0 in all of the run"}});
  }
  for (const EarthquakeSource &component : scene.earthquake)
    if (const std::string sentence = drift_of(read_motion(component), component); !sentence.empty())
      doubts.say({{"drift", true, sentence}});
  doubts.say(
      {{"idle_earthquake",
        !scene.earthquake.empty() && std::ranges::none_of(scene.stage, [](const Stage &s) { return s.shakes(); }),
        "no stage has earthquake = true: the motion of [[earthquake]] acts in none"},
       {"early_suction",
        scene.phases == PhaseModel::drained && scene.water->suction.given() && has_seepage(scene) &&
            !scene.stage.front().seeps(),
        "water.suction acts from the first stage of seepage on: the soil of stage." + scene.stage.front().name +
            " has none; put a stage of seepage with hold_loads = true before it"}});
}

/// Cells that resolve neither slip surfaces nor softening. Sand that is steeper than its friction angle must fail, but
/// in few cells over its depth it may keep its slope.
void doubt_cells(const Start &start, std::size_t b, Doubts &doubts) {
  constexpr double few = 4, enough = 10;    // cells over the depth: fewer have no slip surface; slopes of sand stand
  constexpr double beyond = 5 * degree.si;  // the friction angle
  constexpr double share = 0.02;            // of the free surface, which contains level ground
  constexpr double no_effect = 1e-3;        // c over the weight
  const BodyReport &body = start.bodies[b];
  const auto rests = std::ranges::find_if(start.scene.stage, [](const Stage &stage) { return stage.is_static(); });
  if (rests != start.scene.stage.end() && start.scene.quasi_static->elements != Elements::quadratic)
    doubts.say({{"thin_body", body.one_element_across,
                 "body." + body.name + " is one element across: stage." + rests->name + " will end the run"}});
  if (body.particles == 0 || start.depth <= 0 || start.scene.gravity_size() == 0) return;
  const double depth = start.depth_of(b), phi = body.strength.friction_angle[1],
               weight = body.mass / body.volume * start.scene.gravity_size() * depth;
  const bool coarse = start.depth < few * body.cell_size,
             sand = start.scene.phases == PhaseModel::dry && phi > 0 && body.strength.cohesion[1] <= no_effect * weight;
  const auto ground = [&](const SoilFace &face) {
    return face.body == static_cast<int>(b) && !face.conditioned && face.normal[start.up] >= -1e-6;
  };
  const double all = start.faces(ground).area,
               steep = start
                           .faces([&](const SoilFace &face) {
                             return ground(face) && std::acos(std::clamp(face.normal[start.up], 0., 1.)) > phi + beyond;
                           })
                           .area;
  const std::string cells =
      " cells over its depth (" + rounded(depth) + " m, cells of " + rounded(body.cell_size) + " m)";
  doubts.say({{"coarse_cells", coarse,
               "body." + body.name + " has cells of " + rounded(body.cell_size) + " m, fewer than " + rounded(few) +
                   " over the depth of the soil, " + rounded(start.depth) +
                   " m, which resolve neither stress nor slip surface; take a smaller mesh.size"},
              {"steep_face", !coarse && sand && depth < enough * body.cell_size && steep > share * all,
               rounded(100 * steep / all) + " % of the free surface of body." + body.name +
                   " is steeper than its friction angle by more than " + rounded(beyond / degree.si) +
                   " deg and has to fail, but may stand in fewer than " + rounded(enough) + cells}});
}

void doubt_softening(const Start &start, std::size_t b, Doubts &doubts) {
  constexpr double resolved = 0.8;  // of the averaging length: of larger cells the next one hardly counts
  if (!softens(start.laws[b]) || start.bodies[b].particles == 0) return;
  const double length = start.scene.body[b].averaging_length, largest = resolved * length,
               size = start.bodies[b].cell_size;
  const std::string name = "body." + start.bodies[b].name;
  doubts.say(
      {{"coarse_cells", length > 0 && size > largest,
        "cells of " + name + ", " + rounded(size) + " m, do not resolve its averaging_length of " + rounded(length) +
            " m, and the soil seems stronger than it is; take at most " + rounded(largest) + " m"},
       {"reference_size", length == 0 && frictional_strength(start.laws[b])->reference_size == 0,
        name + " softens without a reference_size: shear bands are one cell wide, so the result depends on the "
               "mesh; give the element size to which shape_factor belongs, or an averaging_length"}});
}

/// Waves of soil, water and gas that grow without bound, the shortest fastest.
void doubt_short_waves(const Start &start, std::size_t b, Doubts &doubts) {
  const Scene &scene = start.scene;
  const bool gas_moves = scene.phases == PhaseModel::three_phase;
  if (scene.phases != PhaseModel::unsaturated && !gas_moves) return;
  const SoilPores soil{scene.body[b], scene.water->density * (scene.gravity_size() > 0 ? scene.gravity_size() : 9.81),
                       scene.water->viscosity};
  Span growing;  // saturations
  for (double share = 2 * residual_gas; share < 0.99 * soil.largest_gas_share(); share *= 1.05)
    if (!hyperbolic(soil, Liquid(*scene.water), PoreGas(*scene.gas), constrained_modulus(start.laws[b]),
                    scene.body[b].grain_density, share, gas_moves, scene.water->stress == PoreStress::bishop))
      growing.widen(1 - share);
  doubts.say(
      {{"short_waves", growing.to > 0,
        "the equations of body." + scene.body[b].name + " are not hyperbolic at saturations of " +
            rounded(growing.from) + " to " + rounded(growing.to) +
            " with net stress and no drag: short waves grow there unless permeability is low; set water.stress = "
            "\"bishop\", or take stiffer soil or water"}});
}

/// Pore pressure that is given stays while soil moves, as where it drains at once.
void doubt_drainage(const Scene &scene, const BodySource &body, const Drainage &drainage, Doubts &doubts) {
  const double k = body.hydraulic_conductivity > 0
                       ? body.hydraulic_conductivity
                       : body.permeability * scene.water->density * scene.gravity_size() / scene.water->viscosity;
  doubts.say({{"drainage", scene.phases == PhaseModel::drained && k > 0 && k < drainage.drained_above,
               "the pore pressure of body." + body.name + " stays as prescribed while the soil moves for " +
                   spoken(drainage.time) + ", as in soil that drains at once, with k above " +
                   rounded(drainage.drained_above, 1) + " m/s; it has " + rounded(k, 2) + " m/s"}});
}

/// How soil gets its weight in the first stage in which it moves or comes to rest, and bases that count slip meanwhile.
void doubt_first_weight(const Scene &scene, Doubts &doubts) {
  const auto first = std::ranges::find_if(scene.stage, [](const Stage &stage) { return stage.soil_moves(); });
  const bool moves = scene.gravity_size() > 0 && first != scene.stage.end() && !first->is_static(),
             stressed = std::ranges::none_of(scene.body, [](const BodySource &b) { return b.stress.empty(); });
  const bool at_once = moves && !stressed && first->gravity_ramp() == 0 && first->damping() == 0;
  const auto later = std::ranges::find_if(scene.stage, [](const Stage &stage) { return stage.settles_soil(); });
  doubts.say(
      {{"gravity", !scene.root->has("gravity"), "the scene gives no gravity, so that soil has no weight"},
       {"gravity_at_once", at_once,
        "gravity is applied at once to soil without stress, which oscillates up to twice the static strain" +
            (later == scene.stage.end() ? "" : ", and stage " + later->name + " comes too late to prevent it") +
            ": begin with a stage of kind = \"quasi_static\", a gravity_ramp with damping, or body.NAME.stress"}});
  for (const BoundarySource &source : scene.boundary)
    for (const Stage &stage : scene.stage)
      doubts.say({{"base_slips", stage.gravity_ramp() > 0 && stage.softening && read_boundary(source.kind).remembers,
                   "stage " + stage.name + " builds up the stress while boundary." + source.name +
                       " counts slip and heat; softening = false keeps it fresh and cold until the loads come"}});
}

}  // namespace

void doubt_scene(const Start &start, Doubts &doubts) {
  doubt_stages(start.scene, doubts);
  for (std::size_t b = 0; b < start.laws.size(); ++b) doubt_soil(start, b, doubts);
  doubt_table(start, doubts);
}

void doubt_before_run(const Start &start, const Drainage &drainage, Doubts &doubts) {
  for (std::size_t b = 0; b < start.bodies.size(); ++b) doubt_cells(start, b, doubts);
  for (std::size_t b = 0; b < start.laws.size(); ++b) {
    doubt_softening(start, b, doubts);
    doubt_short_waves(start, b, doubts);
    doubt_drainage(start.scene, start.scene.body[b], drainage, doubts);
  }
  if (start.scene.root) doubt_first_weight(start.scene, doubts);
}

}  // namespace talus
