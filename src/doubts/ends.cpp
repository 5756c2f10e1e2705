// Doubts about ends of the soil: with the mesh, and over free space.
#include <cmath>
#include <map>

#include "base/rounded.h"
#include "doubts/doubts.h"
#include "scene/mesh_source.h"
#include "scene/stage.h"

namespace talus {
namespace {

/// The soil is cut off where it ends with the mesh, and goes on in nature: a free side there may fail first, and in
/// motion soil leaves the mesh, which ends the run unless the scene lets particles go. Without a support below, it
/// hangs on its sides.
void doubt_sides(const Start &start, Doubts &doubts) {
  constexpr double thin = 0.1;  // of the height of the soil: a layer that comes to light there decides little
  const Scene &scene = start.scene;
  const auto matters = [&](const Stage &stage) {
    return !stage.is_static() ? stage.stop().settles || scene.mesh->leaving_particles == WhenOutside::stop
                              : stage.soil_moves();
  };
  const bool rests = std::ranges::any_of(scene.stage, [](const Stage &stage) { return stage.soil_moves(); }),
             ends = std::ranges::any_of(scene.stage, matters);
  for (int d = 0; d < scene.dimension; ++d)
    for (const double sign : {-1., 1.}) {
      const bool below = d == start.up;
      if (below ? sign > 0 || !rests : !ends) continue;
      const double end = sign < 0 ? start.low[d] : start.high[d], near = 1e-6 * start.extent(d);
      const auto side = [&](const SoilFace &face) {
        const auto beside = [&](int a) { return std::abs(face.corner[a][d] - end) > near; };
        return face.ends_mesh &&
               (below ? face.normal[d] < -0.3 : sign * face.normal[d] >= 0.9 && !beside(0) && !beside(1));
      };
      const Faces all = start.faces(side), free = start.faces([&](const SoilFace &face) {
        return side(face) && !(below ? face.held : face.bounded);
      });
      const Span &span = free.where[below ? 0 : start.up];
      doubts.say(
          {{"free_side", 2 * free.area > all.area && (below || span.to - span.from >= thin * start.height()),
            "the soil ends with the mesh at " + free.where[d].text(d) + ", and no " +
                (below ? "support" : "boundary of the soil") + " names its face there, " +
                span.text(below ? 0 : start.up) + ": it may " + (below ? "fall out" : "fail or leave the mesh") +
                ". Give it kind = \"roller\" or \"fixed\"" + (below ? "" : ", or a traction of 0 where it is free")}});
    }
}

/// Soil over free space: mostly a region of the section that no body fills. A surface that cells follow is ragged, and
/// its roofs have other faces beside them.
void doubt_voids(const Start &start, Doubts &doubts) {
  constexpr double level = 0.5;        // of the normal along the vertical: a steeper face is a wall
  constexpr double negligible = 0.01;  // of the area of the soil from above
  const int dimension = start.scene.dimension;
  const auto roof = [&](const SoilFace &face) {
    return face.normal[start.up] < -level && !face.ends_mesh && !face.conditioned;
  };
  std::map<std::array<double, 3>, bool> among_roofs;  // of a corner: are all faces roofs that meet there?
  for (const SoilFace &face : start.surface)
    for (int a = 0; a < dimension; ++a) {
      bool &all = among_roofs.try_emplace(face.corner[a], true).first->second;
      all = all && roof(face);
    }
  const Faces over = start.faces([&](const SoilFace &face) {
    return roof(face) && std::all_of(face.corner.begin(), face.corner.begin() + dimension,
                                     [&](const auto &corner) { return among_roofs.at(corner); });
  });
  std::string place;
  for (int d = 0; d < dimension; ++d) place += (d ? ", " : "") + over.where[d].text(d);
  const double above = start.faces([&](const SoilFace &face) { return face.normal[start.up] > level; }).area;
  doubts.say({{"void", over.area > negligible * above,
               "the soil hangs over free space: nothing is below its faces at " + place +
                   ", so that it falls or bends down as a roof; does a region there belong to no body (key region)?"}});
}

}  // namespace

void doubt_ends(const Start &start, Doubts &doubts) {
  doubt_sides(start, doubts);
  doubt_voids(start, doubts);
}

}  // namespace talus
