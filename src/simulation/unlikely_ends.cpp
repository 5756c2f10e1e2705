// Doubts about ends of the mesh and of the soil.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/rounded.h"
#include "base/units.h"
#include "physics/boundary/boundary.h"
#include "simulation/failure.h"
#include "simulation/unlikely_parts.h"

namespace talus {
namespace {

/// A range of coordinates along an axis.
struct Span {
  double from = std::numeric_limits<double>::infinity(), to = -from;
  void widen(double x) { from = std::min(from, x), to = std::max(to, x); }
  std::string text() const { return rounded(from) + (to > from ? " to " + rounded(to) : "") + " m"; }
};

/// Where equilibrium is asked for, soil that ends with the mesh is mostly cut off there and goes on in nature. In
/// motion it leaves the mesh there, which ends the run unless the scene lets particles go.
void doubt_sides(const Scene &scene, const Extent &soil, int up, const std::vector<SoilFace> &surface,
                 std::vector<std::string> &sentences) {
  constexpr double thin = 0.1;  // of the height of the soil: a layer that comes to light there decides little
  const auto asks = [](const Stage &stage) {
    return stage.kind == StageKind::quasi_static || stage.kind == StageKind::consolidation ||
           (stage.kind == StageKind::dynamic && stage.until == StopWhen::equilibrium);
  };
  const bool stops = scene.mesh.leaving_particles == WhenOutside::stop;
  const auto ends = [&](const Stage &stage) { return asks(stage) || (stops && stage.kind == StageKind::dynamic); };
  if (std::none_of(scene.stage.begin(), scene.stage.end(), ends)) return;
  for (int d = 0; d < scene.dimension; ++d)
    for (const double sign : {-1., 1.}) {
      if (d == up) continue;
      const double end = sign < 0 ? soil.low[d] : soil.high[d], near = 1e-6 * soil.of(d);
      double all = 0, free = 0;
      Span span;
      bool wet = false;
      for (const SoilFace &face : surface) {
        const auto beside = [&](int a) { return std::abs(face.corner[a][d] - end) > near; };
        if (!face.ends_mesh || sign * face.normal[d] < 0.9 || beside(0) || beside(1)) continue;
        all += face.area;
        if (face.bounded) continue;
        free += face.area, wet |= face.water >= 0;
        for (int a = 0; a < scene.dimension; ++a) span.widen(face.corner[a][up]);
      }
      if (2 * free <= all || span.to - span.from < thin * soil.of(up)) continue;
      const std::string zero = scene.dimension == 2 ? "[0, 0]" : "[0, 0, 0]";
      sentences.push_back(std::string("The soil ends with the mesh at ") + axis_names[d] + " = " + rounded(end) +
                          " m, and " + (wet ? "only a boundary of the water in its pores" : "no boundary") +
                          " names its face there, " + axis_names[up] + " = " + span.text() +
                          ": it is free to move outwards, as no soil that goes on there would be, and may fail first" +
                          (stops ? " or leave the mesh" : "") +
                          ". Give it kind = \"roller\" or \"fixed\"; kind = \"traction\" with traction = " + zero +
                          " says that it is a free face");
    }
}

/// Soil whose lowest faces end with the mesh and have no support hangs on its sides, or falls out of the mesh.
void doubt_base(const Scene &scene, const Extent &soil, int up, const std::vector<SoilFace> &surface,
                std::vector<std::string> &sentences) {
  const auto moves = [](const Stage &stage) { return stage.kind != StageKind::seepage; };
  if (std::none_of(scene.stage.begin(), scene.stage.end(), moves)) return;
  constexpr int strips = 64;  // per level axis: a face is one of the lowest where none in its strip lies deeper
  const int across = 0, along = scene.dimension == 2 ? across : 3 - up;
  const auto strip = [&](int axis, double x) {
    return std::clamp(static_cast<int>((x - soil.low[axis]) / soil.of(axis) * strips), 0, strips - 1);
  };
  const auto bounds = [&](const SoilFace &face, int axis) {
    Span span;
    for (int a = 0; a < scene.dimension; ++a) span.widen(face.corner[a][axis]);
    return span;
  };
  const auto depth = [&](const SoilFace &face) {
    const Span span = bounds(face, up);
    return -span.from;
  };
  const auto faces_down = [&](const SoilFace &face) { return face.normal[up] < -0.3; };
  std::vector<double> deepest(strips * strips, -std::numeric_limits<double>::infinity());
  for (const SoilFace &face : surface) {
    const Span x = bounds(face, across), z = bounds(face, along);
    for (int i = strip(across, x.from); faces_down(face) && i <= strip(across, x.to); ++i)
      for (int k = strip(along, z.from); k <= strip(along, z.to); ++k)
        deepest[i * strips + k] = std::max(deepest[i * strips + k], depth(face));
  }
  double all = 0, free = 0;
  Span where, elevation;
  for (const SoilFace &face : surface) {
    if (!faces_down(face)) continue;
    const Span x = bounds(face, across), z = bounds(face, along), y = bounds(face, up);
    const double deep = deepest[strip(across, (x.from + x.to) / 2) * strips + strip(along, (z.from + z.to) / 2)];
    if (depth(face) < deep - (y.to - y.from) - std::max(soil.of(across), soil.of(along)) / strips) continue;
    const double area = -face.area * face.normal[up];
    all += area;
    if (face.held || !face.ends_mesh) continue;
    free += area;
    where.widen(x.from), where.widen(x.to), elevation.widen(y.from), elevation.widen(y.to);
  }
  if (2 * free <= all) return;
  sentences.push_back(std::string("Nothing holds the soil from below: its lowest faces, ") + axis_names[across] +
                      " = " + where.text() + " at " + axis_names[up] + " = " + elevation.text() +
                      ", end with the mesh, and no boundary with a support names them, so that the soil hangs on its "
                      "sides or falls out of the mesh. Give them kind = \"fixed\" or \"roller\"");
}

/// Groups of these faces that hang together by common corners.
std::vector<std::vector<const SoilFace *>> connected(const std::vector<const SoilFace *> &faces, int corners) {
  std::map<std::array<double, 3>, std::vector<std::size_t>> beside;  // of a corner: the faces that meet there
  for (std::size_t k = 0; k < faces.size(); ++k)
    for (int a = 0; a < corners; ++a) beside[faces[k]->corner[a]].push_back(k);
  std::vector<char> seen(faces.size());
  std::vector<std::vector<const SoilFace *>> groups;
  for (std::size_t first = 0; first < faces.size(); ++first) {
    if (seen[first]) continue;
    std::vector<std::size_t> reached{first};
    seen[first] = 1;
    for (std::size_t next = 0; next < reached.size(); ++next)  // grows on the way
      for (int a = 0; a < corners; ++a)
        for (const std::size_t other : beside[faces[reached[next]]->corner[a]])
          if (!seen[other]) seen[other] = 1, reached.push_back(other);
    std::vector<const SoilFace *> &group = groups.emplace_back();
    for (const std::size_t k : reached) group.push_back(faces[k]);
  }
  return groups;
}

/// Soil over free space: mostly a region of the section that no body fills.
void doubt_voids(const Scene &scene, int up, const std::vector<SoilFace> &surface,
                 std::vector<std::string> &sentences) {
  constexpr double level = 0.5;  // of the normal along the vertical: a steeper face is a wall
  // Fewer faces are the raggedness of a surface that cells follow: three edges, or triangles over as much both ways.
  const std::size_t few = scene.dimension == 3 ? 12 : 3;
  constexpr double negligible = 0.01;  // of the area of the soil from above
  std::vector<const SoilFace *> roofs;
  double above = 0;
  for (const SoilFace &face : surface) {
    above += std::max(0., face.area * face.normal[up]);
    if (face.normal[up] < -level && !face.ends_mesh && !face.conditioned) roofs.push_back(&face);
  }
  for (const auto &group : connected(roofs, scene.dimension)) {
    double area = 0;
    std::array<Span, 3> span;
    for (const SoilFace *face : group) {
      area -= face->area * face->normal[up];
      for (int a = 0; a < scene.dimension; ++a)
        for (int d = 0; d < scene.dimension; ++d) span[d].widen(face->corner[a][d]);
    }
    if (group.size() < few || area < negligible * above) continue;
    std::string place;
    for (int d = 0; d < scene.dimension; ++d)
      if (d != up) place += (place.empty() ? "" : ", ") + std::string(1, axis_names[d]) + " = " + span[d].text();
    sentences.push_back("The soil hangs over free space: nothing is below its faces at " + place + ", " +
                        axis_names[up] + " = " + span[up].text() +
                        ", so that it falls, or bends down as a roof. Does a region there belong to no body (key "
                        "region)? Soil that is meant to fall may stay so");
  }
}

}  // namespace

void doubt_ends(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                std::vector<std::string> &sentences) {
  doubt_sides(scene, soil, scene.vertical(), surface, sentences);
  doubt_base(scene, soil, scene.vertical(), surface, sentences);
  doubt_voids(scene, scene.vertical(), surface, sentences);
}

}  // namespace talus
