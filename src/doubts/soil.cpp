// Doubts about strength, stiffness and pores of the soil beside its weight.
#include <cmath>

#include "base/rounded.h"
#include "doubts/doubts.h"
#include "physics/laws/frictional_strength.h"
#include "scene/body_source.h"
#include "scene/quasi_static_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"

namespace talus {
namespace {

/// Strength and stiffness that fit one another, and the depth of the soil.
void doubt_strength(const Start &start, std::size_t b, Doubts &doubts) {
  constexpr double rock = 1e6;  // [Pa]
  const BodySource &source = start.scene.body[b];
  const BodyReport &body = start.bodies[b];
  const Law &law = start.laws[b];
  if (!has_friction(law) || body.particles == 0) return;
  const std::string of = "body." + source.name + ": ";
  const double c = body.strength.cohesion[1], density = body.mass / body.volume, K = bulk_modulus(law),
               young = 9 * K * shear_modulus(law) / (3 * K + shear_modulus(law)),
               weight = density * start.scene.gravity_size() * start.depth_of(b);
  if (c > 0 && source.reduce_strength) {
    doubts.say_unusual("stiffness", of + "young_modulus / cohesion", young / c, one, {5, 1e7});
    if (weight > 0)
      doubts.say_unusual("strength", of + "cohesion / weight over the depth", c / weight, one, {1e-4, 100});
  }
  if (c < rock)
    doubts.say_unusual("stiffness", of + "speed of waves", std::sqrt(constrained_modulus(law) / density),
                       metre_per_second, {0, 2500});
}

/// Water takes nothing from undrained strength.
void doubt_undrained_strength(const Start &start, std::size_t b, Doubts &doubts) {
  const Scene &scene = start.scene;
  const BodyReport &body = start.bodies[b];
  const WaterTable &table = scene.body[b].water_table.given() ? scene.body[b].water_table : scene.water->table;
  const bool none =
      has_friction(start.laws[b]) && body.strength.friction_angle[1] == 0 && body.strength.cohesion[1] > 0;
  if (!none || body.particles == 0 || scene.phases != PhaseModel::drained || !table.given()) return;
  if (reads_suction(start.laws[b])) return;
  const std::vector<double> times = scene.water->level.times();
  double rise = scene.water->level.uses("t") ? std::numeric_limits<double>::infinity() : scene.water->level(0);
  for (const double t : times) rise = std::max(rise, scene.water->level(t));
  double highest = table.points.empty() ? std::numeric_limits<double>::infinity() : -1e300;
  for (const auto &point : table.points) highest = std::max(highest, point[1] + rise);
  if (highest > body.low[start.up])
    doubts.say("undrained_strength",
               "body." + body.name +
                   " has friction_angle = 0 and lies below a water table: water "
                   "that rises does not weaken it; if its cohesion is drained, give its friction_angle too");
}

/// The share of a load that water takes at once where it cannot flow, Skempton (1954), B = 1 / (1 + n K / K_l).
void doubt_soft_water(const Start &start, std::size_t b, Doubts &doubts) {
  const Scene &scene = start.scene;
  const double n = scene.body[b].porosity;
  if (fluids_move(scene.phases) && n > 0)
    doubts.say_unusual("soft_water",
                       "body." + scene.body[b].name +
                           ": share of an undrained load that the pore water takes, "
                           "by water.bulk_modulus",
                       1 / (1 + n * bulk_modulus(start.laws[b]) / scene.water->bulk_modulus), one, {0.8, 1});
}

/// Sand that is steeper than its friction angle must fail, but in few cells over its depth it may keep its slope.
void doubt_steep_face(const Start &start, std::size_t b, Doubts &doubts) {
  constexpr double enough = 10;             // cells over the depth
  constexpr double beyond = 5 * degree.si;  // the friction angle
  constexpr double share = 0.02;            // of the free surface, which contains level ground
  constexpr double no_effect = 1e-3;        // c over the weight
  const BodyReport &body = start.bodies[b];
  const double depth = start.depth_of(b), weight = body.mass / body.volume * start.scene.gravity_size() * depth,
               phi = body.strength.friction_angle[1];
  if (phi == 0 || body.strength.cohesion[1] > no_effect * weight || depth >= enough * body.cell_size) return;
  double all = 0, steep = 0;
  for (const SoilFace &face : start.surface) {
    const double up = face.normal[start.up];
    if (face.body != static_cast<int>(b) || face.conditioned || up < -1e-6) continue;
    all += face.area;
    if (std::acos(std::clamp(up, 0., 1.)) > phi + beyond) steep += face.area;
  }
  if (steep > share * all)
    doubts.say("steep_face", rounded(100 * steep / all) + " % of the free surface of body." + body.name +
                                 " is steeper than its friction angle by more than " + rounded(beyond / degree.si) +
                                 " deg and has to fail, but may stand in fewer than " + rounded(enough) +
                                 " cells over its depth (" + rounded(depth) + " m, cells of " +
                                 rounded(body.cell_size) + " m)");
}

}  // namespace

void doubt_soil(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  for (std::size_t b = 0; b < start.laws.size(); ++b) {
    const std::string name = "body." + scene.body[b].name;
    const FrictionalStrength *strength = frictional_strength(start.laws[b]);
    const bool dilates = strength && strength->dilation_angle > 0;
    if (dilates && scene.transfer->locking == Locking::nodal)
      doubts.say("nodal_locking", name + " dilates, and transfer.locking = \"nodal\" then creates energy");
    if (scene.body[b].volume_cap > 0 && fluids_move(scene.phases))
      doubts.say("pore_volume_cap",
                 name + ".volume_cap compresses pores when gaps close, and their pressure throws soil out");
    doubt_strength(start, b, doubts);
    doubt_undrained_strength(start, b, doubts);
    doubt_soft_water(start, b, doubts);
  }
}

void doubt_cells(const Start &start, Doubts &doubts) {
  const auto rests = std::ranges::find_if(start.scene.stage, [](const Stage &stage) { return stage.is_static(); });
  for (const BodyReport &body : start.bodies)
    if (body.one_element_across && rests != start.scene.stage.end() &&
        start.scene.quasi_static->elements != Elements::quadratic)
      doubts.say("thin_body",
                 "body." + body.name + " is one element across: stage." + rests->name + " will end the run");
  constexpr double few = 4;  // over the depth: not even a slip surface fits in
  if (start.scene.gravity_size() == 0) return;
  for (std::size_t b = 0; b < start.bodies.size(); ++b) {
    const BodyReport &body = start.bodies[b];
    if (body.particles == 0 || start.depth <= 0) continue;
    if (start.depth < few * body.cell_size)
      doubts.say("coarse_cells", "body." + body.name + " has cells of " + rounded(body.cell_size) + " m, fewer than " +
                                     rounded(few) + " over the depth of the soil, " + rounded(start.depth) +
                                     " m, which resolve neither stress nor slip surface; take a smaller mesh.size");
    else if (start.scene.phases == PhaseModel::dry)
      doubt_steep_face(start, b, doubts);
  }
}

}  // namespace talus
