// Doubts about boundaries of the water in the pores: where they are, what they bring and when.
#include <cmath>

#include "base/rounded.h"
#include "physics/boundary/boundary.h"
#include "physics/boundary/pore_conditions.h"
#include "physics/phase_models.h"
#include "simulation/unlikely_parts.h"

namespace talus {
namespace {

/// Faces of a boundary belong to the mesh. Soil that settles or slides away from them leaves the boundary without soil.
void doubt_faces_of_water(const Scene &scene, const std::vector<SoilFace> &surface,
                          std::vector<std::string> &sentences) {
  if (!phase_traits(scene.phases).liquid ||
      std::ranges::none_of(scene.stage, [](const Stage &s) { return !is_static(s.kind) && s.pore_flow; }))
    return;
  for (int b = 0; b < static_cast<int>(scene.boundary.size()); ++b) {
    const BoundarySource &boundary = scene.boundary[b];
    if (!read_boundary(boundary.kind).fluid_face() || std::ranges::count(boundary.group, std::string(free_surface)))
      continue;
    if (std::ranges::any_of(surface, [b](const SoilFace &face) { return face.water == b && !face.ends_mesh; }))
      sentences.push_back("boundary." + boundary.name +
                          " decides on the water at faces where the soil begins, and these stay where they are: soil "
                          "that settles or slides from them by a third of a cell has the atmosphere there instead. A "
                          "boundary on the group free_surface follows the soil");
  }
}

/// Open water that stands on none of its faces, and rain that reaches none. What changes is asked for the start alone,
/// as water.level is (levels_of).
void doubt_levels_and_rain(const Scene &scene, const std::vector<SoilFace> &surface,
                           std::vector<std::string> &sentences) {
  constexpr double vertical = 1e-6;  // of a normal, to round-off
  const int up = scene.vertical();
  const double g = scene.gravity.empty() ? 0 : -scene.gravity[up];
  for (std::size_t b = 0; b < scene.boundary.size(); ++b) {
    const Boundary kind = read_boundary(scene.boundary[b].kind);
    const bool anywhere = std::ranges::count(scene.boundary[b].group, std::string(free_surface));
    if (kind.water != OnWater::seepage) continue;
    double pressure = 0, rain = 0, upward = 0;
    bool touched = false;
    for (const SoilFace &face : surface) {
      if (!(face.water == static_cast<int>(b) || (anywhere && face.water < 0))) continue;
      touched = true;
      double facing = 0;
      const auto &x = face.corner[0];
      for (int a = 0; a < scene.dimension && kind.open_water; ++a) {
        const auto &corner = face.corner[a];
        pressure =
            std::max(pressure, kind.outside(corner[0], corner[1], corner[2], 0, {scene.water.density * g, corner[up]}));
      }
      for (int d = 0; d < scene.dimension; ++d) facing += face.normal[d] * scene.upward()[d];
      upward = std::max(upward, facing);
      if (kind.supply) rain = std::max(rain, kind.supply(x[0], x[1], x[2], 0, 1));
    }
    if (touched && kind.open_water && kind.changes.empty() && !(pressure > 0))
      sentences.push_back("boundary." + scene.boundary[b].name +
                          " has its water below all of its faces, so that none stands on them and water "
                          "may only leave there. Is its level meant?");
    if (!touched && kind.supply && !kind.open_water)
      sentences.push_back("boundary." + scene.boundary[b].name +
                          " touches no soil at the start, so that no water enters there. Is group = \"free_surface\" "
                          "meant, or a group of the ground?");
    if (rain > 0 && upward < vertical)
      sentences.push_back("boundary." + scene.boundary[b].name +
                          " lies on faces that are vertical or overhang, and rain counts per level area: none enters "
                          "there. What wets a wall is a \"flux\" or a \"head\"");
  }
}

/// Rain and fluxes whose table is over before the stages are, and not with zero; asked at a face of theirs.
void doubt_water_that_goes_on(const Scene &scene, const std::vector<SoilFace> &surface,
                              std::vector<std::string> &sentences) {
  double end = 0;  // of the load time [s]
  for (const Stage &stage : scene.stage)
    if (!stage.hold_loads) end += stage.duration;
  for (std::size_t b = 0; b < scene.boundary.size(); ++b) {
    const Boundary kind = read_boundary(scene.boundary[b].kind);
    if (kind.changes.empty() || !(kind.supply || kind.inflow)) continue;
    const double last = std::ranges::max_element(kind.changes, {}, &TimeSpan::end)->end;
    const bool anywhere = std::ranges::count(scene.boundary[b].group, std::string(free_surface));
    const auto face = std::ranges::find_if(
        surface, [&](const SoilFace &one) { return one.water == static_cast<int>(b) || (anywhere && one.water < 0); });
    if (!(last < end) || face == surface.end()) continue;
    const auto &[x, y, z] = face->corner[0];
    const double rate = kind.supply ? kind.supply(x, y, z, last, 1) : kind.inflow(x, y, z, last);
    if (rate != 0)
      sentences.push_back("boundary." + scene.boundary[b].name + " goes on with " + rounded(rate) +
                          " m/s when its table is over, from t = " + rounded(last) + " s until the stages end at t = " +
                          rounded(end) + " s. End the table with 0 if the water is to stop there");
  }
}

/// Open water that rises or falls in a stage of elements whose pore water stays: its load changes, and the pressure in
/// the pores does not.
void doubt_open_water_without_flow(const Scene &scene, double height, std::vector<std::string> &sentences) {
  constexpr double deep = -1e4;  // elevation below all levels that are asked [m]
  double from = 0;               // load time [s]
  for (const Stage &stage : scene.stage) {
    const double to = from + (stage.hold_loads ? 0 : stage.duration);
    for (std::size_t b = 0; b < scene.boundary.size() && is_static(stage.kind) && !water_flows(stage.kind); ++b) {
      const Boundary kind = read_boundary(scene.boundary[b].kind);
      if (!kind.open_water) continue;
      const auto level = [&](double t) { return kind.outside(0, 0, 0, t, {1, deep}) + deep; };
      if (std::abs(level(to) - level(from)) < visible * height) continue;
      sentences.push_back("the water of boundary." + scene.boundary[b].name + " goes from " + rounded(level(from)) +
                          " to " + rounded(level(to)) + " m in stage " + stage.name +
                          ", in which no pore water moves: it loads the soil, whose pore pressure stays as it is, so "
                          "that rising water makes a slope safer than it is. kind = \"consolidation\" lets both "
                          "follow; or let a stage with kind = \"seepage\" follow the water first, and hold_loads in "
                          "this one");
    }
    from = to;
  }
}

/// Pores that cannot dry have no suction with which to hold back what an open surface offers.
void doubt_open_ground(const Scene &scene, const std::vector<SoilFace> &surface, std::vector<std::string> &sentences) {
  const auto dries = [](const BodySource &body) { return static_cast<bool>(body.retention.reader); };
  if (first_seepage(scene) == scene.stage.end() || std::ranges::any_of(scene.body, dries)) return;
  for (const BoundarySource &boundary : scene.boundary)
    if (read_boundary(boundary.kind).fluids_only() && std::ranges::count(boundary.group, std::string(free_surface)))
      return;
  const int up = scene.vertical();
  const auto bare = std::ranges::find_if(surface, [&](const SoilFace &face) {
    return face.water < 0 && may_be_flooded(face, up) && face.normal[up] > 0.1;
  });
  if (bare == surface.end()) return;
  sentences.push_back("the ground at x = " + rounded(bare->corner[0][0]) + ", " + axis_names[up] + " = " +
                      rounded(bare->corner[0][up]) +
                      " m has no boundary of water, so that its pressure is 0 in stages of seepage: as under a film of "
                      "water, which enters without limit. Where the ground is dry, give group = \"free_surface\" a "
                      "boundary with kind = \"rainfall\" and intensity = 0, or the soil a retention curve");
}

/// Pressure rises under ground that lets no water out, where none stands that would bear against it.
void doubt_sealed_ground(const Scene &scene, std::vector<std::string> &sentences) {
  if (first_seepage(scene) == scene.stage.end()) return;
  for (const BoundarySource &boundary : scene.boundary)
    if (std::count(boundary.group.begin(), boundary.group.end(), free_surface) &&
        read_boundary(boundary.kind).water == OnWater::wall)
      sentences.push_back("boundary." + boundary.name +
                          " lets no water through the ground, so that pore pressure may rise there, and "
                          "water.open_water_load = true takes this pressure for the load of water on the ground: it "
                          "would not weaken the soil. Set water.open_water_load = false, or let water out with kind = "
                          "\"rainfall\" and intensity = 0");
}

}  // namespace

void doubt_water_boundaries(const Scene &scene, double height, const std::vector<SoilFace> &surface,
                            std::vector<std::string> &sentences) {
  const bool drained = scene.phases == PhaseModel::drained;
  doubt_levels_and_rain(scene, surface, sentences);
  doubt_water_that_goes_on(scene, surface, sentences);
  doubt_faces_of_water(scene, surface, sentences);
  if (phase_traits(scene.phases).liquid) doubt_open_water_without_flow(scene, height, sentences);
  if (drained) doubt_open_ground(scene, surface, sentences);
  if (drained && scene.water.open_water_load) doubt_sealed_ground(scene, sentences);
}

}  // namespace talus
