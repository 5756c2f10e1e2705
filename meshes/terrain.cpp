#include "meshes/terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "meshes/terrain_words.h"

namespace talus {

using namespace terrain_words;

namespace {

/// Fills places that are not a number: inwards from those that are, then as a soap film does.
void interpolate(std::vector<double> &z, int columns) {
  constexpr int sweeps = 100;
  const int count = static_cast<int>(z.size());
  const auto mean_beside = [&](int k) {
    double sum = 0;
    int known = 0;
    const auto add = [&](bool inside, int at) {
      if (inside && !std::isnan(z[at])) sum += z[at], ++known;
    };
    add(k % columns > 0, k - 1), add(k % columns < columns - 1, k + 1);
    add(k >= columns, k - columns), add(k + columns < count, k + columns);
    return known ? sum / known : std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<int> holes, filled;  // in the order in which they are filled
  for (int k = 0; k < count; ++k)
    if (std::isnan(z[k])) holes.push_back(k);
  for (std::vector<int> left = holes; !left.empty();) {
    std::vector<int> next;
    std::vector<std::pair<int, double>> known;
    for (const int k : left)
      if (const double mean = mean_beside(k); std::isnan(mean))
        next.push_back(k);
      else
        known.emplace_back(k, mean);
    if (known.empty()) return;  // there is no data at all
    for (const auto &[k, mean] : known) z[k] = mean;
    left = std::move(next);
  }
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (const int k : holes) z[k] = mean_beside(k);
}

}  // namespace

Terrain::Terrain(const TerrainOptions &options) : options_(options) {
  const Grid grid = read_elevations(options.file);
  projection_ = grid.projection, remarks_ = grid.remarks;
  if (!(options.far_size >= options.size)) options_.far_size = options.size;
  take_window(grid);
  check_scale();
  bed_ = ground_;
  if (options.ellipsoid || !options.slip_surface.empty() || !options.outline.empty()) take_slip_surface(grid);
  take_layers(grid);
  if (options.base)
    check_base();
  else if (!(options.air > 0))
    complain(
        "--air must be above 0 m where the ground itself is the base: the mesh is the space above it, in which "
        "soil moves; give --air, or a flat base by --base");
  if (const auto &w = options.way; !w.empty()) {
    if (w.size() < 4 || w.size() % 2) complain("--way needs two points x y or more");
    if (!(options.way_width > 0))
      complain("--way-width must be above 0 m: the width of the strip of small cells along --way");
    if (!slides()) complain("--way leads away from a slide, of which there is none: give a slip surface");
    for (std::size_t a = 0; a + 3 < w.size(); a += 2)
      if (w[a] == w[a + 2] && w[a + 1] == w[a + 3]) complain("--way has a point twice in succession");
  }
  if (options.size > std::min(width(), depth()))
    complain(text_of("--size ", options.size, " m is larger than the window, which measures ", width(), " m x ",
                     depth(), " m; take a smaller size"));
  find_distances();
}

std::string Terrain::place(int index) const {
  return text_of("(", origin_[0] + x(index % columns()), ", ", origin_[1] + y(index / columns()), ")");
}

void Terrain::take_window(const Grid &grid) {
  const auto &w = options_.window;
  const std::string extent = text_of(grid.file, " reaches from (", grid.west, ", ", grid.south, ") to (", grid.east(),
                                     ", ", grid.north(), ") m");
  int from[2] = {0, 0}, to[2] = {grid.columns - 1, grid.rows - 1};
  if (!w.empty()) {
    const double south = std::min(w[1], w[3]), north = std::max(w[1], w[3]);  // gdalinfo has the upper corner first
    if (!(w[2] > w[0] && north > south))
      complain("--window west south east north must have east > west, and two norths");
    const double near = (0.5 + 1e-6) * grid.spacing;  // the cells of the file reach half a spacing beyond their centres
    if (w[0] < grid.west - near || south < grid.south - near || w[2] > grid.east() + near ||
        north > grid.north() + near)
      complain(text_of("--window ", w[0], " ", w[1], " ", w[2], " ", w[3], " reaches out of the grid: ", extent,
                       "; take a window inside"));
    const double low[2] = {w[0] - grid.west, south - grid.south}, high[2] = {w[2] - grid.west, north - grid.south};
    for (int d = 0; d < 2; ++d) {
      from[d] = std::max(0, static_cast<int>(std::lround(low[d] / grid.spacing)));
      to[d] = std::min(to[d], static_cast<int>(std::lround(high[d] / grid.spacing)));
    }
  }
  if (options_.step < 1) complain("--step must be 1 or more");
  ground_.file = grid.file, ground_.spacing = options_.step * grid.spacing;
  ground_.columns = (to[0] - from[0]) / options_.step + 1, ground_.rows = (to[1] - from[1]) / options_.step + 1;
  if (ground_.columns < 2 || ground_.rows < 2)
    complain(text_of("the window has ", to[0] - from[0] + 1, " columns and ", to[1] - from[1] + 1,
                     " rows of the grid; take a larger window or a smaller --step"));
  origin_ = {grid.west + from[0] * grid.spacing, grid.south + from[1] * grid.spacing};
  for (int j = 0; j < ground_.rows; ++j)
    for (int i = 0; i < ground_.columns; ++i)
      ground_.values.push_back(grid.values[static_cast<std::size_t>(from[1] + j * options_.step) * grid.columns +
                                           from[0] + i * options_.step]);
  take_voids();
  check_steps(ground(), grid.file);
}

namespace {

constexpr const char *fill_voids =
    "fill them, such as by gdal_fillnodata.py (and look at what it fills: far from data it makes steps), or take "
    "another window by --window";

}  // namespace

std::string Terrain::voids_in_words() const {
  return text_of(ground_.file, ": the window has no data at ", std::count(void_.begin(), void_.end(), 1), " of ",
                 void_.size(), " places");
}

void Terrain::take_voids() {
  std::vector<double> &z = ground_.values;
  for (const double one : z) void_.push_back(std::isnan(one));
  const auto first = std::find(void_.begin(), void_.end(), 1);
  if (first == void_.end()) return void_.clear();
  bool some = false;
  for (int j = 0; j + 1 < rows(); ++j)
    for (int i = 0; i + 1 < columns(); ++i)
      some = some || !is_void(x(i) + 0.5 * ground_.spacing, y(j) + 0.5 * ground_.spacing);
  if (!some) complain(voids_in_words() + ", and nowhere at the four corners of a square; " + fill_voids);
  interpolate(z, columns());
  remarks_.push_back(text_of(voids_in_words(), ", the first at ", place(static_cast<int>(first - void_.begin())),
                             ": cells whose centre lies there are left out of the mesh, which ends there at the group "
                             "void, and soil that comes there leaves the mesh. Where the ground matters, ",
                             fill_voids));
}

bool Terrain::is_void(double x, double y) const {
  if (void_.empty()) return false;
  const int i = std::clamp(static_cast<int>(x / ground_.spacing), 0, columns() - 2),
            j = std::clamp(static_cast<int>(y / ground_.spacing), 0, rows() - 2), k = j * columns() + i;
  return void_[k] || void_[k + 1] || void_[k + columns()] || void_[k + columns() + 1];
}

void Terrain::refuse_void(int index, const std::string &where) const {
  complain(text_of(voids_in_words(), ", and that at ", place(index), " lies ", where, "; ", fill_voids));
}

void Terrain::check_scale() {
  constexpr double much = 0.01;  // UTM is out by 0.0004 in the middle of a zone and by 0.001 at its edge
  const Location window{ground_.file, projection_, {origin_[0] + width() / 2, origin_[1] + depth() / 2}, 0};
  const auto [east, north] = map_scale(window);
  if (!(std::abs(east - 1) > much || std::abs(north - 1) > much)) return;
  remarks_.push_back(text_of(
      ground_.file, ": lengths of its projection are no metres on the ground: in the middle of the window they are ",
      digits(east), " times as long",
      std::abs(east - north) > much ? text_of(" from west to east and ", digits(north), " times from south to north")
                                    : "",
      ", while elevations are true, so that slopes are ", east + north > 2 ? "gentler" : "steeper",
      " than they are, and areas and volumes ", digits(east * north),
      " times theirs. Project it to metres, such as by gdalwarp -t_srs EPSG:CODE (CODE of a UTM zone or of the "
      "national "
      "grid)"));
}

/// A cliff, the edge of a mesa or the tip of a spur stands far above or below most of the places around it and goes on
/// in one or two of them; what goes on nowhere is no ground. Places without data lie together and share one value.
double Terrain::stands_out(const std::vector<double> &z, int at, double sign, double allowed) const {
  constexpr std::size_t few = 2, few_without_data = 8;
  std::vector<int> group{at};
  double least = std::numeric_limits<double>::infinity();
  bool same = sign < 0;  // those above the ground, such as 9999, make steps that are high enough to be told by them
  for (std::size_t n = 0; n < group.size(); ++n) {
    const int i = group[n] % columns(), j = group[n] / columns();
    for (int b = std::max(0, j - 1); b <= std::min(rows() - 1, j + 1); ++b)
      for (int a = std::max(0, i - 1); a <= std::min(columns() - 1, i + 1); ++a) {
        const int beside = b * columns() + a;
        if (std::find(group.begin(), group.end(), beside) != group.end()) continue;
        const double height = sign * (z[group[n]] - z[beside]);
        if (height > allowed) {
          least = std::min(least, height);
          continue;
        }
        group.push_back(beside), same = same && z[beside] == z[at];
        if (group.size() > (same ? few_without_data : few)) return 0;
      }
  }
  return std::isinf(least) ? 0 : least;
}

void Terrain::check_steps(const std::vector<double> &z, const std::string &file) const {
  constexpr double steep = 2, rare = 15;  // a spike is this steep on all sides, and so much more than the roughness
  constexpr double cliff = 10;            // rise over run of a step that no cell can follow
  constexpr double highest_cliff = 500;   // [m], as some sea cliffs are
  const auto times = [&](int at) { return std::count(z.begin(), z.end(), z[at]); };
  const auto refuse = [&](int at, const std::string &how) {
    complain(text_of(file, ": the elevation ", z[at], " m at ", place(at),
                     times(at) > 1 ? text_of(", which ", times(at), " places have,") : "", " ", how, "; if ", z[at],
                     " stands for a place without data, say so by gdal_translate -a_nodata ", z[at],
                     " and fill it by gdal_fillnodata.py; or take a window without it by --window"));
  };
  std::vector<double> beside, roughness(z.size());
  int step_at = -1, step_beside = -1;
  double highest = cliff * std::max(ground_.spacing, options_.size);
  for (int k = 0; k < static_cast<int>(z.size()); ++k) {
    const int i = k % columns(), j = k / columns();
    beside.clear();
    for (int b = std::max(0, j - 1); b <= std::min(rows() - 1, j + 1); ++b)
      for (int a = std::max(0, i - 1); a <= std::min(columns() - 1, i + 1); ++a)
        if (a != i || b != j) beside.push_back(z[b * columns() + a]);
    const auto middle = beside.begin() + static_cast<long>(beside.size() / 2);
    std::nth_element(beside.begin(), middle, beside.end());
    roughness[k] = std::abs(z[k] - *middle);
    for (const int next : {i > 0 ? k - 1 : k, j > 0 ? k - columns() : k})
      if (std::abs(z[k] - z[next]) > highest) highest = std::abs(z[k] - z[next]), step_at = k, step_beside = next;
  }
  const auto most = roughness.begin() + static_cast<long>(0.95 * static_cast<double>(roughness.size() - 1));
  std::nth_element(roughness.begin(), most, roughness.end());
  const double allowed = std::max(steep * ground_.spacing, rare * *most);
  int spikes = 0, spike_at = -1;
  double spike = 0;
  for (int k = 0; k < static_cast<int>(z.size()); ++k)
    for (const double sign : {1., -1.})
      if (const double height = stands_out(z, k, sign, allowed); height > 0) {
        ++spikes;
        if (height > std::abs(spike)) spike = sign * height, spike_at = k;
      }
  if (spikes)
    refuse(spike_at, text_of("stands ", length(std::abs(spike)), " ", spike > 0 ? "above" : "below",
                             " all places around it, as no ground does",
                             spikes > 1 ? text_of(" (so do ", spikes, " places)") : "", ". Correct it"));
  if (step_at < 0) return;
  // the one of the two that is farther from the ground: from the middle of all other elevations
  std::vector<double> others;
  for (const double one : z)
    if (one != z[step_at] && one != z[step_beside]) others.push_back(one);
  const auto middle = others.begin() + static_cast<long>(others.size() / 2);
  std::nth_element(others.begin(), middle, others.end());
  const double ground = others.empty() ? std::max(z[step_at], z[step_beside]) : *middle;
  if (std::abs(z[step_beside] - ground) > std::abs(z[step_at] - ground)) std::swap(step_at, step_beside);
  refuse(step_at, text_of("is ", length(highest), z[step_at] < z[step_beside] ? " lower" : " higher",
                          " than the place beside it, more than ", cliff, " cells (--size) or spacings are high. ",
                          highest < highest_cliff ? text_of("If this is a cliff, take a --size of ",
                                                            length(1.05 * highest / cliff), " or more")
                                                  : "Correct it"));
}

void Terrain::take_layers(const Grid &grid) {
  if (!options_.layers.empty() && !options_.base)
    complain("--layer NAME FILE parts the ground over a flat base: give --base, or leave the layers out");
  for (const auto &[name, file] : options_.layers) {
    for (const char *own :
         {"slide", "ground", "air", "base", "terrain", "top", "void", "west", "east", "south", "north"})
      if (name == own)
        complain("--layer " + name + " " + file + ": " + name + " is a group of the mesh already; name it otherwise");
    const Grid given = read_elevations(file);
    check_same_projection(location_of(given), projection_, grid.file);
    remarks_.insert(remarks_.end(), given.remarks.begin(), given.remarks.end());
    Grid &surface = layer_.emplace_back(ground_);
    for (int k = 0; k < static_cast<int>(surface.values.size()); ++k) {
      surface.values[k] = given.at(origin_[0] + x(k % columns()), origin_[1] + y(k / columns()));
      if (has_voids() && void_[k])
        surface.values[k] = std::numeric_limits<double>::quiet_NaN();
      else if (std::isnan(surface.values[k]))
        complain(file + " has no elevation at " + place(k) + ", where layer " + name +
                 " needs one; give a grid that covers the "
                 "window, and an elevation below the base where the layer is absent");
    }
    interpolate(surface.values, columns());
    for (double &z : surface.values) z = std::max(z, *options_.base);  // where it is absent
    check_steps(surface.values, file);
  }
}

std::string Terrain::layer_at(double x, double y, double z) const {
  for (std::size_t k = layer_.size(); k-- > 0;)
    if (z < layer_[k].at(x, y)) return options_.layers[k][0];
  return "";
}

std::string Terrain::layer_above(int index) const {
  const std::vector<double> &own = layer_[index].values;
  if (std::none_of(own.begin(), own.end(), [&](double z) { return z > *options_.base; })) return "";
  for (std::size_t k = index + 1; k < layer_.size(); ++k) {
    bool above = true;
    for (std::size_t at = 0; at < own.size(); ++at)
      above = above && (layer_[k].values[at] >= own[at] || own[at] <= *options_.base);
    if (above) return options_.layers[k][0];
  }
  return "";
}

void Terrain::check_base() const {
  const auto lowest = std::min_element(bed().begin(), bed().end());
  if (*options_.base >= *lowest)
    complain(text_of("--base ", *options_.base, " m must lie below the lowest ", slides() ? "slip surface and " : "",
                     "ground, which is at ", *lowest, " m, at ", place(static_cast<int>(lowest - bed().begin()))));
}

/// By two sweeps over the grid, in which each place learns from its neighbours: a few per cent too far.
void Terrain::find_distances() {
  distance_ = ground_;
  std::vector<double> &d = distance_.values;
  for (std::size_t k = 0; k < d.size(); ++k) d[k] = !slides() || ground()[k] > bed()[k] ? 0 : 1e300;
  const std::vector<double> &w = options_.way;
  for (std::size_t a = 0; slides() && a + 3 < w.size(); a += 2)
    for (int k = 0; k < static_cast<int>(d.size()); ++k) {
      const double from[] = {origin_[0] + x(k % columns()) - w[a], origin_[1] + y(k / columns()) - w[a + 1]},
                   along[] = {w[a + 2] - w[a], w[a + 3] - w[a + 1]};
      const double share =
          std::clamp((from[0] * along[0] + from[1] * along[1]) / (along[0] * along[0] + along[1] * along[1]), 0., 1.);
      const double away = std::hypot(from[0] - share * along[0], from[1] - share * along[1]);
      const double beside = std::max(0., away - options_.way_width / 2);
      const bool on_way = beside < ground_.spacing * std::sqrt(0.5);  // or less: a narrow strip may meet no node
      if (on_way && has_voids() && void_[k]) refuse_void(k, "on the way of the slide (--way)");
      way_in_window_ |= on_way, way_meets_slide_ |= on_way && ground()[k] > bed()[k];
      d[k] = std::min(d[k], beside);
    }
  if (slides() && !w.empty() && !way_in_window_)
    complain(text_of("--way, which begins at x = ", w[0], ", y = ", w[1],
                     " m, lies beside the terrain that is meshed, which ranges from x = ", origin_[0] + x(0), " to ",
                     origin_[0] + x(columns() - 1), " and from y = ", origin_[1] + y(0), " to ",
                     origin_[1] + y(rows() - 1), " m: its points are given in the coordinates of the grid"));
  for (std::size_t a = 0; slides() && a + 1 < w.size(); a += 2) {
    const double i = (w[a] - origin_[0] - x(0)) / ground_.spacing, j = (w[a + 1] - origin_[1] - y(0)) / ground_.spacing;
    if (i >= 0 && i <= columns() - 1 && j >= 0 && j <= rows() - 1) continue;
    remarks_.push_back(text_of("the way leaves the terrain that is meshed: its point ", a / 2 + 1, " is at x = ", w[a],
                               ", y = ", w[a + 1], " m, and the slide would leave the mesh there"));
    break;
  }
  const auto learn = [&](int i, int j, int di, int dj) {
    if (i + di < 0 || i + di >= columns() || j + dj < 0 || j + dj >= rows()) return;
    double &mine = d[j * columns() + i];
    mine = std::min(mine, d[(j + dj) * columns() + i + di] + std::hypot(di, dj) * ground_.spacing);
  };
  for (const int sign : {1, -1})
    for (int b = 0; b < rows(); ++b)
      for (int a = 0; a < columns(); ++a) {
        const int i = sign > 0 ? a : columns() - 1 - a, j = sign > 0 ? b : rows() - 1 - b;
        for (const auto &[di, dj] : {std::array{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}) learn(i, j, sign * di, sign * dj);
      }
}

double Terrain::size_at(double x, double y, double z) const {
  constexpr double growth = 0.2;  // of cells with the distance
  x = std::clamp(x, 0., width()), y = std::clamp(y, 0., depth());
  const double below = options_.base ? std::max(0., bed_at(x, y) - z) : 0;
  return std::min(options_.far_size, options_.size + growth * (distance_.at(x, y) + below));
}

std::string Terrain::origin_document() const {
  const nlohmann::ordered_json document{
      {"terrain", options_.file},
      {"origin_m", {origin_[0], origin_[1]}},
      {"spacing_m", ground_.spacing / options_.step},
      {"meaning", "x and y of the map are those of the mesh plus the origin; z is the elevation"},
      {"projection", projection_}};
  return document.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace talus
