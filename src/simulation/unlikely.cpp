#include "simulation/unlikely.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "base/units.h"
#include "physics/boundary/boundary.h"
#include "physics/boundary/pore_conditions.h"
#include "scene/water_table.h"
#include "simulation/failure.h"

namespace talus {
namespace {

/// A key whose value lies outside of what soils have, and what it would be in the unit that was probably meant.
struct Doubt {
  const char *key;
  double value;        ///< SI
  Unit unit;           ///< in which the key counts numbers
  double least, most;  ///< of soils, from laboratory models of dust to rock, SI
  const char *meant;   ///< unit or key
};

constexpr const char *axes = "xyz";
constexpr double least_cohesion = 20;  ///< [Pa]; less is doubted whatever the height

/// The box around the cells of all bodies that are there.
struct Extent {
  std::array<double, 3> low, high;
  double of(int d) const { return high[d] - low[d]; }
};

Extent extent_of(const std::vector<BodyReport> &bodies) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Extent box{{far, far, far}, {-far, -far, -far}};
  for (const BodyReport &b : bodies)
    for (int d = 0; d < 3 && b.particles > 0; ++d)
      box.low[d] = std::min(box.low[d], b.low[d]), box.high[d] = std::max(box.high[d], b.high[d]);
  return box;
}

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
  if (!scene.water.level.depends_on_time() && scene.phases == PhaseModel::drained && most + level <= soil.low[up])
    sentences.push_back(std::string("water.table lies below all soil (its highest point is at ") + axes[up] + " = " +
                        rounded(most + level) + " m, the lowest soil at " + rounded(soil.low[up]) +
                        " m): it gives no pore pressure");
}

/// Soil counts as wet below a water table; an excess presses and fills no pores.
void doubt_excess_alone(const Scene &scene, std::vector<std::string> &sentences) {
  const Function &excess = scene.water.excess;
  if (scene.phases != PhaseModel::drained || scene.water.table.given()) return;
  if (excess.constant() && excess(0) == 0) return;
  for (const BodySource &body : scene.body)
    if ((body.saturation > 0 || body.saturated_unit_weight > 0) && !body.water_table.given() &&
        body.pore_pressure_ratio == 0)
      sentences.push_back("water.excess is the only pore pressure of body." + body.name + ", whose " +
                          (body.saturation > 0 ? "saturation" : "saturated_unit_weight") +
                          " asks for a water table: all of this soil has the weight above the water table. Give the "
                          "elevation of the water as water.table, which may be an expression or a grid, and by "
                          "water.excess only what is not hydrostatic");
}

// ---- open water ----

/// Elevations that water.level adds to tables in the course of the stages [m]. An expression is asked for the start
/// alone: a value that its key does not admit would end the run, also one that never comes so far.
std::vector<double> levels_of(const Scene &scene) {
  constexpr int intervals = 50;
  double end = 0;
  for (const Stage &stage : scene.stage)
    if (!stage.hold_loads) end += stage.duration;
  const Function &level = scene.water.level;
  std::vector<double> levels{level(0)};
  for (int k = 1; k <= intervals && level.depends_on_time() && !level.uses("t"); ++k)
    levels.push_back(level(end * k / intervals));
  return levels;
}

/// May water stand on the face? Not on what faces down, and not where a support is.
bool may_be_flooded(const SoilFace &face, int up) { return !face.held && face.normal[up] > -1e-6; }

/// Ground under water that hangs together.
struct Pond {
  double west, east;       ///< its ends [m]
  double lowest, highest;  ///< surface of the water [m]
  double depth;            ///< greatest [m]
  void widen(double x, double surface, double ground) {
    west = std::min(west, x), east = std::max(east, x);
    lowest = std::min(lowest, surface), highest = std::max(highest, surface);
    depth = std::max(depth, surface - ground);
  }
};

/// The ponds that stand on the surface of the soil where water rises to `elevation`; less than `film` deep counts as
/// dry.
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
    ponds.try_emplace(first(corner), Pond{x[0], x[0], level, level, 0}).first->second.widen(x[0], level, x[up]);
  }
  std::vector<Pond> list;
  for (const auto &[corner, pond] : ponds) list.push_back(pond);
  return list;
}

constexpr double visible = 0.01;  // of the height of the soil: what no table follows the ground more closely than

/// Open water rests on the ground with its weight, so that a table that stands above the ground has to be level there.
void doubt_ponds(const Scene &scene, double height, const std::vector<SoilFace> &surface,
                 std::vector<std::string> &sentences) {
  const WaterTable &table = scene.water.table;
  if (!table.given() || table.level()) return;
  std::optional<Pond> worst;
  const auto fall = [](const Pond &pond) { return pond.highest - pond.lowest; };
  for (const double level : levels_of(scene))
    for (const Pond &pond : ponds_of(surface, scene.dimension, scene.vertical(), visible * height,
                                     [&](const auto &x) { return table_at(table, x) + level; }))
      if (!worst || fall(pond) > fall(*worst)) worst = pond;
  if (!worst || fall(*worst) <= visible * height) return;
  sentences.push_back(
      "water.table stands up to " + rounded(worst->depth) + " m above the ground from x = " + rounded(worst->west) +
      " to " + rounded(worst->east) + " m and is not level there: it lies between " + axes[scene.vertical()] + " = " +
      rounded(worst->lowest) + " and " + rounded(worst->highest) +
      " m. Open water is level, and the program puts its weight on the ground, so that forces and factors of safety "
      "are those of no real water. Cut the table at the ground, and give each pond one elevation; where the table "
      "stands for a head (artesian pressure under the ground), set water.open_water_load = false, and no open water "
      "loads the ground");
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

// ---- seepage ----

/// The first stage of seepage, or the end of the stages.
std::vector<Stage>::const_iterator first_seepage(const Scene &scene) {
  return std::find_if(scene.stage.begin(), scene.stage.end(),
                      [](const Stage &stage) { return stage.kind == StageKind::seepage; });
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

/// The suction of drained soil is where its seepage begins, and no stage before that sees it.
void doubt_early_suction(const Scene &scene, std::vector<std::string> &sentences) {
  const auto first = first_seepage(scene);
  if (scene.water.suction.given() && first != scene.stage.end() && first != scene.stage.begin())
    sentences.push_back("water.suction acts from the first stage of seepage on, " + first->name +
                        ": the soil of stage " + scene.stage.front().name +
                        " has none. If its strength depends on suction, put a stage of seepage with hold_loads = true "
                        "before it");
}

// ---- ends of the mesh ----

/// A range of coordinates along an axis.
struct Span {
  double from = std::numeric_limits<double>::infinity(), to = -from;
  void widen(double x) { from = std::min(from, x), to = std::max(to, x); }
  std::string text() const { return rounded(from) + (to > from ? " to " + rounded(to) : "") + " m"; }
};

/// Where equilibrium is asked for, soil that ends with the mesh is mostly cut off there and goes on in nature.
void doubt_ends(const Scene &scene, const Extent &soil, int up, const std::vector<SoilFace> &surface,
                std::vector<std::string> &sentences) {
  constexpr double thin = 0.1;  // of the height of the soil: a layer that comes to light there decides little
  const auto asks = [](const Stage &stage) {
    return stage.kind == StageKind::quasi_static || stage.kind == StageKind::consolidation ||
           (stage.kind == StageKind::dynamic && stage.until == StopWhen::equilibrium);
  };
  if (std::none_of(scene.stage.begin(), scene.stage.end(), asks)) return;
  for (int d = 0; d < scene.dimension; ++d)
    for (const double sign : {-1., 1.}) {
      if (d == up) continue;
      const double end = sign < 0 ? soil.low[d] : soil.high[d], near = 1e-6 * soil.of(d);
      double all = 0, free = 0;
      Span span;
      for (const SoilFace &face : surface) {
        const auto beside = [&](int a) { return std::abs(face.corner[a][d] - end) > near; };
        if (!face.ends_mesh || sign * face.normal[d] < 0.9 || beside(0) || beside(1)) continue;
        all += face.area;
        if (face.conditioned) continue;
        free += face.area;
        for (int a = 0; a < scene.dimension; ++a) span.widen(face.corner[a][up]);
      }
      if (2 * free <= all || span.to - span.from < thin * soil.of(up)) continue;
      const std::string zero = scene.dimension == 2 ? "[0, 0]" : "[0, 0, 0]";
      sentences.push_back(std::string("The soil ends with the mesh at ") + axes[d] + " = " + rounded(end) +
                          " m, and no boundary names its face there, " + axes[up] + " = " + span.text() +
                          ": it is free to move outwards, as no soil that goes on there would be, and may fail first. "
                          "Give it kind = \"roller\" or \"fixed\"; kind = \"traction\" with traction = " +
                          zero + " says that it is a free face");
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
  sentences.push_back(std::string("Nothing holds the soil from below: its lowest faces, ") + axes[across] + " = " +
                      where.text() + " at " + axes[up] + " = " + elevation.text() +
                      ", end with the mesh, and no boundary with a support names them, so that the soil hangs on its "
                      "sides or falls out of the mesh. Give them kind = \"fixed\" or \"roller\"");
}

/// The faces of one side of the soil, found by their place on the level.
class LevelFaces {
 public:
  LevelFaces(const std::vector<SoilFace> &faces, int dimension, int up, double sign) : up_(up) {
    for (int d = 0; d < dimension; ++d)
      if (d != up) level_.push_back(d);
    for (const SoilFace &face : faces)
      if (sign * face.normal[up] > 1e-6) faces_.push_back(face);
    for (const SoilFace &face : faces_)
      for (int d : level_)
        for (int a = 0; a < dimension; ++a)
          low_[d] = std::min(low_[d], face.corner[a][d]), high_[d] = std::max(high_[d], face.corner[a][d]);
    std::array<int, 3> from{}, to{};
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      for (int d : level_) {
        from[d] = strips, to[d] = 0;
        for (int a = 0; a < dimension; ++a)
          from[d] = std::min(from[d], strip(d, faces_[k].corner[a][d])),
          to[d] = std::max(to[d], strip(d, faces_[k].corner[a][d]));
      }
      const int second = level_.back();
      for (int i = from[level_[0]]; i <= to[level_[0]]; ++i)
        for (int j = from[second]; j <= to[second]; ++j) in_[i * strips + j].push_back(static_cast<int>(k));
    }
  }
  const std::vector<SoilFace> &faces() const { return faces_; }

  /// Elevation of the lowest face at a place; not a number where there is none.
  double lowest(const std::array<double, 3> &x) const {
    double found = std::numeric_limits<double>::quiet_NaN();
    for (int k : in_[strip(level_[0], x[level_[0]]) * strips + strip(level_.back(), x[level_.back()])])
      if (const double z = elevation(faces_[k], x); !std::isnan(z) && !(z >= found)) found = z;
    return found;
  }

 private:
  static constexpr int strips = 128;
  int strip(int d, double x) const {
    return std::clamp(static_cast<int>((x - low_[d]) / (high_[d] - low_[d]) * strips), 0, strips - 1);
  }
  /// Of a face at a place on the level; not a number beside it.
  double elevation(const SoilFace &face, const std::array<double, 3> &x) const {
    constexpr double near = 1e-9;
    const auto &c = face.corner;
    const int i = level_[0], j = level_.back();
    if (level_.size() == 1) {
      const double s = (x[i] - c[0][i]) / (c[1][i] - c[0][i]);
      return s >= -near && s <= 1 + near ? c[0][up_] + s * (c[1][up_] - c[0][up_]) : NAN;
    }
    const double a = c[1][i] - c[0][i], b = c[2][i] - c[0][i], p = c[1][j] - c[0][j], q = c[2][j] - c[0][j];
    const double u = ((x[i] - c[0][i]) * q - (x[j] - c[0][j]) * b) / (a * q - b * p),
                 v = ((x[j] - c[0][j]) * a - (x[i] - c[0][i]) * p) / (a * q - b * p);
    if (!(u >= -near && v >= -near && u + v <= 1 + near)) return NAN;
    return c[0][up_] + u * (c[1][up_] - c[0][up_]) + v * (c[2][up_] - c[0][up_]);
  }

  int up_;
  std::vector<int> level_;  ///< axes
  std::vector<SoilFace> faces_;
  std::array<double, 3> low_{1e300, 1e300, 1e300}, high_{-1e300, -1e300, -1e300};
  std::vector<std::vector<int>> in_ = std::vector<std::vector<int>>(strips * strips);  ///< strips of both axes: faces
};

}  // namespace

double greatest_depth(const std::vector<SoilFace> &surface, int dimension, int up) {
  const LevelFaces above(surface, dimension, up, 1), below(surface, dimension, up, -1);
  double greatest = 0;
  for (const SoilFace &face : above.faces()) {
    std::array<double, 3> middle{};
    for (int a = 0; a < dimension; ++a)
      for (int d = 0; d < 3; ++d) middle[d] += face.corner[a][d] / dimension;
    if (const double bottom = below.lowest(middle); middle[up] - bottom > greatest) greatest = middle[up] - bottom;
  }
  return greatest;
}

std::vector<std::string> unlikely_surroundings(const Scene &scene, const std::vector<BodyReport> &bodies,
                                               const std::vector<SoilFace> &surface) {
  constexpr double highest = 5000, lowest = 0.01;       // [m], from mountains to experiments on a table
  constexpr double centrifuge = 3000, asteroid = 1e-3;  // [m/s2]
  std::vector<std::string> sentences;
  const double g = scene.gravity_size();
  if (g == 0) return sentences;
  if (g < asteroid || g > centrifuge)
    sentences.push_back("gravity is " + rounded(g) + " m/s2; that of the earth is 9.81 m/s2. Is it in mm/s2?");
  if (scene.water.given && (scene.water.density < 500 || scene.water.density > 3000))
    sentences.push_back("water.density is " + rounded(scene.water.density) +
                        " kg/m3, which hardly any water has; a number without a unit counts in kg/m3. Is it in t/m3?");
  const Extent soil = extent_of(bodies);
  const int up = scene.vertical();
  const double height = soil.of(up);
  if (height < 0) return sentences;  // a later stage adds all soil
  if (height > highest)
    sentences.push_back("The soil is " + rounded(height) +
                        " m high; coordinates count in metres. Is the mesh in millimetres or feet?");
  if (height < lowest)
    sentences.push_back("The soil is " + rounded(height) +
                        " m high; coordinates count in metres. Is the mesh in kilometres?");
  doubt_table(scene, soil, surface, sentences);
  doubt_excess_alone(scene, sentences);
  if (scene.phases == PhaseModel::drained) doubt_early_suction(scene, sentences);
  if (scene.phases == PhaseModel::drained && scene.water.open_water_load) {
    doubt_ponds(scene, soil.of(up), surface, sentences);
    doubt_own_tables(scene, soil.of(up), surface, sentences);
    doubt_sealed_ground(scene, sentences);
  }
  doubt_ends(scene, soil, up, surface, sentences);
  doubt_base(scene, soil, up, surface, sentences);
  return sentences;
}

std::vector<std::string> coarse_cells(const Scene &scene, const std::vector<BodyReport> &bodies,
                                      const std::vector<SoilFace> &surface) {
  constexpr double few = 4;  // over the depth: not even a slip surface fits in
  std::vector<std::string> sentences;
  if (scene.gravity_size() == 0) return sentences;
  const double depth = greatest_depth(surface, scene.dimension, scene.vertical());
  for (const BodyReport &b : bodies)
    if (b.particles > 0 && depth > 0 && depth < few * b.cell_size)
      sentences.push_back("The soil is " + rounded(depth) + " m deep at most, and the cells of " + b.name +
                          " measure " + rounded(b.cell_size) + " m: fewer than " + rounded(few) +
                          " cells over the depth resolve neither stress nor slip surface. Take smaller cells "
                          "(mesh.size)");
  return sentences;
}

namespace {

/// Strength and stiffness that make no sense for soil as deep as this, though some other soil may have them.
void doubt_for_depth(const BodySource &source, const BodyReport &body, const Law &law, double weight,
                     std::vector<std::string> &sentences) {
  // c over the weight per area of the soil: below, c does not decide whether anything stands; above, all does
  constexpr double no_effect = 1e-3, stands_always = 100;
  constexpr double sand = 30 * degree.si;  // which is often given a trace of cohesion
  constexpr double rock = 1e6;             // [Pa]
  constexpr double fast = 2500;            // [m/s], waves in sound rock; dry soil has 150 to 1000
  const double c = body.strength.cohesion[1], phi = body.strength.friction_angle[1];
  const bool frictional = std::visit(
      [](const auto &one) {
        return requires { one.friction_angle; };
      },
      law);
  if (!frictional) return;
  if (c >= least_cohesion && c < no_effect * weight && phi < sand)
    sentences.push_back("body." + source.name + ".cohesion is " + rounded(c) + " Pa, " + rounded(c / weight) +
                        " of the weight of the soil, " + rounded(weight / 1e3) +
                        " kPa over its depth: it decides nothing, and clays with a friction angle of " +
                        rounded(phi / degree.si) + " deg have 1 to 50 kPa. Is it in kPa?");
  if (c > stands_always * weight && source.reduce_strength)
    sentences.push_back("body." + source.name + ".cohesion is " + rounded(c) + " Pa, " + rounded(c / weight) +
                        " times the weight of the soil, " + rounded(weight / 1e3) +
                        " kPa over its depth: such soil stands in any shape. Is it a unit too large? For rock or a "
                        "structure, reduce_strength = false says that a factor of safety does not concern it");
  const double young = 9 * bulk_modulus(law) * shear_modulus(law) / (3 * bulk_modulus(law) + shear_modulus(law));
  constexpr double stiffer = 5;  // soils and rocks have 50 to 1000
  if (c > 0 && young < stiffer * c && source.reduce_strength)
    sentences.push_back("The stiffness of body." + source.name + ", young_modulus = " + rounded(young / 1e6) +
                        " MPa, is " + rounded(young / c) + " times its cohesion of " + rounded(c / 1e3) +
                        " kPa: soils and rocks have 50 to 1000 times. Is one of the two in another unit?");
  const double speed = std::sqrt(constrained_modulus(law) * body.volume / body.mass);
  if (speed > fast && c < rock)
    sentences.push_back("The stiffness of body." + source.name + " gives waves a speed of " + rounded(speed) +
                        " m/s, as in sound rock, and its cohesion of " + rounded(c / 1e3) +
                        " kPa is that of soil, in which they have 150 to 1000 m/s. Is young_modulus a unit too "
                        "large? Soils have 1 MPa to 1 GPa");
}

}  // namespace

std::vector<std::string> unlikely_values(const Scene &scene, const std::vector<Law> &laws,
                                         const std::vector<BodyReport> &bodies, const std::vector<SoilFace> &surface) {
  constexpr double none = 1e300;
  std::vector<std::string> sentences;
  const double depth = greatest_depth(surface, scene.dimension, scene.vertical());
  for (std::size_t b = 0; b < laws.size(); ++b) {
    const BodySource &body = scene.body[b];
    std::vector<Doubt> doubts{
        {"density", body.density, kilogram_per_cubic_metre, 100, 10e3, "t/m3"},
        {"grain_density", body.grain_density, kilogram_per_cubic_metre, 500, 10e3, "t/m3"},
        {"unit_weight", body.unit_weight, newton_per_cubic_metre, 5e3, 60e3, "kg/m3 (key density)"},
        {"saturated_unit_weight", body.saturated_unit_weight, newton_per_cubic_metre, 8e3, 60e3, "kg/m3"},
        {"permeability", body.permeability, square_metre, 0, 1e-6, "m/s (key hydraulic_conductivity)"},
    };
    std::visit(
        [&](const auto &law) {
          if constexpr (requires { law.young_modulus; })
            doubts.push_back({"young_modulus", law.young_modulus, pascal, 5e3, none, "kPa or MPa"});
          if constexpr (requires { law.friction_angle; }) {
            doubts.push_back({"cohesion", law.cohesion, pascal, least_cohesion, none, "kPa"});
            doubts.push_back({"friction_angle", law.friction_angle, degree, 2 * degree.si, none, "radians"});
          }
          if constexpr (requires { law.tension_cutoff; })
            if (const double apex = law.cohesion / std::tan(law.friction_angle);
                law.tension_cutoff > 0 && law.friction_angle > 0 && law.tension_cutoff >= apex)
              sentences.push_back("body." + body.name + ".tension_cutoff is " + rounded(law.tension_cutoff) +
                                  " Pa and has no effect: soil with this cohesion and friction angle bears no more "
                                  "tension than cohesion / tan(friction_angle) = " +
                                  rounded(apex) + " Pa");
        },
        laws[b]);
    if (bodies[b].particles > 0 && scene.gravity_size() > 0 && depth > 0)
      doubt_for_depth(body, bodies[b], laws[b], bodies[b].mass / bodies[b].volume * scene.gravity_size() * depth,
                      sentences);
    for (const Doubt &one : doubts)
      if (one.value > 0 && (one.value < one.least || one.value > one.most))
        sentences.push_back("body." + body.name + "." + one.key + " is " + rounded(one.value / one.unit.si) + " " +
                            one.unit.name + ", which hardly any soil has; a number without a unit counts in " +
                            one.unit.name + ". Is it in " + one.meant + "?");
  }
  return sentences;
}

}  // namespace talus
