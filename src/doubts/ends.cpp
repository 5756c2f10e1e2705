// Doubts about ends of the mesh and of the soil.
#include <cmath>
#include <limits>
#include <map>

#include "base/rounded.h"
#include "doubts/doubts.h"
#include "scene/mesh_source.h"
#include "scene/scene.h"
#include "scene/stage.h"

namespace talus {
namespace {

/// The soil is cut off where it ends with the mesh, and goes on in nature: a free face there may fail first, and in
/// motion soil leaves the mesh, which ends the run unless the scene lets particles go.
void doubt_sides(const Start &start, Doubts &doubts) {
  constexpr double thin = 0.1;  // of the height of the soil: a layer that comes to light there decides little
  const Scene &scene = start.scene;
  const auto matters = [&](const Stage &stage) {
    return !stage.is_static() ? stage.stop().settles || scene.mesh->leaving_particles == WhenOutside::stop
                              : stage.soil_moves();
  };
  if (std::ranges::none_of(scene.stage, matters)) return;
  for (int d = 0; d < scene.dimension; ++d)
    for (const double sign : {-1., 1.}) {
      if (d == start.up) continue;
      const double end = sign < 0 ? start.low[d] : start.high[d], near = 1e-6 * start.extent(d);
      double all = 0, free = 0;
      Span span;
      for (const SoilFace &face : start.surface) {
        const auto beside = [&](int a) { return std::abs(face.corner[a][d] - end) > near; };
        if (!face.ends_mesh || sign * face.normal[d] < 0.9 || beside(0) || beside(1)) continue;
        all += face.area;
        if (face.bounded) continue;
        free += face.area;
        for (int a = 0; a < scene.dimension; ++a) span.widen(face.corner[a][start.up]);
      }
      if (2 * free <= all || span.to - span.from < thin * start.height()) continue;
      doubts.say("free_side", std::string("the soil ends with the mesh at ") + axis_names[d] + " = " + rounded(end) +
                                  " m, and no boundary of the soil names its face there, " + span.text(start.up) +
                                  ": it may fail or leave the mesh there. Give it kind = \"roller\" or \"fixed\", or a "
                                  "traction of 0 where it is free");
    }
}

/// Soil whose lowest faces end with the mesh and have no support hangs on its sides, or falls out of the mesh.
void doubt_base(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  if (std::ranges::all_of(scene.stage, [](const Stage &stage) { return !stage.soil_moves(); })) return;
  constexpr int strips = 64;  // per level axis: a face is one of the lowest where none in its strip lies deeper
  const int up = start.up, across = 0, along = scene.dimension == 2 ? across : 3 - up;
  const double coarse = std::max(start.extent(across), start.extent(along)) / strips;
  const auto strip = [&](int axis, double x) {
    return std::clamp(static_cast<int>((x - start.low[axis]) / start.extent(axis) * strips), 0, strips - 1);
  };
  const auto bounds = [&](const SoilFace &face, int axis) {
    Span span;
    for (int a = 0; a < scene.dimension; ++a) span.widen(face.corner[a][axis]);
    return span;
  };
  std::vector<double> lowest(strips * strips, std::numeric_limits<double>::infinity());
  double all = 0, free = 0;
  Span where, elevation;
  for (const bool counts : {false, true})
    for (const SoilFace &face : start.surface) {
      if (face.normal[up] >= -0.3) continue;
      const Span x = bounds(face, across), z = bounds(face, along), y = bounds(face, up);
      for (int i = strip(across, x.from); !counts && i <= strip(across, x.to); ++i)
        for (int k = strip(along, z.from); k <= strip(along, z.to); ++k)
          lowest[i * strips + k] = std::min(lowest[i * strips + k], y.from);
      const double low = lowest[strip(across, (x.from + x.to) / 2) * strips + strip(along, (z.from + z.to) / 2)];
      if (!counts || y.from > low + (y.to - y.from) + coarse) continue;
      const double area = -face.area * face.normal[up];
      all += area;
      if (face.held || !face.ends_mesh) continue;
      free += area;
      where.widen(x.from), where.widen(x.to), elevation.widen(y.from), elevation.widen(y.to);
    }
  if (2 * free > all)
    doubts.say("free_base", "nothing holds the soil from below: no boundary with a support names its lowest faces, " +
                                where.text(across) + " at " + elevation.text(up) +
                                ", which end with the mesh; it falls out or hangs on its sides");
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
void doubt_voids(const Start &start, Doubts &doubts) {
  constexpr double level = 0.5;  // of the normal along the vertical: a steeper face is a wall
  const int dimension = start.scene.dimension, up = start.up;
  // Fewer faces are the raggedness of a surface that cells follow: three edges, or triangles over as much both ways.
  const std::size_t few = dimension == 3 ? 12 : 3;
  constexpr double negligible = 0.01;  // of the area of the soil from above
  std::vector<const SoilFace *> roofs;
  double above = 0;
  for (const SoilFace &face : start.surface) {
    above += std::max(0., face.area * face.normal[up]);
    if (face.normal[up] < -level && !face.ends_mesh && !face.conditioned) roofs.push_back(&face);
  }
  for (const auto &group : connected(roofs, dimension)) {
    double area = 0;
    std::array<Span, 3> span;
    for (const SoilFace *face : group) {
      area -= face->area * face->normal[up];
      for (int a = 0; a < dimension; ++a)
        for (int d = 0; d < dimension; ++d) span[d].widen(face->corner[a][d]);
    }
    if (group.size() < few || area < negligible * above) continue;
    std::string place;
    for (int d = 0; d < dimension; ++d) place += (d ? ", " : "") + span[d].text(d);
    doubts.say("void",
               "the soil hangs over free space: nothing is below its faces at " + place +
                   ", so that it falls or bends down as a roof; does a region there belong to no body (key region)?");
  }
}

}  // namespace

void doubt_ends(const Start &start, Doubts &doubts) {
  doubt_sides(start, doubts);
  doubt_base(start, doubts);
  doubt_voids(start, doubts);
}

}  // namespace talus
