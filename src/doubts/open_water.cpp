// Doubts about open water that water tables and boundaries make.
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>

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

/// Elevations that water.level adds to tables in the course of the stages [m], among them those at the points of a
/// table and at the end of each stage. An expression is asked for the start alone: a value that its key does not admit
/// would end the run, also one that never comes so far.
std::vector<double> levels_of(const Scene &scene) {
  constexpr int intervals = 50;
  double end = 0;
  std::vector<double> times = scene.water->level.times();
  for (const Stage &stage : scene.stage)
    if (!stage.hold_loads) times.push_back(end += stage.duration);
  const Function &level = scene.water->level;
  std::vector<double> levels{level(0)};
  if (!level.depends_on_time() || level.uses("t")) return levels;
  for (int k = 1; k <= intervals; ++k) times.push_back(end * k / intervals);
  for (const double time : times)
    if (time > 0 && time <= end) levels.push_back(level(time));
  return levels;
}

/// Ground under water that hangs together.
struct Pond {
  double west, east;       ///< its ends [m]
  double lowest, highest;  ///< surface of the water [m]
  double depth;            ///< greatest [m]
  int corners = 1;         ///< of faces under it
  void widen(double x, double surface, double ground) {
    ++corners;
    west = std::min(west, x), east = std::max(east, x);
    lowest = std::min(lowest, surface), highest = std::max(highest, surface);
    depth = std::max(depth, surface - ground);
  }
};

/// The ponds that stand on the surface of the soil where water rises to `elevation`; less than `film` deep counts as
/// dry. In 3D the rim of thin soil on a slope is ragged, and what lies under water in the nooks of a few cells is none.
std::vector<Pond> ponds_of(const std::vector<SoilFace> &surface, int dimension, int up, double film,
                           const std::function<double(const std::array<double, 3> &)> &elevation) {
  std::map<std::array<double, 3>, int> number;  // of the corners under water
  std::vector<int> joined;                      // a corner of the same pond with a smaller number, or itself
  const auto first = [&](int corner) {
    while (joined[corner] != corner) corner = joined[corner] = joined[joined[corner]];
    return corner;
  };
  for (const SoilFace &face : surface) {
    int before = -1;
    for (int a = 0; a < dimension && may_be_flooded(face, up); ++a) {
      const auto &x = face.corner[a];
      if (elevation(x) - x[up] <= film) continue;
      const auto [entry, added] = number.try_emplace(x, static_cast<int>(joined.size()));
      if (added) joined.push_back(entry->second);
      if (before >= 0) joined[first(entry->second)] = first(before);
      before = entry->second;
    }
  }
  std::map<int, Pond> ponds;
  for (const auto &[x, corner] : number) {
    const double level = elevation(x);
    ponds.try_emplace(first(corner), Pond{x[0], x[0], level, level, 0, 0}).first->second.widen(x[0], level, x[up]);
  }
  constexpr int fewest = 12;  // corners
  std::vector<Pond> list;
  for (const auto &[corner, pond] : ponds)
    if (dimension == 2 || pond.corners > fewest) list.push_back(pond);
  return list;
}

std::string place_of(const Pond &pond) {
  return "up to " + rounded(pond.depth) + " m above the ground from x = " + rounded(pond.west) + " to " +
         rounded(pond.east) + " m";
}

/// Open water rests on the ground with its weight, so that a table above the ground has to be level there. In a plane
/// section a table that goes straight on over a hollow of the ground makes a pond there, which has no elevation of its
/// own; in 3D a valley is no hollow.
void doubt_ponds(const Start &start, const std::vector<double> &levels, Doubts &doubts) {
  const Scene &scene = start.scene;
  const WaterTable &table = scene.water->table;
  if (!table.given()) return;
  const double film = visible * start.height(), shore = visible * start.extent(0);
  std::optional<Pond> sloping, hollow;  // the deepest of each kind
  const auto take = [](std::optional<Pond> &deepest, const Pond &pond) {
    if (!deepest || pond.depth > deepest->depth) deepest = pond;
  };
  for (const double level : levels)
    for (const Pond &pond : ponds_of(start.surface, scene.dimension, start.up, film,
                                     [&](const auto &x) { return table_at(table, x) + level; })) {
      if (!table.level() && pond.highest - pond.lowest > film) take(sloping, pond);
      const bool meant = table.points.size() > 1 && std::ranges::any_of(table.points, [&](const auto &point) {
                           return point[0] >= pond.west - shore && point[0] <= pond.east + shore;
                         });
      if (scene.dimension == 2 && !table.points.empty() && !meant && pond.west > start.low[0] + shore &&
          pond.east < start.high[0] - shore)
        take(hollow, pond);
    }
  if (sloping)
    doubts.say(
        "open_water",
        "water.table stands " + place_of(*sloping) + " and is not level there, at " + rounded(sloping->lowest) +
            " to " + rounded(sloping->highest) +
            " m, as open water is, whose weight loads the ground. Cut it at the ground; open_water_load = false says "
            "that it is a head");
  if (hollow)
    doubts.say("pond",
               "water.table makes a pond " + place_of(*hollow) +
                   ", in a hollow where the table has no point: give it points at the shores, or below a dry bottom");
}

/// The water table of one soil gives pore pressure and no open water: above the free surface of this soil nothing
/// bears against it.
void doubt_own_tables(const Start &start, const std::vector<double> &levels, Doubts &doubts) {
  const Scene &scene = start.scene;
  for (std::size_t b = 0; b < scene.body.size(); ++b) {
    const WaterTable &own = scene.body[b].water_table;
    std::optional<Pond> over;
    for (const SoilFace &face : start.surface) {
      // a steep face that a seam ends at is no ground: the water leaves it there, or a crack has its pressure
      if (!own.given() || face.body != static_cast<int>(b) || face.conditioned || face.normal[start.up] <= 0.1)
        continue;
      for (int a = 0; a < scene.dimension; ++a)
        for (const double level : levels) {
          const auto &x = face.corner[a];
          const double head = table_at(own, x) + level, ground = x[start.up];
          const double open =
              scene.water->table.given() ? std::max(ground, table_at(scene.water->table, x) + level) : ground;
          if (head - open <= visible * start.height()) continue;
          if (!over) over = Pond{x[0], x[0], head, head, 0};
          over->widen(x[0], head, open);
        }
    }
    if (over)
      doubts.say("open_water", "body." + scene.body[b].name + ".water_table stands " + place_of(*over) +
                                   " and its open water: nothing bears against its pressure, which lifts the soil. Cut "
                                   "it at the ground, or say by "
                                   "open_water_load = false that it is a head");
  }
}

/// Surfaces of the water that boundaries put on faces of the soil at the start.
class OpenWater {
 public:
  explicit OpenWater(const Scene &scene) : scene_(scene), up_(scene.vertical()) {
    for (std::size_t b = 0; b < scene.boundary.size(); ++b) {
      boundary_.push_back(read_boundary(scene.boundary[b].kind));
      if (on_free_surface(scene.boundary[b])) elsewhere_ = static_cast<int>(b);
    }
  }
  /// The boundary that acts on faces without one of their own, -1: none.
  int elsewhere() const { return elsewhere_; }
  /// The boundary that puts water on a face, -1: none.
  int on(const SoilFace &face) const {
    if (face.water >= 0) return boundary_[face.water].open_water ? face.water : -1;
    return elsewhere_ >= 0 && boundary_[elsewhere_].open_water ? elsewhere_ : -1;
  }
  /// Elevation of the water at a place on the face, that of the place itself where it is dry [m].
  double at(const SoilFace &face, const std::array<double, 3> &x) const {
    const int boundary = on(face);
    if (boundary < 0) return x[up_];
    const double g = scene_.gravity.empty() ? 0 : -scene_.gravity[up_];
    const LiquidBeyond water{scene_.water->density * g, x[up_]};
    if (!(water.unit_weight > 0)) return x[up_];
    return x[up_] + std::max(0., boundary_[boundary].outside(x[0], x[1], x[2], 0, water)) / water.unit_weight;
  }

 private:
  const Scene &scene_;
  int up_, elsewhere_ = -1;
  std::vector<Boundary> boundary_;
};

/// Water that moves meets the air at the surface of the soil, unless a boundary puts water there: as deep as the table
/// stands above the ground, or the pores are not at rest with it. An upright face alone, such as that of a wet column
/// about to be set free, is none on which water would stand.
void doubt_dry_ponds(const Start &start, const OpenWater &open, double level, Doubts &doubts) {
  const Scene &scene = start.scene;
  const WaterTable &table = scene.water->table;
  const int up = start.up;
  const double film = visible * start.height(), narrow = visible * start.extent(0);
  const auto stands = [&](const std::array<double, 3> &x) {
    return table.given() ? table_at(table, x) + level : -std::numeric_limits<double>::infinity();
  };
  std::vector<SoilFace> bare;  // the table stands higher than the open water on them
  double most = film;
  std::array<double, 3> place{};
  int flooded = -1;  // the boundary whose water stands highest above the table
  for (const SoilFace &face : start.surface) {
    bool misses = false;
    for (int a = 0; a < scene.dimension && may_be_flooded(face, up); ++a) {
      const auto &x = face.corner[a];
      const double water = open.at(face, x), pores = std::max(stands(x), x[up]);
      misses |= pores - water > film;
      if (water - pores > most) most = water - pores, place = x, flooded = open.on(face);
    }
    if (misses) bare.push_back(face);
  }
  if (flooded >= 0)
    doubts.say("flooding", "boundary." + scene.boundary[flooded].name + " puts water on the ground that stands " +
                               rounded(most) + " m above " + (table.given() ? "ground and water.table" : "the ground") +
                               " at x = " + rounded(place[0]) + ", " + axis_names[up] + " = " + rounded(place[up]) +
                               " m: it enters at once. For pores at rest with it give water.table its level");
  const Pond *deepest = nullptr;
  const std::vector<Pond> ponds = ponds_of(bare, scene.dimension, up, film, stands);
  for (const Pond &pond : ponds)
    if (pond.east - pond.west > narrow && (!deepest || pond.depth > deepest->depth)) deepest = &pond;
  if (deepest)
    doubts.say("dry_pond", "water.table stands " + place_of(*deepest) +
                               ", and no boundary puts water of this level on "
                               "the ground there: where pore water moves, the table is that of the pores at the start. "
                               "Open water is a boundary with "
                               "kind = \"head\" and level = " +
                               rounded(deepest->highest) + " m");
}

/// Saturated soil has no air: where no boundary of water is on its surface, the pressure there is zero, as under a film
/// of water, and above the water table water enters.
void doubt_film_on_ground(const Start &start, const OpenWater &open, double level, Doubts &doubts) {
  constexpr double share = 0.05;  // of the ground
  const Scene &scene = start.scene;
  const WaterTable &table = scene.water->table;
  if (scene.phases != PhaseModel::saturated || !table.given() || open.elsewhere() >= 0) return;
  if (std::ranges::none_of(scene.stage, [](const Stage &s) { return !s.is_static() && s.pore_flow; })) return;
  double all = 0, dry = 0, most = 0;
  for (const SoilFace &face : start.surface) {
    if (!may_be_flooded(face, start.up) || face.ends_mesh) continue;
    all += face.area;
    double above = std::numeric_limits<double>::infinity();  // the table, of the lowest corner
    for (int a = 0; a < scene.dimension; ++a)
      above = std::min(above, face.corner[a][start.up] - table_at(table, face.corner[a]) - level);
    if (face.water < 0 && above > visible * start.height()) dry += face.area, most = std::max(most, above);
  }
  if (dry > share * all)
    doubts.say(
        "film",
        rounded(100 * dry / all) + " % of the free surface lies above water.table, by up to " + rounded(most) +
            " m, and no boundary of pore water is there: saturated soil drinks as under a film of water. Name it with "
            "kind = \"impermeable\", or take phases = \"unsaturated\"");
}

}  // namespace

void doubt_open_water(const Start &start, Doubts &doubts) {
  const Scene &scene = start.scene;
  const std::vector<double> levels = levels_of(scene);
  if (phase_traits(scene.phases).liquid) {
    const OpenWater open(scene);
    doubt_dry_ponds(start, open, levels.front(), doubts);
    doubt_film_on_ground(start, open, levels.front(), doubts);
  }
  if (scene.phases != PhaseModel::drained || !scene.water->open_water_load) return;
  if (scene.stage.front().seeps()) return;  // which finds the water that counts
  doubt_ponds(start, levels, doubts);
  doubt_own_tables(start, levels, doubts);
}

}  // namespace talus
