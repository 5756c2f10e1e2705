#include "meshes/terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "base/rounded.h"
#include "meshes/outline.h"

namespace talus {
namespace {

constexpr double degrees = 180 / 3.14159265358979323846;

[[noreturn]] void complain(const std::string &text) { throw std::invalid_argument(text); }

template <class... Part>
std::string text_of(const Part &...part) {
  std::ostringstream text;
  text.precision(9);
  (text << ... << part);
  return text.str();
}

/// A number in a sentence, to three digits.
std::string digits(double value) { return rounded(value, 3); }
std::string length(double metres) { return digits(metres) + " m"; }

std::string json_text(const std::string &text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + "\"";
}

/// Clockwise from north, 0 to 360 degrees.
double azimuth(const std::array<double, 2> &v) {
  const double angle = std::atan2(v[0], v[1]) * degrees;
  return angle < 0 ? angle + 360 : angle;
}

}  // namespace

std::array<std::array<double, 3>, 3> Ellipsoid::axes() const {
  const double s = std::sin(dip_direction), c = std::cos(dip_direction);
  return {{{std::cos(dip) * s, std::cos(dip) * c, -std::sin(dip)},
           {c, -s, 0},
           {std::sin(dip) * s, std::sin(dip) * c, std::cos(dip)}}};
}

double Ellipsoid::side(double x, double y, double sign) const {
  const auto axis = axes();
  double square = 0, mixed = 0, rest = -1;  // of the equation for the height above the centre
  for (int k = 0; k < 3; ++k) {
    const double level = (axis[k][0] * (x - centre[0]) + axis[k][1] * (y - centre[1])) / semi_axes[k],
                 rise = axis[k][2] / semi_axes[k];
    square += rise * rise, mixed += level * rise, rest += level * level;
  }
  return centre[2] + (-mixed + sign * std::sqrt(mixed * mixed - square * rest)) / square;
}

double Ellipsoid::bottom(double x, double y) const { return side(x, y, -1); }
double Ellipsoid::top(double x, double y) const { return side(x, y, 1); }

/// On the unit sphere the rim is the great circle normal to (n0, 0, n2), since the second axis is level.
std::array<double, 3> Ellipsoid::rim(double angle) const {
  const auto axis = axes();
  const double n0 = axis[0][2] / semi_axes[0], n2 = axis[2][2] / semi_axes[2], n = std::hypot(n0, n2);
  const double along[] = {std::sin(angle) * n2 / n, std::cos(angle), -std::sin(angle) * n0 / n};
  std::array<double, 3> place = centre;
  for (int k = 0; k < 3; ++k)
    for (int d = 0; d < 3; ++d) place[d] += along[k] * semi_axes[k] * axis[k][d];
  return place;
}

Terrain::Terrain(const TerrainOptions &options) : options_(options) {
  const Grid grid = read_elevations(options.file);
  projection_ = grid.projection, remarks_ = grid.remarks;
  if (!(options.far_size >= options.size)) options_.far_size = options.size;
  take_window(grid);
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
    if (!(w[2] > w[0] && w[3] > w[1]))
      complain("--window west south east north must have east > west and north > south");
    const double near = 1e-6 * grid.spacing;
    if (w[0] < grid.west - near || w[1] < grid.south - near || w[2] > grid.east() + near || w[3] > grid.north() + near)
      complain(text_of("--window ", w[0], " ", w[1], " ", w[2], " ", w[3], " reaches out of the grid: ", extent,
                       "; take a window inside"));
    const double start[2] = {grid.west, grid.south};
    for (int d = 0; d < 2; ++d) {
      from[d] = static_cast<int>(std::lround((w[d] - start[d]) / grid.spacing));
      to[d] = static_cast<int>(std::lround((w[d + 2] - start[d]) / grid.spacing));
    }
  }
  if (options_.step < 1) complain("--step must be 1 or more");
  ground_.file = grid.file, ground_.spacing = options_.step * grid.spacing;
  ground_.columns = (to[0] - from[0]) / options_.step + 1, ground_.rows = (to[1] - from[1]) / options_.step + 1;
  if (ground_.columns < 2 || ground_.rows < 2)
    complain(text_of("the window has ", to[0] - from[0] + 1, " columns and ", to[1] - from[1] + 1,
                     " rows of the grid; take a larger window or a smaller --step"));
  origin_ = {grid.west + from[0] * grid.spacing, grid.south + from[1] * grid.spacing};
  int holes = 0, first = 0;
  for (int j = 0; j < ground_.rows; ++j)
    for (int i = 0; i < ground_.columns; ++i) {
      const double z = grid.values[static_cast<std::size_t>(from[1] + j * options_.step) * grid.columns + from[0] +
                                   i * options_.step];
      if (std::isnan(z) && !holes++) first = static_cast<int>(ground_.values.size());
      ground_.values.push_back(z);
    }
  if (holes)
    complain(text_of(grid.file, ": the window has no data at ", holes, " of ", ground_.values.size(),
                     " places, the first at ", place(first),
                     "; fill the holes, such as by gdal_fillnodata.py (and look at what it fills: far from data it "
                     "makes steps), or take another window by --window"));
  check_steps(ground(), grid.file);
}

void Terrain::check_steps(const std::vector<double> &z, const std::string &file) const {
  constexpr double steep = 2, rare = 15;  // a spike is this steep on all sides, and so much more than the roughness
  constexpr double cliff = 10;            // rise over run of a step that no cell can follow
  const auto refuse = [&](int at, const std::string &how, const std::string &others) {
    complain(text_of(file, ": the elevation ", z[at], " m at ", place(at), " ", how, ", as no ground does", others,
                     ". Correct it; if ", z[at],
                     " stands for a place without data, say so by gdal_translate -a_nodata ", z[at],
                     " and fill it by gdal_fillnodata.py; or take a window without it by --window"));
  };
  std::vector<double> beside, off(z.size());
  int step_at = -1;
  double highest = cliff * std::max(ground_.spacing, options_.size);
  for (int k = 0; k < static_cast<int>(z.size()); ++k) {
    const int i = k % columns(), j = k / columns();
    beside.clear();
    for (int b = std::max(0, j - 1); b <= std::min(rows() - 1, j + 1); ++b)
      for (int a = std::max(0, i - 1); a <= std::min(columns() - 1, i + 1); ++a)
        if (a != i || b != j) beside.push_back(z[b * columns() + a]);
    const auto middle = beside.begin() + static_cast<long>(beside.size() / 2);
    std::nth_element(beside.begin(), middle, beside.end());
    off[k] = z[k] - *middle;
    for (const int next : {i > 0 ? k - 1 : k, j > 0 ? k - columns() : k})
      if (std::abs(z[k] - z[next]) > highest) highest = std::abs(z[k] - z[next]), step_at = z[k] < z[next] ? k : next;
  }
  std::vector<double> roughness;
  for (const double one : off) roughness.push_back(std::abs(one));
  const auto most = roughness.begin() + static_cast<long>(0.95 * static_cast<double>(roughness.size() - 1));
  std::nth_element(roughness.begin(), most, roughness.end());
  const double allowed = std::max(steep * ground_.spacing, rare * *most);
  const auto spikes = std::count_if(off.begin(), off.end(), [&](double one) { return std::abs(one) > allowed; });
  const auto worst =
      std::max_element(off.begin(), off.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  if (spikes)
    refuse(static_cast<int>(worst - off.begin()),
           text_of("stands ", length(std::abs(*worst)), " ", *worst > 0 ? "above" : "below", " the places around it"),
           spikes > 1 ? text_of(" (so do ", spikes, " places)") : "");
  if (step_at >= 0) refuse(step_at, text_of("is ", length(highest), " lower than the place beside it"), "");
}

void Terrain::check_feet(const std::vector<double> &slip, const std::string &name) const {
  constexpr double foot = 0.3048, near = 0.1;  // by a tenth the depth of a slide may change the ratio
  double low = std::numeric_limits<double>::infinity(), high = -low, gap = low, area = 0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < slip.size(); ++k) {
    if (std::isnan(slip[k])) continue;
    const double ratio = slip[k] / ground()[k];
    low = std::min(low, ratio), high = std::max(high, ratio), gap = std::min(gap, std::abs(slip[k] - ground()[k]));
    area += ground_.spacing * ground_.spacing, at = k;
  }
  const auto all_near = [&](double ratio) { return low > (1 - near) * ratio && high < (1 + near) * ratio; };
  if (gap > 0.5 * std::sqrt(area) && (all_near(foot) || all_near(1 / foot)))  // farther away than any slide is deep
    complain(text_of(name, " has the elevation ", slip[at], " m at ", place(static_cast<int>(at)), ", where ",
                     ground_.file, " has ", ground()[at], " m, and everywhere ", digits(low), " to ", digits(high),
                     " times those of the ground: one of the two seems to be in feet. Convert it to metres, "
                     "such as by gdal_calc.py --calc=A*0.3048"));
}

std::vector<double> Terrain::slip_surface(const Grid &grid) {
  const auto remember = [&](const Location &location, const std::vector<std::string> &remarks) {
    check_same_projection(location, projection_, grid.file);
    remarks_.insert(remarks_.end(), remarks.begin(), remarks.end());
  };
  const auto at_places = [&](const auto &elevation) {
    std::vector<double> z;
    for (int k = 0; k < static_cast<int>(ground().size()); ++k)
      z.push_back(elevation(origin_[0] + x(k % columns()), origin_[1] + y(k / columns())));
    return z;
  };
  if (options_.ellipsoid) return at_places([&](double x, double y) { return options_.ellipsoid->bottom(x, y); });
  if (!options_.slip_surface.empty()) {
    const Grid given = read_elevations(options_.slip_surface);
    remember(location_of(given), given.remarks);
    return at_places([&](double x, double y) { return given.at(x, y); });
  }
  const Outline outline = read_outline(options_.outline);
  remember(outline.location, {});
  if (!(options_.depth > 0))
    complain("--depth must be above 0 m: the largest depth of the slip surface in the outline");
  return slip_surface(outline);
}

/// A place on the outline counts alike on all sides: a bowl is 0 deep there, and a constant depth half as deep, so that
/// the wall, which needs the width of a cell, stands on the outline.
std::vector<double> Terrain::slip_surface(const Outline &outline) const {
  constexpr double near = 1e-6;  // of the spacing
  const double h = ground_.spacing;
  std::vector<char> inside, on;
  std::vector<std::array<double, 4>> rim;
  for (int k = 0; k < static_cast<int>(ground().size()); ++k) {
    const double x = origin_[0] + this->x(k % columns()), y = origin_[1] + this->y(k / columns());
    on.push_back(outline.touches(x, y, near * h));
    inside.push_back(!on.back() && outline.contains(x, y));
    rim.push_back(inside.back() ? outline.sides_around(x, y, h) : std::array<double, 4>{});
    for (double &away : rim.back()) away = away > (1 - near) * h ? 1 : away / h;
  }
  std::vector<double> z =
      options_.bowl ? bowl(inside, rim, columns(), options_.depth) : std::vector<double>(inside.size(), options_.depth);
  for (std::size_t k = 0; k < z.size(); ++k)
    if (inside[k] || (on[k] && !options_.bowl))
      z[k] = ground()[k] - (on[k] ? z[k] / 2 : z[k]);
    else
      z[k] = std::numeric_limits<double>::quiet_NaN();
  return z;
}

void Terrain::take_slip_surface(const Grid &grid) {
  if (!options_.slip_surface.empty() + options_.ellipsoid.has_value() + !options_.outline.empty() > 1)
    complain("give one slip surface: --slip-surface, --ellipsoid or --outline");
  const std::vector<double> slip = slip_surface(grid);
  double nearest = std::numeric_limits<double>::infinity();  // of the surface over the ground
  for (std::size_t k = 0; k < slip.size(); ++k) {
    if (std::isnan(slip[k])) continue;  // beside it nothing slides
    nearest = std::min(nearest, slip[k] - bed_.values[k]);
    bed_.values[k] = std::min(bed_.values[k], slip[k]);
  }
  const std::string name = options_.ellipsoid               ? "the ellipsoid"
                           : !options_.slip_surface.empty() ? options_.slip_surface
                                                            : options_.outline;
  if (std::isinf(nearest))
    complain(name + " does not lie in the window of " + grid.file +
             (options_.outline.empty() ? "" : ", or no elevation of the grid is in it") +
             "; both count in the same coordinates");
  if (!options_.slip_surface.empty()) check_feet(slip, name);
  if (nearest >= 0)
    complain(text_of(name, " lies above the ground everywhere, by ", length(nearest),
                     " at least, so that nothing slides; check its elevations, or lower it"));
  for (int k = 0; k < static_cast<int>(bed().size()); ++k) {
    const int i = k % columns(), j = k / columns();
    const double share = (i == 0 || i == columns() - 1 ? 0.5 : 1) * (j == 0 || j == rows() - 1 ? 0.5 : 1),
                 area = share * ground_.spacing * ground_.spacing;  // around the place
    slide_volume_ += area * (ground()[k] - bed()[k]);
    if (ground()[k] > bed()[k]) slide_area_ += area;
  }
  if (!options_.slip_surface.empty()) check_steps(bed(), name);  // an ellipsoid may be as steep as its wall is high
  if (options_.outline.empty()) check_slip_surface(slip, name);  // that of an outline is as deep as was asked for
}

void Terrain::take_layers(const Grid &grid) {
  if (!options_.layers.empty() && !options_.base)
    complain("--layer NAME FILE parts the ground over a flat base: give --base, or leave the layers out");
  for (const auto &[name, file] : options_.layers) {
    for (const char *own : {"slide", "ground", "air", "base", "terrain", "top", "west", "east", "south", "north"})
      if (name == own)
        complain("--layer " + name + " " + file + ": " + name + " is a group of the mesh already; name it otherwise");
    const Grid given = read_elevations(file);
    check_same_projection(location_of(given), projection_, grid.file);
    remarks_.insert(remarks_.end(), given.remarks.begin(), given.remarks.end());
    Grid &surface = layer_.emplace_back(ground_);
    for (int k = 0; k < static_cast<int>(surface.values.size()); ++k) {
      surface.values[k] = given.at(origin_[0] + x(k % columns()), origin_[1] + y(k / columns()));
      if (std::isnan(surface.values[k]))
        complain(file + " has no elevation at " + place(k) + ", where layer " + name +
                 " needs one; give a grid that covers the "
                 "window, and an elevation below the base where the layer is absent");
    }
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

void Terrain::check_slip_surface(const std::vector<double> &slip, const std::string &name) {
  const bool by_grid = !options_.slip_surface.empty();
  const double deep = slide_volume_ / slide_area_;
  double highest = -std::numeric_limits<double>::infinity(), lowest = -highest, deepest = 0;
  int deepest_at = 0;
  bool emerges = false;  // the upper side of an ellipsoid
  for (int k = 0; k < static_cast<int>(slip.size()); ++k) {
    const double depth = ground()[k] - slip[k];
    if (options_.ellipsoid) {
      const double east = origin_[0] + x(k % columns()), north = origin_[1] + y(k / columns());
      emerges = emerges || options_.ellipsoid->top(east, north) > ground()[k];
    }
    if (!(depth > 0)) continue;
    highest = std::max(highest, slip[k]), lowest = std::min(lowest, ground()[k]);
    if (depth > deepest) deepest = depth, deepest_at = k;
  }
  if (options_.ellipsoid && !emerges)
    complain(text_of("the ellipsoid lies wholly below the ground, ", length(deepest), " deep at ", place(deepest_at),
                     ", so that the slide would have a vertical wall all round; raise its centre, in elevation, to "
                     "the ground or near it"));
  if (by_grid && lowest - highest > 0.5 * deep)
    complain(text_of(name, " reaches up to ", highest, " m only, ", length(lowest - highest),
                     " below the lowest ground above it, so that the slide is ", length(deep),
                     " thick and its surface comes to light nowhere. Are these depths? Elevations are asked for: the "
                     "ground minus the depth, such as by gdal_calc.py"));
  const double wide = std::sqrt(slide_area_);
  double least = deepest;  // depth of the surface
  for (std::size_t k = 0; k < slip.size(); ++k)
    least = std::min(least, std::isnan(slip[k]) ? least : ground()[k] - slip[k]);
  if (by_grid && least > 0.5 * deep) {
    const std::string sentence =
        text_of(name, " lies below the ground everywhere, by ", length(least), " at least and ", length(deep),
                " on average, so that all ground above it slides and its surface comes to light nowhere. ");
    if (deep > 0.1 * wide)
      complain(sentence +
               "Check its elevations, or lift its rim above the ground; a slide that is as deep everywhere is given by "
               "--outline, --depth and --depth-shape constant");
    remarks_.push_back(sentence + "Is this meant?");
  }
  if (deep > 0.5 * wide)
    remarks_.push_back(text_of("the slide is ", length(deep), " thick on average and covers ", slide_area_,
                               " m2 only, so that it is a shaft rather than a slide. Are elevations and coordinates "
                               "in metres, and ",
                               name, " an elevation and not a depth?"));
  // where the surface ends below the ground, the slide ends at a wall
  double wall = deepest / 3;
  std::string where;
  const auto note = [&](double height, const std::string &at) {
    if (height > wall) wall = height, where = at;
  };
  for (int k = 0; by_grid && k < static_cast<int>(slip.size()); ++k)
    for (const auto &[a, b] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int i = k % columns() + a, j = k / columns() + b, behind = k - a - b * columns();
      if (!(slip[k] < ground()[k]) || i < 0 || j < 0 || i >= columns() || j >= rows()) continue;
      if (!std::isnan(slip[j * columns() + i])) continue;
      const int i_behind = k % columns() - a, j_behind = k / columns() - b;
      const bool inside = i_behind >= 0 && j_behind >= 0 && i_behind < columns() && j_behind < rows();
      const double depth = ground()[k] - slip[k];
      const double inwards = inside && !std::isnan(slip[behind]) ? ground()[behind] - slip[behind] : depth;
      note(std::min(depth, 2 * depth - inwards), place(k));  // it may rise to the ground within its last cell
    }
  constexpr int round = 180;
  for (int k = 0; options_.ellipsoid && k < round; ++k) {
    const auto [east, north, elevation] = options_.ellipsoid->rim(2 * 3.14159265358979323846 * k / round);
    note(ground_at(east - origin_[0], north - origin_[1]) - elevation,
         text_of("(", std::round(east), ", ", std::round(north), ")"));
  }
  if (where.empty()) return;
  remarks_.push_back(text_of(name, " ends ", length(wall), " below the ground at ", where, ", and it is ",
                             length(deepest), " deep at most: the slide has a vertical wall there. ",
                             by_grid ? "Go on with the grid until it is above the ground, also inside, where it has no "
                                       "data (gdal_fillnodata.py)"
                                     : "Raise the centre of the ellipsoid, or turn it, until its rim is above the "
                                       "ground"));
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

std::array<double, 2> Terrain::downhill(const std::vector<double> &z) const {
  std::array<double, 2> sum{};
  for (int j = 1; j + 1 < rows(); ++j)
    for (int i = 1; i + 1 < columns(); ++i) {
      const int k = j * columns() + i;
      if (!(ground()[k] > bed()[k])) continue;
      sum[0] -= z[k + 1] - z[k - 1], sum[1] -= z[k + columns()] - z[k - columns()];
    }
  return sum;
}

std::vector<std::string> Terrain::doubts() const {
  std::vector<std::string> sentences = remarks_;
  if (ground_.spacing > 2 * options_.size)
    sentences.push_back(text_of("the cells at the ground (--size ", options_.size,
                                " m) are smaller than the spacing of the elevations, ", ground_.spacing,
                                " m, and show no more than these do"));
  if (!slides()) return sentences;
  const std::array<double, 2> slope = downhill(ground());
  std::array<double, 2> dip = downhill(bed());
  if (options_.ellipsoid)
    dip = {std::sin(options_.ellipsoid->dip_direction), std::cos(options_.ellipsoid->dip_direction)};
  if ((!options_.ellipsoid || options_.ellipsoid->dip > 0) && dip[0] * slope[0] + dip[1] * slope[1] < 0)
    sentences.push_back(text_of("the slip surface dips towards ", std::lround(azimuth(dip)),
                                " degrees from north, into the slope, which falls towards ",
                                std::lround(azimuth(slope)),
                                " degrees: dip direction is the azimuth (clockwise from north) towards which the "
                                "surface dips. Is it meant to dip the other way?"));
  const double deep = slide_volume_ / slide_area_;
  double deepest = 0;
  for (std::size_t k = 0; k < ground().size(); ++k) deepest = std::max(deepest, ground()[k] - bed()[k]);
  if (options_.air > 0 && options_.air < deepest)
    sentences.push_back(text_of(
        "the mesh reaches ", length(options_.air), " above the ground (--air), and the slide is up to ",
        length(deepest), " thick: soil that runs over steep ground leaves it by the top; more air costs little"));
  const double meshed = way_meets_slide_ ? options_.size : options_.far_size,
               on_way = std::ldexp(meshed, -options_.halvings);
  if (on_way > deep)
    sentences.push_back(text_of(
        way_meets_slide_ ? "cells measure " : "cells grow to ", length(on_way),
        options_.halvings > 0 ? text_of(" (", length(meshed), " with edges halved ",
                                        options_.halvings == 1 ? "once" : text_of(options_.halvings, " times"), ")")
                              : "",
        " on the way of the slide, which is ", length(deep),
        " thick on average and thinner as it spreads: a flow that is not as deep as a cell is not resolved. Take "
        "cells of a third of its depth or less there, by --far-size and --size, or by --size along a line --way"));
  for (int k = 0; k < static_cast<int>(bed().size()); ++k) {
    const int i = k % columns(), j = k / columns();
    if (ground()[k] > bed()[k] && (i == 0 || j == 0 || i == columns() - 1 || j == rows() - 1)) {
      sentences.push_back("the slide reaches the edge of the window at " + place(k) +
                          ", where it is cut off; take a larger window");
      break;
    }
  }
  return sentences;
}

std::string Terrain::origin_document() const {
  return text_of("{\"terrain\": ", json_text(options_.file), ",\n \"origin_m\": [", origin_[0], ", ", origin_[1],
                 "],\n \"meaning\": \"x and y of the map are those of the mesh plus the origin; z is the elevation\",\n"
                 " \"projection\": ",
                 json_text(projection_), "}\n");
}

}  // namespace talus
