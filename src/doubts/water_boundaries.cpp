// Doubts about boundaries of the water in the pores: where they are, what they bring and when.
#include <cmath>

#include "base/rounded.h"
#include "doubts/doubts.h"
#include "physics/boundary/boundary.h"
#include "physics/phase_models.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/water_source.h"

namespace talus {
namespace {

/// A boundary of the scene as doubts look at it.
struct Watered {
  const BoundarySource &source;
  Boundary kind;
  bool anywhere;                        ///< on the free surface
  std::vector<const SoilFace *> faces;  ///< of the soil
  std::string name() const { return "boundary." + source.name; }
};

/// Open water that stands on none of its faces, rain that reaches none, and supply that goes on when its table is over.
/// What changes is asked for the start alone.
void doubt_supply(const Start &start, const Watered &one, double end, Doubts &doubts) {
  constexpr double vertical = 1e-6;  // of a normal, to round-off
  const Scene &scene = start.scene;
  const int up = start.up;
  const double g = scene.gravity.empty() ? 0 : -scene.gravity[up];
  double pressure = 0, upward = 0;
  for (const SoilFace *face : one.faces) {
    double facing = 0;
    for (int d = 0; d < scene.dimension; ++d) facing += face->normal[d] * scene.upward()[d];
    upward = std::max(upward, facing);
    for (int a = 0; a < scene.dimension && one.kind.open_water; ++a) {
      const auto &[x, y, z] = face->corner[a];
      pressure = std::max(pressure, one.kind.outside(x, y, z, 0, {scene.water->density * g, face->corner[a][up]}));
    }
  }
  const bool seeps = one.kind.water == OnWater::seepage;
  if (seeps && !one.faces.empty() && one.kind.open_water && one.kind.changes.empty() && !(pressure > 0))
    doubts.say("dry_boundary", one.name() + " has its water below all of its faces, where water may only leave");
  if (seeps && one.faces.empty() && one.kind.supply && !one.kind.open_water)
    doubts.say("dry_boundary", one.name() + " touches no soil at the start; is group = \"free_surface\" meant?");
  if (seeps && !one.faces.empty() && one.kind.supply && !one.kind.open_water && upward < vertical)
    doubts.say(
        "dry_boundary",
        one.name() + " lies on faces that are vertical or overhang, and rain counts per level area: none enters");
  if (one.kind.changes.empty() || !(one.kind.supply || one.kind.inflow) || one.faces.empty()) return;
  const double last = std::ranges::max_element(one.kind.changes, {}, &TimeSpan::end)->end;
  const auto &[x, y, z] = one.faces.front()->corner[0];
  const double rate =
      last < end ? one.kind.supply ? one.kind.supply(x, y, z, last, 1) : one.kind.inflow(x, y, z, last) : 0;
  if (rate != 0)
    doubts.say("lasting_rain", one.name() + " goes on with " + rounded(rate) +
                                   " m/s when its table is over, from t = " + rounded(last) +
                                   " s until the stages end at t = " + rounded(end) + " s");
}

/// Faces of a boundary belong to the mesh. Soil that settles or slides away from them leaves the boundary without soil.
void doubt_faces_left(const Scene &scene, const Watered &one, Doubts &doubts) {
  const auto moves = [](const Stage &s) { return !s.is_static() && s.pore_flow; };
  if (!one.kind.fluid_face() || one.anywhere || std::ranges::none_of(scene.stage, moves)) return;
  if (std::ranges::any_of(one.faces, [](const SoilFace *face) { return !face->ends_mesh; }))
    doubts.say("faces_left", one.name() +
                                 " decides on the water at faces where the soil begins: soil that moves away from them "
                                 "has the atmosphere there instead. The group free_surface follows the soil");
}

/// Open water that rises or falls in a stage of elements whose pore water stays: its load changes, and the pressure in
/// the pores does not.
void doubt_open_water_without_flow(const Start &start, const Watered &one, Doubts &doubts) {
  constexpr double deep = -1e4;  // elevation below all levels that are asked [m]
  const auto level = [&](double t) { return one.kind.outside(0, 0, 0, t, {1, deep}) + deep; };
  double from = 0;  // load time [s]
  for (const Stage &stage : start.scene.stage) {
    const double to = from + (stage.hold_loads ? 0 : stage.duration);
    if (one.kind.open_water && stage.is_static() && !stage.water_flows() &&
        std::abs(level(to) - level(from)) >= visible * start.height())
      doubts.say("undrained_stage", "the water of " + one.name() + " goes from " + rounded(level(from)) + " to " +
                                        rounded(level(to)) + " m in stage " + stage.name +
                                        ", in which no pore water moves: it loads the soil, whose pore pressure "
                                        "stays, and a slope seems too safe. kind = \"consolidation\" lets both follow");
    from = to;
  }
}

/// Pores that cannot dry have no suction with which to hold back what an open surface offers.
void doubt_open_ground(const Start &start, const std::vector<Watered> &boundaries, Doubts &doubts) {
  const auto dries = [](const BodySource &body) { return static_cast<bool>(body.retention.reader); };
  const auto on_ground = [](const Watered &one) { return one.anywhere && one.kind.fluids_only(); };
  if (std::ranges::any_of(start.scene.body, dries) || std::ranges::any_of(boundaries, on_ground)) return;
  const auto bare = std::ranges::find_if(start.surface, [&](const SoilFace &face) {
    return face.water < 0 && may_be_flooded(face, start.up) && face.normal[start.up] > 0.1;
  });
  if (bare != start.surface.end())
    doubts.say("film", "the ground at x = " + rounded(bare->corner[0][0]) + ", " + axis_names[start.up] + " = " +
                           rounded(bare->corner[0][start.up]) +
                           " m has no boundary of water, so that its pressure is 0 in stages of seepage: "
                           "as under a film of water. Dry ground has kind = \"rainfall\" and intensity = 0 on group = "
                           "\"free_surface\", or a "
                           "retention curve");
}

}  // namespace

void doubt_water_boundaries(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  const bool drained = scene.phases == PhaseModel::drained, moves = phase_traits(scene.phases).liquid;
  double end = 0;  // of the load time [s]
  for (const Stage &stage : scene.stage)
    if (!stage.hold_loads) end += stage.duration;
  std::vector<Watered> boundaries;
  for (std::size_t b = 0; b < scene.boundary.size(); ++b) {
    const BoundarySource &source = scene.boundary[b];
    boundaries.push_back(Watered{source, read_boundary(source.kind), on_free_surface(source), {}});
    for (const SoilFace &face : start.surface)
      if (face.water == static_cast<int>(b) || (boundaries.back().anywhere && face.water < 0))
        boundaries.back().faces.push_back(&face);
  }
  for (const Watered &one : boundaries) {
    doubt_supply(start, one, end, doubts);
    if (moves) doubt_faces_left(scene, one, doubts), doubt_open_water_without_flow(start, one, doubts);
    // pressure rises under ground that lets no water out, where none stands that would bear against it
    if (drained && scene.water->open_water_load && has_seepage(scene) && one.anywhere &&
        one.kind.water == OnWater::wall)
      doubts.say(
          "sealed_ground",
          one.name() +
              " lets no water through the ground, and water.open_water_load takes the pressure "
              "that rises under it for a load on it, which does not weaken the soil: set open_water_load = false");
  }
  if (drained && has_seepage(scene)) doubt_open_ground(start, boundaries, doubts);
}

}  // namespace talus
