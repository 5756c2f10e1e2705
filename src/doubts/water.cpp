// Doubts about water beside the soil: open water that tables and boundaries make, and boundaries of the pore water.
#include <cmath>
#include <functional>

#include "base/rounded.h"
#include "doubts/doubts.h"
#include "physics/boundary/boundary.h"
#include "physics/boundary/pore_conditions.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/stage.h"
#include "scene/water_source.h"

namespace talus {
namespace {

/// A boundary of the scene as doubts look at it.
struct Watered {
  std::string name;
  Boundary kind;
  bool anywhere;  ///< on the free surface
};

/// Elevation at a corner of a face [m].
using Elevation = std::function<double(const SoilFace &, const std::array<double, 3> &)>;

/// What water.level adds to tables at most in the course of the stages [m]. An expression is asked for the start alone:
/// a value that its key does not admit would end the run, also one that never comes so far.
double highest_level(const Scene &scene) {
  const Function &level = scene.water->level;
  double highest = level(0);
  if (level.uses("t")) return highest;
  const double end = end_of_loads(scene);
  for (const double time : level.times())
    if (time <= end) highest = std::max(highest, level(time));
  return std::max(highest, level(end));
}

/// Faces of the soil on which water stands, by more than a film above something at all corners.
struct Flooded {
  double ground = 0;  ///< level area of all faces that count [m2]
  double wet = 0;     ///< that under water [m2]
  double slope = 0;   ///< greatest of the water at a face
  double depth = 0;   ///< greatest [m]
  Span x, surface;    ///< of the water [m]
  std::string text() const {
    return "up to " + rounded(depth) + " m above the ground from x = " + rounded(x.from) + " to " + rounded(x.to) +
           " m";
  }
};

Flooded flooded(const Start &start, const Elevation &water, const Elevation &below,
                const std::function<bool(const SoilFace &)> &counts) {
  const double film = visible * start.height();
  const int dimension = start.scene.dimension, up = start.up;
  Flooded found;
  for (const SoilFace &face : start.surface) {
    const auto depth = [&](const std::array<double, 3> &x) { return water(face, x) - below(face, x); };
    if (!counts(face)) continue;
    const double area = face.normal[up] > 0.1 ? face.area * face.normal[up] : 0;  // of no wall
    found.ground += area;
    if (std::any_of(face.corner.begin(), face.corner.begin() + dimension,
                    [&](const auto &x) { return !(depth(x) > film); }))
      continue;
    found.wet += area;
    for (int a = 0; a < dimension; ++a) {
      const auto &x = face.corner[a], &next = face.corner[(a + 1) % dimension];
      double way = 0;
      for (int d = 0; d < dimension; ++d) way = std::hypot(way, d == up ? 0 : next[d] - x[d]);
      if (area > 0) found.slope = std::max(found.slope, std::abs(water(face, next) - water(face, x)) / way);
      found.depth = std::max(found.depth, depth(x)), found.x.widen(x[0]), found.surface.widen(water(face, x));
    }
  }
  return found;
}

/// Water that stays rests on the ground with its weight by its table, so that a table above the ground has to be level
/// there. The table of one soil gives pore pressure and no open water.
void doubt_tables(const Start &start, Doubts &doubts) {
  constexpr double level_water = 0.01;  // of which slope
  const Scene &scene = start.scene;
  const WaterTable &table = scene.water->table;
  const double level = highest_level(scene);
  const auto stands = [level](const WaterTable &of) {
    return [&of, level](const SoilFace &, const std::array<double, 3> &x) { return of.at(x[0], x[1], x[2]) + level; };
  };
  const Elevation open = [&](const SoilFace &face, const auto &x) {
    return table.given() ? std::max(x[start.up], stands(table)(face, x)) : x[start.up];
  };
  const Elevation ground = [&](const SoilFace &, const auto &x) { return x[start.up]; };
  const Flooded pond =
      flooded(start, open, ground, [&](const SoilFace &face) { return may_be_flooded(face, start.up); });
  doubts.say({{"open_water", pond.wet > visible * pond.ground && pond.slope > level_water,
               "water.table stands " + pond.text() + " and is not level there, at " + rounded(pond.surface.from) +
                   " to " + rounded(pond.surface.to) +
                   " m, as open water is, whose weight loads the ground. Cut it at the ground; open_water_load = false "
                   "says that it is a head"}});
  for (std::size_t b = 0; b < scene.body.size(); ++b) {
    if (!scene.body[b].water_table.given()) continue;
    // a steep face that a seam ends at is no ground: the water leaves it there, or a crack has its pressure
    const Flooded over = flooded(start, stands(scene.body[b].water_table), open, [&](const SoilFace &face) {
      return face.body == static_cast<int>(b) && !face.conditioned && face.normal[start.up] > 0.1;
    });
    doubts.say({{"open_water", over.wet > visible * over.ground,
                 "body." + scene.body[b].name + ".water_table stands " + over.text() +
                     " and its open water: nothing bears against its pressure, which lifts the soil. Cut it at the "
                     "ground, or say by open_water_load = false that it is a head"}});
  }
}

/// Water that moves meets the air at the surface of the soil, unless a boundary puts water there. Upright faces alone,
/// such as those of a wet column about to be set free, are none on which a table would stand.
void doubt_dry_ponds(const Start &start, const std::vector<Watered> &boundaries, Doubts &doubts) {
  const Scene &scene = start.scene;
  const WaterTable &table = scene.water->table;
  const int up = start.up;
  const double weight = scene.gravity.empty() ? 0 : -scene.gravity[up] * scene.water->density,
               level = scene.water->level(0);
  if (!table.given() || !(weight > 0)) return;
  const auto elsewhere = std::ranges::find_if(boundaries, &Watered::anywhere);
  const Elevation open = [&](const SoilFace &face, const auto &x) {
    const auto on = face.water >= 0 ? boundaries.begin() + face.water : elsewhere;
    if (on == boundaries.end() || !on->kind.open_water) return x[up];
    return x[up] + std::max(0., on->kind.outside(x[0], x[1], x[2], 0, {weight, x[up]})) / weight;
  };
  const Flooded dry = flooded(
      start, [&](const SoilFace &, const auto &x) { return table.at(x[0], x[1], x[2]) + level; }, open,
      [&](const SoilFace &face) { return may_be_flooded(face, up); });
  doubts.say({{"dry_pond", dry.wet > visible * dry.ground,
               "water.table stands " + dry.text() +
                   ", and no boundary puts water of this level on the ground there: where pore water moves, the table "
                   "is that of the pores at the start. Open water is a boundary with kind = \"head\" and level = " +
                   rounded(dry.surface.to) + " m"}});
}

/// What a boundary brings to the faces that it is on; of what changes, at the start.
void doubt_boundary(const Start &start, std::size_t b, const Watered &one, Doubts &doubts) {
  constexpr double vertical = 1e-6;  // of a normal, to round-off
  const Scene &scene = start.scene;
  const Boundary &kind = one.kind;
  const Faces faces = start.faces(
      [&](const SoilFace &face) { return face.water == static_cast<int>(b) || (one.anywhere && face.water < 0); });
  const double g = scene.gravity.empty() ? 0 : -scene.gravity[start.up];
  double pressure = 0, upward = 0;  // largest
  bool begins_soil = false;
  for (const SoilFace *face : faces.of) {
    double facing = 0;
    for (int d = 0; d < scene.dimension; ++d) facing += face->normal[d] * scene.upward()[d];
    upward = std::max(upward, facing), begins_soil = begins_soil || !face->ends_mesh;
    for (int a = 0; a < scene.dimension && kind.open_water; ++a) {
      const auto &[x, y, z] = face->corner[a];
      pressure = std::max(pressure, kind.outside(x, y, z, 0, {scene.water->density * g, face->corner[a][start.up]}));
    }
  }
  const bool seeps = kind.water == OnWater::seepage && !faces.of.empty(), rain = kind.supply && !kind.open_water;
  doubts.say(
      {{"dry_boundary", seeps && kind.open_water && kind.changes.empty() && !(pressure > 0),
        one.name + " has its water below all of its faces, where water may only leave"},
       {"dry_boundary", seeps && rain && upward < vertical,
        one.name + " lies on faces that are vertical or overhang, and rain counts per level area: none enters"},
       {"faces_left", kind.fluid_face() && !one.anywhere && begins_soil && has_flow_in_motion(scene),
        one.name + " decides on the water at faces where the soil begins: soil that moves away from them has the "
                   "atmosphere there instead. The group free_surface follows the soil"},
       // pressure rises under ground that lets no water out, where none stands that would bear against it
       {"sealed_ground",
        scene.phases == PhaseModel::drained && scene.water->open_water_load && has_seepage(scene) && one.anywhere &&
            kind.water == OnWater::wall,
        one.name + " lets no water through the ground, and water.open_water_load takes the pressure that rises under "
                   "it for a load on it, which does not weaken the soil: set open_water_load = false"}});
  double from = 0;  // load time [s]
  for (const Stage &stage : scene.stage) {
    const double to = from + (stage.hold_loads ? 0 : stage.duration);
    const bool changes = std::ranges::any_of(
        kind.changes, [&](const TimeSpan &span) { return std::max(span.begin, from) < std::min(span.end, to); });
    doubts.say({{"undrained_stage",
                 fluids_move(scene.phases) && kind.open_water && changes && stage.is_static() && !stage.water_flows(),
                 "the water of " + one.name + " changes in stage " + stage.name +
                     ", in which no pore water moves: it loads the soil, whose pore pressure stays, and a slope seems "
                     "too safe. kind = \"consolidation\" lets both follow"}});
    from = to;
  }
}

/// Pores that cannot dry have no suction with which to hold back what an open surface offers: where no boundary of
/// water is on it, its pressure is zero, as under a film of water.
void doubt_film(const Start &start, const std::vector<Watered> &boundaries, Doubts &doubts) {
  constexpr double share = 0.05;  // of the ground
  const Scene &scene = start.scene;
  const WaterTable &table = scene.water->table;
  const bool seeps = scene.phases == PhaseModel::drained && has_seepage(scene),
             moves = scene.phases == PhaseModel::saturated && has_flow_in_motion(scene) && table.given();
  const auto dries = [](const BodySource &body) { return static_cast<bool>(body.retention.reader); };
  const auto covers = [](const Watered &one) { return one.anywhere && one.kind.fluids_only(); };
  if ((!seeps && !moves) || std::ranges::any_of(scene.body, dries) || std::ranges::any_of(boundaries, covers)) return;
  const auto above = [&](const std::array<double, 3> &x) {  // water enters above the table
    return !table.given() ||
           x[start.up] - table.at(x[0], x[1], x[2]) - scene.water->level(0) > visible * start.height();
  };
  const auto ground = [&](const SoilFace &face) {
    return may_be_flooded(face, start.up) && face.normal[start.up] > 0.1 && (seeps || !face.ends_mesh);
  };
  const Faces bare = start.faces([&](const SoilFace &face) {
    return ground(face) && face.water < 0 &&
           std::all_of(face.corner.begin(), face.corner.begin() + scene.dimension, above);
  });
  const double all = start.faces(ground).area;
  doubts.say({{"film", bare.area > share * all,
               rounded(100 * bare.area / all) + " % of the ground, " + bare.where[0].text(0) + ", " +
                   bare.where[start.up].text(start.up) +
                   ", has no boundary of water, so that its pressure is 0: soil that cannot dry drinks there as under "
                   "a film of water. Dry ground has kind = \"rainfall\" and intensity = 0 on group = "
                   "\"free_surface\", or a retention curve"}});
}

}  // namespace

void doubt_water(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  std::vector<Watered> boundaries;
  for (const BoundarySource &source : scene.boundary)
    boundaries.push_back({"boundary." + source.name, read_boundary(source.kind),
                          std::ranges::count(source.group, std::string(free_surface)) > 0});
  for (std::size_t b = 0; b < boundaries.size(); ++b) doubt_boundary(start, b, boundaries[b], doubts);
  doubt_film(start, boundaries, doubts);
  if (fluids_move(scene.phases)) return doubt_dry_ponds(start, boundaries, doubts);
  if (scene.phases == PhaseModel::drained && scene.water->open_water_load && !scene.stage.front().seeps())
    doubt_tables(start, doubts);  // else seepage finds the water that counts
}

}  // namespace talus
