// Doubts about water tables and the open water that they make.
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "base/rounded.h"
#include "physics/boundary/boundary.h"
#include "physics/boundary/pore_conditions.h"
#include "physics/phase_models.h"
#include "scene/water_table.h"
#include "simulation/failure.h"
#include "simulation/unlikely_parts.h"

namespace talus {
namespace {

double table_at(const WaterTable &table, const std::array<double, 3> &x) { return table.at(x[0], x[1], x[2]); }

/// The water table of [water], which lies level beyond its ends.
void doubt_table(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                 std::vector<std::string> &sentences) {
  if (!scene.water.table.given()) return;
  const auto &table = scene.water.table.points;
  const int up = scene.vertical();
  const double height = soil.of(up);
  if (table.size() > 1 && (table.front()[0] >= soil.high[0] || table.back()[0] <= soil.low[0]))
    sentences.push_back("water.table runs from x = " + rounded(table.front()[0]) + " to " + rounded(table.back()[0]) +
                        " m, beside the soil, which lies from " + rounded(soil.low[0]) + " to " +
                        rounded(soil.high[0]) + " m: the water there is level with the end of the table");
  double least = std::numeric_limits<double>::infinity(), most = -least;
  const auto take = [&](double elevation) { least = std::min(least, elevation), most = std::max(most, elevation); };
  for (const auto &point : table) take(point[1]);
  for (const SoilFace &face : surface)
    for (int a = 0; a < scene.dimension && table.empty(); ++a) take(table_at(scene.water.table, face.corner[a]));
  const double level = scene.water.level(0, 0, 0, 0);
  if (least + level > soil.high[up] + 2 * height)
    sentences.push_back("water.table stands " + rounded(least + level - soil.high[up]) +
                        " m or more above the top of the soil, which is " + rounded(height) +
                        " m high: all of it lies deep under open water. Is this meant?");
  const bool lasts = first_seepage(scene) == scene.stage.end();  // else it is the first state, and no more
  if (lasts && !scene.water.level.depends_on_time() && scene.phases == PhaseModel::drained &&
      most + level <= soil.low[up])
    sentences.push_back(std::string("water.table lies below all soil (its highest point is at ") + axis_names[up] +
                        " = " + rounded(most + level) + " m, the lowest soil at " + rounded(soil.low[up]) +
                        " m): it gives no pore pressure");
}

/// Soil counts as wet below a water table; an excess presses and fills no pores. Pores that are full everywhere have
/// one weight.
void doubt_excess_alone(const Scene &scene, std::vector<std::string> &sentences) {
  const Function &excess = scene.water.excess;
  if (scene.phases != PhaseModel::drained || scene.water.table.given()) return;
  if (excess.constant() && excess(0) == 0) return;
  for (const BodySource &body : scene.body)
    if (((body.saturation > 0 && body.saturation < 1) || body.saturated_unit_weight > 0) && !body.water_table.given() &&
        body.pore_pressure_ratio == 0)
      sentences.push_back("water.excess is the only pore pressure of body." + body.name + ", whose " +
                          (body.saturation > 0 ? "saturation" : "saturated_unit_weight") +
                          " asks for a water table: all of this soil has the weight above the water table. Give the "
                          "elevation of the water as water.table, which may be an expression or a grid, and by "
                          "water.excess only what is not hydrostatic");
}

// ---- open water ----

/// Elevations that water.level adds to tables in the course of the stages [m], among them those at the points of a
/// table and at the end of each stage. An expression is asked for the start alone: a value that its key does not admit
/// would end the run, also one that never comes so far.
std::vector<double> levels_of(const Scene &scene) {
  constexpr int intervals = 50;
  double end = 0;
  std::vector<double> times = scene.water.level.times();
  for (const Stage &stage : scene.stage)
    if (!stage.hold_loads) times.push_back(end += stage.duration);
  const Function &level = scene.water.level;
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

/// Open water rests on the ground with its weight, so that a table that stands above the ground has to be level there.
void doubt_ponds(const Scene &scene, double height, const std::vector<SoilFace> &surface,
                 std::vector<std::string> &sentences) {
  const WaterTable &table = scene.water.table;
  if (!table.given() || table.level()) return;
  std::optional<Pond> worst;  // of all that are not level, the deepest
  for (const double level : levels_of(scene))
    for (const Pond &pond : ponds_of(surface, scene.dimension, scene.vertical(), visible * height,
                                     [&](const auto &x) { return table_at(table, x) + level; }))
      if (pond.highest - pond.lowest > visible * height && (!worst || pond.depth > worst->depth)) worst = pond;
  if (!worst) return;
  sentences.push_back(
      "water.table stands up to " + rounded(worst->depth) + " m above the ground from x = " + rounded(worst->west) +
      " to " + rounded(worst->east) + " m and is not level there: it lies between " + axis_names[scene.vertical()] +
      " = " + rounded(worst->lowest) + " and " + rounded(worst->highest) +
      " m. Open water is level, and the program puts its weight on the ground, so that forces and factors of safety "
      "are those of no real water. Cut the table at the ground, and give each pond one elevation; where the table "
      "stands for a head (artesian pressure under the ground), set water.open_water_load = false, and no open water "
      "loads the ground");
}

/// A table that goes straight on over a hollow of the ground makes a pond there, which has no elevation of its own. Of
/// a plane section: in 3D a valley is no hollow.
void doubt_ponds_in_hollows(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                            std::vector<std::string> &sentences) {
  const WaterTable &table = scene.water.table;
  if (table.points.empty() || scene.dimension == 3) return;
  const double film = visible * soil.of(scene.vertical()), shore = visible * soil.of(0);
  std::optional<Pond> deepest;
  for (const double level : levels_of(scene))
    for (const Pond &pond : ponds_of(surface, scene.dimension, scene.vertical(), film,
                                     [&](const auto &x) { return table_at(table, x) + level; })) {
      const bool hollow = pond.west > soil.low[0] + shore && pond.east < soil.high[0] - shore;
      const bool meant = table.points.size() > 1 && std::ranges::any_of(table.points, [&](const auto &point) {
                           return point[0] >= pond.west - shore && point[0] <= pond.east + shore;
                         });
      if (hollow && !meant && (!deepest || pond.depth > deepest->depth)) deepest = pond;
    }
  if (!deepest) return;
  sentences.push_back("water.table makes a pond of up to " + rounded(deepest->depth) +
                      " m in a hollow of the ground from x = " + rounded(deepest->west) + " to " +
                      rounded(deepest->east) +
                      " m, which loads the ground, and no point of the table lies there. Where the hollow is dry, lead "
                      "the table below its bottom by further points; where a pond is meant, give the table a point at "
                      "each shore, or set water.open_water_load = false for none that loads");
}

/// Surfaces of the water that boundaries put on faces of the soil at the start.
class OpenWater {
 public:
  explicit OpenWater(const Scene &scene) : scene_(scene), up_(scene.vertical()) {
    for (std::size_t b = 0; b < scene.boundary.size(); ++b) {
      boundary_.push_back(read_boundary(scene.boundary[b].kind));
      if (std::ranges::count(scene.boundary[b].group, std::string(free_surface))) elsewhere_ = static_cast<int>(b);
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
    const LiquidBeyond water{scene_.water.density * g, x[up_]};
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
void doubt_dry_ponds(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                     std::vector<std::string> &sentences) {
  const WaterTable &table = scene.water.table;
  const OpenWater open(scene);
  const double level = levels_of(scene).front();
  const int up = scene.vertical();
  const double film = visible * soil.of(up), narrow = visible * soil.of(0);
  const auto stands = [&](const std::array<double, 3> &x) {
    return table.given() ? table_at(table, x) + level : -std::numeric_limits<double>::infinity();
  };
  std::vector<SoilFace> bare;  // the table stands higher than the open water on them
  double most = film;
  std::array<double, 3> place{};
  int flooded = -1;  // the boundary whose water stands highest above the table
  for (const SoilFace &face : surface) {
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
    sentences.push_back("boundary." + scene.boundary[flooded].name + " puts water on the ground that stands " +
                        rounded(most) + " m above " + (table.given() ? "ground and water.table" : "the ground") +
                        " at x = " + rounded(place[0]) + ", " + axis_names[up] + " = " + rounded(place[up]) +
                        " m: the pores start with less water than is at rest under it" +
                        (table.given() ? "" : ", since the scene gives no water.table") +
                        ", and it enters at once. Is this meant? Else give water.table the level of the open water "
                        "there");
  const std::vector<Pond> ponds = ponds_of(bare, scene.dimension, up, film, stands);
  const Pond *deepest = nullptr;
  for (const Pond &pond : ponds)
    if (pond.east - pond.west > narrow && (!deepest || pond.depth > deepest->depth)) deepest = &pond;
  if (!deepest) return;
  std::string text = "water.table stands up to " + rounded(deepest->depth) +
                     " m above the ground from x = " + rounded(deepest->west) + " to " + rounded(deepest->east) +
                     " m. Where pore water moves, the table says what is in the pores at the start, and ";
  int lower = -1;  // a boundary whose water does not come up to the table there
  for (const SoilFace &face : bare)
    for (int a = 0; a < scene.dimension && lower < 0; ++a)
      if (const auto &x = face.corner[a];
          x[0] >= deepest->west && x[0] <= deepest->east && open.at(face, x) > x[up] + film)
        lower = open.on(face);
  if (lower >= 0)
    text += "the water of boundary." + scene.boundary[lower].name +
            ", which rests on the ground, stands lower there. Give both one level";
  else
    text +=
        "no water rests on the ground there. For open water give the ground a boundary with kind = \"head\" and level "
        "= " +
        rounded(deepest->highest) + " m, on group = \"free_surface\" or on groups that reach to the shore" +
        (open.elsewhere() >= 0 ? "; on the free surface in place of boundary." + scene.boundary[open.elsewhere()].name
                               : "");
  sentences.push_back(text);
}

/// The table is what pores begin with where their water moves, and no stage looks at it again unless it prescribes the
/// pressure.
void doubt_changing_table(const Scene &scene, std::vector<std::string> &sentences) {
  if (std::ranges::any_of(scene.stage, [](const Stage &s) { return is_static(s.kind) || !s.pore_flow; })) return;
  for (const auto &[name, changes] : {std::pair{"level", scene.water.level.depends_on_time()},
                                      std::pair{"excess", scene.water.excess.depends_on_time()}})
    if (changes)
      sentences.push_back(
          std::string("water.") + name +
          " changes with time, and pore water moves in all stages: its value at the start alone counts, "
          "since the table says what is in the pores then. Water that rises or falls beside the soil is "
          "a boundary with kind = \"head\" and a level that changes");
}

/// Saturated soil has no air: where no boundary of water is on its surface, the pressure there is zero, as under a film
/// of water, and above the water table water enters.
void doubt_film_on_ground(const Scene &scene, double height, const std::vector<SoilFace> &surface,
                          std::vector<std::string> &sentences) {
  constexpr double share = 0.05;  // of the ground
  const WaterTable &table = scene.water.table;
  if (scene.phases != PhaseModel::saturated || !table.given() || OpenWater(scene).elsewhere() >= 0) return;
  if (std::ranges::none_of(scene.stage, [](const Stage &s) { return !is_static(s.kind) && s.pore_flow; })) return;
  const double level = levels_of(scene).front();
  const int up = scene.vertical();
  double all = 0, dry = 0, most = 0;
  for (const SoilFace &face : surface) {
    if (!may_be_flooded(face, up) || face.ends_mesh) continue;
    all += face.area;
    double above = std::numeric_limits<double>::infinity();  // the table, of the lowest corner
    for (int a = 0; a < scene.dimension; ++a)
      above = std::min(above, face.corner[a][up] - table_at(table, face.corner[a]) - level);
    if (face.water < 0 && above > visible * height) dry += face.area, most = std::max(most, above);
  }
  if (dry <= share * all) return;
  sentences.push_back(rounded(100 * dry / all) + " % of the free surface lies above water.table, by up to " +
                      rounded(most) +
                      " m, and no boundary of pore water is there. phases = \"saturated\" has no air: the pressure at "
                      "the surface is zero, as under a film of water, and water enters the ground as long as it lasts. "
                      "Name it with kind = \"impermeable\", or take phases = \"unsaturated\"");
}

/// The water table of one soil gives pore pressure and no open water: above the free surface of this soil nothing
/// bears against it.
void doubt_own_tables(const Scene &scene, double height, const std::vector<SoilFace> &surface,
                      std::vector<std::string> &sentences) {
  const std::vector<double> levels = levels_of(scene);
  const int up = scene.vertical();
  for (std::size_t b = 0; b < scene.body.size(); ++b) {
    const WaterTable &own = scene.body[b].water_table;
    if (!own.given()) continue;
    std::optional<Pond> over;
    // a steep face that a seam ends at is no ground: the water in the seam leaves it there, or a crack has its pressure
    const auto ground = [&](const SoilFace &face) {
      return face.body == static_cast<int>(b) && !face.conditioned && face.normal[up] > 0.1;
    };
    for (const SoilFace &face : surface)
      for (int a = 0; a < scene.dimension && ground(face); ++a)
        for (const double level : levels) {
          const auto &x = face.corner[a];
          const double head = table_at(own, x) + level;
          const double open =
              scene.water.table.given() ? std::max(x[up], table_at(scene.water.table, x) + level) : x[up];
          if (head - open <= visible * height) continue;
          if (!over) over = Pond{x[0], x[0], head, head, 0};
          over->widen(x[0], head, open);
        }
    if (!over) continue;
    sentences.push_back("body." + scene.body[b].name + ".water_table stands up to " + rounded(over->depth) +
                        " m above the free surface of this soil and the open water on it, from x = " +
                        rounded(over->west) + " to " + rounded(over->east) +
                        " m: it gives pore pressure in the soil only, and no open water bears against that pressure, "
                        "so that the soil there is lifted. Cut it at the ground, and give a pond by water.table; where "
                        "it stands for a head (artesian pressure), water.open_water_load = false says so");
  }
}

}  // namespace

void doubt_water_without_friction(const Scene &scene, int body, const BodyReport &report, const Law &law,
                                  std::vector<std::string> &sentences) {
  const BodySource &source = scene.body[body];
  const WaterTable &table = source.water_table.given() ? source.water_table : scene.water.table;
  const bool frictional = std::visit(
      [](const auto &one) {
        return requires { one.friction_angle; };
      },
      law);
  const bool none = frictional && report.strength.friction_angle[1] == 0 && report.strength.cohesion[1] > 0;
  if (!none || scene.phases != PhaseModel::drained || !table.given() || reads_suction(law)) return;
  const std::vector<double> levels = levels_of(scene);
  double highest = table.points.empty() ? std::numeric_limits<double>::infinity() : -1e300;
  for (const auto &point : table.points)
    highest = std::max(highest, point[1] + *std::max_element(levels.begin(), levels.end()));
  if (highest <= report.low[scene.vertical()]) return;
  sentences.push_back("body." + source.name +
                      " has no friction (friction_angle = 0), as clay with its undrained strength, and lies below a "
                      "water table: pore pressure takes nothing from such a strength, so that water which rises does "
                      "not weaken this soil. If its cohesion is that of drained soil, give its friction_angle too");
}

void doubt_water(const Scene &scene, const Extent &soil, const std::vector<SoilFace> &surface,
                 std::vector<std::string> &sentences) {
  const double height = soil.of(scene.vertical());
  doubt_table(scene, soil, surface, sentences);
  doubt_excess_alone(scene, sentences);
  doubt_water_boundaries(scene, height, surface, sentences);
  doubt_pores(scene, sentences);
  if (phase_traits(scene.phases).liquid) {
    doubt_dry_ponds(scene, soil, surface, sentences);
    doubt_changing_table(scene, sentences);
    doubt_film_on_ground(scene, height, surface, sentences);
  }
  if (scene.phases != PhaseModel::drained || !scene.water.open_water_load) return;
  if (first_seepage(scene) == scene.stage.begin()) return;  // which finds the water that counts
  doubt_ponds(scene, height, surface, sentences);
  doubt_ponds_in_hollows(scene, soil, surface, sentences);
  doubt_own_tables(scene, height, surface, sentences);
}

}  // namespace talus
