// The slip surface of a slide on terrain: from an ellipsoid, a grid or an outline, and what none of them may be.
#include <algorithm>
#include <cmath>
#include <limits>

#include "meshes/terrain.h"
#include "meshes/terrain_words.h"

namespace talus {

using namespace terrain_words;

Terrain::SlipSurface Terrain::slip_surface(const Grid &grid) {
  const auto remember = [&](const Location &location, const std::vector<std::string> &remarks) {
    check_same_projection(location, projection_, grid.file);
    remarks_.insert(remarks_.end(), remarks.begin(), remarks.end());
  };
  const auto at_places = [this](const auto &elevation) {
    return [this, elevation](const Grid &ground) {
      std::vector<double> z;
      for (int k = 0; k < static_cast<int>(ground.values.size()); ++k)
        z.push_back(elevation(origin_[0] + ground.x(k % ground.columns), origin_[1] + ground.y(k / ground.columns)));
      return z;
    };
  };
  if (options_.ellipsoid) return at_places([of = *options_.ellipsoid](double x, double y) { return of.bottom(x, y); });
  if (!options_.slip_surface.empty()) {
    const Grid given = read_elevations(options_.slip_surface);
    remember(location_of(given), given.remarks);
    return at_places([given](double x, double y) { return given.at(x, y); });
  }
  const Outline outline = read_outline(options_.outline);
  remember(outline.location, {});
  if (!(options_.depth > 0))
    complain("--depth must be above 0 m: the largest depth of the slip surface in the outline");
  for (const Outline &part : outline.parts()) parts_.push_back({part});
  return [this, outline](const Grid &ground) { return slip_surface(outline, ground); };
}

/// A place on the outline counts alike on all sides: a bowl is 0 deep there, and a constant depth half as deep, so that
/// the wall, which needs the width of a cell, stands on the outline.
std::vector<double> Terrain::slip_surface(const Outline &outline, const Grid &ground) const {
  constexpr double near = 1e-6;  // of the spacing
  const double h = ground.spacing;
  std::vector<char> inside, on;
  std::vector<std::array<double, 4>> rim;
  for (int k = 0; k < static_cast<int>(ground.values.size()); ++k) {
    const double x = origin_[0] + ground.x(k % ground.columns), y = origin_[1] + ground.y(k / ground.columns);
    on.push_back(outline.touches(x, y, near * h));
    inside.push_back(!on.back() && outline.contains(x, y));
    rim.push_back(inside.back() ? outline.sides_around(x, y, h) : std::array<double, 4>{});
    for (double &away : rim.back()) away = away > (1 - near) * h ? 1 : away / h;
  }
  std::vector<double> z = options_.bowl ? bowl(inside, rim, ground.columns, options_.depth)
                                        : std::vector<double>(inside.size(), options_.depth);
  for (std::size_t k = 0; k < z.size(); ++k)
    if (inside[k] || (on[k] && !options_.bowl))
      z[k] = ground.values[k] - (on[k] ? z[k] / 2 : z[k]);
    else
      z[k] = std::numeric_limits<double>::quiet_NaN();
  return z;
}

/// Between places of the terrain the bed is linear, so that the lip over which a slide leaves its scarp is as round as
/// they are apart: of one formula, soil went 340, 314 and 294 m with elevations 10, 5 and 2.5 m apart in cells of 7 m.
/// Around the slide the bed is therefore asked at places a third of a cell apart. A wall of constant depth needs the
/// width of a cell and stays as it is.
void Terrain::refine_bed(const SlipSurface &surface) {
  constexpr double apart = 1. / 3;  // of a cell
  constexpr double most = 3e4;      // places: Gmsh takes a minute for ten times as many
  if (!options_.outline.empty() && !options_.bowl) return;
  int low[2] = {columns(), rows()}, high[2] = {0, 0};
  for (int k = 0; k < static_cast<int>(bed().size()); ++k) {
    if (!(ground()[k] > bed()[k])) continue;
    const int at[2] = {k % columns(), k / columns()};
    for (int d = 0; d < 2; ++d) low[d] = std::min(low[d], at[d]), high[d] = std::max(high[d], at[d]);
  }
  const int count[2] = {columns(), rows()};
  for (const Part &part : parts_) {  // which no place of the terrain may meet
    const std::array<double, 2> corners[] = {part.outline.low(), part.outline.high()};
    int from[2], to[2];
    for (int d = 0; d < 2; ++d)
      from[d] = static_cast<int>(std::floor((corners[0][d] - origin_[d]) / ground_.spacing)),
      to[d] = static_cast<int>(std::ceil((corners[1][d] - origin_[d]) / ground_.spacing));
    if (from[0] < 0 || from[1] < 0 || to[0] >= columns() || to[1] >= rows()) continue;
    for (int d = 0; d < 2; ++d) low[d] = std::min(low[d], from[d] + 1), high[d] = std::max(high[d], to[d] - 1);
  }
  bool whole = true;
  for (int d = 0; d < 2; ++d) {  // the rim lies within the next place; the edge of the window is that of the terrain
    whole = whole && low[d] > 1 && high[d] < count[d] - 2;
    low[d] = std::max(1, low[d] - 1), high[d] = std::min(count[d] - 2, high[d] + 1);
    if (high[d] <= low[d]) return;
  }
  Refined part{low[0], low[1], high[0] - low[0], high[1] - low[1]};
  part.parts = static_cast<int>(std::ceil(ground_.spacing / (apart * options_.size) - 1e-6));
  while (part.parts > 1 && (double(part.columns) * part.parts + 1) * (double(part.rows) * part.parts + 1) > most)
    --part.parts;
  if (part.parts == 1) return;
  Grid fine;
  fine.columns = part.columns * part.parts + 1, fine.rows = part.rows * part.parts + 1;
  fine.spacing = ground_.spacing / part.parts, fine.west = x(part.column), fine.south = y(part.row);
  for (int k = 0; k < fine.columns * fine.rows; ++k)
    fine.values.push_back(ground_at(fine.x(k % fine.columns), fine.y(k / fine.columns)));
  const std::vector<double> slip = surface(fine);
  for (std::size_t k = 0; k < slip.size(); ++k)
    if (slip[k] < fine.values[k] &&
        !is_void(fine.x(static_cast<int>(k) % fine.columns), fine.y(static_cast<int>(k) / fine.columns)))
      fine.values[k] = slip[k];
  near_slide_ = std::move(fine), refined_ = part;
  if (!whole) return;
  slide_volume_ = slide_area_ = 0;
  const double area = near_slide_.spacing * near_slide_.spacing;
  for (int k = 0; k < near_slide_.columns * near_slide_.rows; ++k) {
    const int i = k % near_slide_.columns, j = k / near_slide_.columns;
    const double deep = ground_at(near_slide_.x(i), near_slide_.y(j)) - near_slide_.values[k];
    slide_volume_ += area * deep, slide_area_ += deep > 0 ? area : 0;
  }
}

void Terrain::take_slip_surface(const Grid &grid) {
  if (!options_.slip_surface.empty() + options_.ellipsoid.has_value() + !options_.outline.empty() > 1)
    complain("give one slip surface: --slip-surface, --ellipsoid or --outline");
  const SlipSurface surface = slip_surface(grid);
  std::vector<double> slip = surface(ground_);
  for (std::size_t k = 0; k < void_.size(); ++k)
    if (void_[k]) slip[k] = std::numeric_limits<double>::quiet_NaN();
  double nearest = std::numeric_limits<double>::infinity();  // of the surface over the ground
  for (std::size_t k = 0; k < slip.size(); ++k) {
    if (std::isnan(slip[k])) continue;  // beside it nothing slides
    nearest = std::min(nearest, slip[k] - bed_.values[k]);
    bed_.values[k] = std::min(bed_.values[k], slip[k]);
  }
  const std::string name = options_.ellipsoid               ? "the ellipsoid"
                           : !options_.slip_surface.empty() ? options_.slip_surface
                                                            : options_.outline;
  if (std::isinf(nearest) &&
      std::any_of(parts_.begin(), parts_.end(), [&](const Part &part) { return in_window(part); }))
    complain(text_of(name, " has no elevation of ", grid.file, " in it, which are ", length(ground_.spacing),
                     " apart, so that nothing slides; take terrain whose elevations are closer together",
                     options_.step > 1 ? ", or a smaller --step" : ""));
  if (std::isinf(nearest))
    complain(name + " does not lie in the window of " + grid.file + "; both count in the same coordinates");
  if (!options_.slip_surface.empty()) check_feet(slip, name);
  if (nearest >= 0)
    complain(text_of(name, " lies above the ground everywhere, by ", length(nearest),
                     " at least, so that nothing slides; check its elevations, or lower it"));
  check_voids();
  for (int k = 0; k < static_cast<int>(bed().size()); ++k) {
    const int i = k % columns(), j = k / columns();
    const double share = (i == 0 || i == columns() - 1 ? 0.5 : 1) * (j == 0 || j == rows() - 1 ? 0.5 : 1),
                 area = share * ground_.spacing * ground_.spacing;  // around the place
    slide_volume_ += area * (ground()[k] - bed()[k]);
    if (ground()[k] > bed()[k]) slide_area_ += area;
  }
  if (!options_.slip_surface.empty()) check_holes(slip, name);
  if (!options_.slip_surface.empty()) check_steps(bed(), name);  // an ellipsoid may be as steep as its wall is high
  if (options_.outline.empty()) check_slip_surface(slip, name);  // that of an outline is as deep as was asked for
  refine_bed(surface);
  slip_surface_area_ = options_.slip_surface.empty() ? area_of_bed() : area_of(slip);
  measure_parts();
  check_parts();
}

void Terrain::check_voids() const {
  for (int k = 0; k < static_cast<int>(void_.size()); ++k)
    for (int b = -1; void_[k] && b <= 1; ++b)
      for (int a = -1; a <= 1; ++a) {
        const int i = k % columns() + a, j = k / columns() + b, beside = j * columns() + i;
        if (i < 0 || j < 0 || i >= columns() || j >= rows()) continue;
        if (ground()[beside] > bed()[beside]) refuse_void(k, "in the slide or beside it");
      }
}

int Terrain::part_at(double x, double y) const {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  const double at[] = {origin_[0] + x, origin_[1] + y};
  for (int p = 0; p < static_cast<int>(parts_.size()); ++p) {
    const Outline &outline = parts_[p].outline;
    if (outline.contains(at[0], at[1])) return p;
    double away = 0;  // from its extent
    for (int d = 0; d < 2; ++d) away = std::max({away, outline.low()[d] - at[d], at[d] - outline.high()[d]});
    if (away < least) least = away, nearest = p;
  }
  return nearest;
}

void Terrain::measure_parts() {
  if (parts_.empty()) return;
  const Grid &fine = near_slide_.values.empty() ? bed_ : near_slide_;
  for (int k = 0; k < fine.columns * fine.rows; ++k) {
    const double x = fine.x(k % fine.columns), y = fine.y(k / fine.columns), deep = ground_at(x, y) - fine.values[k];
    if (!(deep > 0)) continue;
    Part &part = parts_[part_at(x, y)];
    ++part.places, part.volume += fine.spacing * fine.spacing * deep;
  }
}

std::string Terrain::name_of(const Part &part) const {
  const auto low = part.outline.low(), high = part.outline.high();
  return text_of(options_.outline, ": the polygon around (", std::round((low[0] + high[0]) / 2), ", ",
                 std::round((low[1] + high[1]) / 2), "), ", digits(part.outline.area()), " m2");
}

bool Terrain::in_window(const Part &part) const {
  const auto low = part.outline.low(), high = part.outline.high();
  return high[0] > origin_[0] && high[1] > origin_[1] && low[0] < origin_[0] + width() && low[1] < origin_[1] + depth();
}

void Terrain::check_parts() {
  constexpr int few = 9;
  const double apart = near_slide_.values.empty() ? ground_.spacing : near_slide_.spacing;
  for (const Part &part : parts_) {
    if (!in_window(part)) {
      remarks_.push_back(name_of(part) + ", does not lie in the window: nothing slides there. Take a larger window");
      continue;
    }
    const double wide = 2 * part.outline.area() / part.outline.perimeter();  // of a strip; the radius of a circle
    const bool narrow = wide < options_.size, rough = part.places < few || wide < apart;
    if (!narrow && !rough) continue;
    std::string advice = narrow ? text_of("a --size of ", rounded(wide * 2 / 3, 2), " m or less") : "";
    if (rough && !(narrow && options_.bowl)) advice += (narrow ? ", and " : "") + std::string("finer terrain");
    const std::string places = part.places == 0   ? "no place"
                               : part.places == 1 ? "1 place"
                                                  : text_of(part.places, " places");
    remarks_.push_back(text_of(name_of(part), ", holds ", places, " of the slip surface, which are ", length(apart),
                               " apart", narrow ? text_of(", and cells of ", length(options_.size)) : "",
                               part.places ? ": what slides there is known roughly" : ": nothing slides there",
                               ". Take ", advice, ", or leave it out"));
  }
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
                     "such as by gdal_calc.py --calc=\"A*0.3048\""));
}

/// Places without data from which no way leads to the edge of the window but through the slide.
void Terrain::check_holes(const std::vector<double> &slip, const std::string &name) const {
  std::vector<char> reached(slip.size(), 0);
  std::vector<int> next;
  const auto reach = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= columns() || j >= rows()) return;
    const int k = j * columns() + i;
    if (!std::isnan(slip[k]) && slip[k] < ground()[k]) return;
    if (!reached[k]) reached[k] = 1, next.push_back(k);
  };
  for (int i = 0; i < columns(); ++i) reach(i, 0), reach(i, rows() - 1);
  for (int j = 0; j < rows(); ++j) reach(0, j), reach(columns() - 1, j);
  while (!next.empty()) {
    const int i = next.back() % columns(), j = next.back() / columns();
    next.pop_back();
    reach(i + 1, j), reach(i - 1, j), reach(i, j + 1), reach(i, j - 1);
  }
  for (int k = 0; k < static_cast<int>(slip.size()); ++k)
    if (std::isnan(slip[k]) && !reached[k])
      complain(name + " has no elevation at " + place(k) +
               ", in the middle of the slide; fill the hole, such as by gdal_fillnodata.py");
}

/// Of one that a grid gives: by sixteen places of each cell of the grid, between whose corners surface and ground are
/// interpolated: as a sum over nodes the area of a slide of ten nodes across would be a tenth too small. By the corners
/// beside places without data, and where the surface goes on along the ground and does not cross it.
double Terrain::area_of(const std::vector<double> &slip) const {
  constexpr int parts = 4;
  constexpr double on_it = 1e-4;  // of the spacing
  const double h = ground_.spacing;
  double sum = 0;
  for (int j = 0; j + 1 < rows(); ++j)
    for (int i = 0; i + 1 < columns(); ++i) {
      const int k = j * columns() + i, corner[] = {k, k + 1, k + columns(), k + columns() + 1};
      double z[4], depth[4];
      bool known = true;
      for (int c = 0; c < 4; ++c)
        z[c] = slip[corner[c]], depth[c] = ground()[corner[c]] - z[c], known = known && std::abs(depth[c]) > on_it * h;
      for (int c = 0; c < 4 && !known; ++c) z[c] = bed()[corner[c]], depth[c] = ground()[corner[c]] > z[c] ? 1 : -1;
      int inside = 0;
      for (int a = 0; a < parts * parts; ++a) {
        const double x = (a % parts + 0.5) / parts, y = (std::floor(a / parts) + 0.5) / parts;
        const double here = (1 - y) * ((1 - x) * depth[0] + x * depth[1]) + y * ((1 - x) * depth[2] + x * depth[3]);
        inside += here > 0;
      }
      sum += inside / double(parts * parts) * h *
             std::hypot(h, (z[1] + z[3] - z[0] - z[2]) / 2, (z[2] + z[3] - z[0] - z[1]) / 2);
    }
  return sum;
}

/// Of an ellipsoid or an outline, with the walls in which the slide ends. A square that the slide fills in part counts
/// by half, but for a wall, which stands across it.
double Terrain::area_of_bed() const {
  const Grid &bed = near_slide_.values.empty() ? bed_ : near_slide_;
  constexpr double on_it = 1e-4;  // of the spacing
  const double h = bed.spacing;
  const auto deep = [&](int i, int j) {
    return ground_at(bed.x(i), bed.y(j)) - bed.values[j * bed.columns + i] > on_it * h;
  };
  double sum = 0;
  for (int j = 0; j + 1 < bed.rows; ++j)
    for (int i = 0; i + 1 < bed.columns; ++i) {
      const int inside = deep(i, j) + deep(i + 1, j) + deep(i, j + 1) + deep(i + 1, j + 1);
      if (inside == 0) continue;
      const double *z = &bed.values[j * bed.columns + i], *north = z + bed.columns;
      const double rise = std::hypot((z[1] + north[1] - z[0] - north[0]) / 2, (north[0] + north[1] - z[0] - z[1]) / 2);
      const bool wall = !options_.outline.empty() && !options_.bowl;
      sum += (inside == 4 || wall ? 1 : 0.5) * h * std::hypot(h, rise);
    }
  return sum;
}

/// Values of one sign, none of which is as large as the least depth at which the surface would lie below the ground:
/// depths, unless the surface is a thin layer's over ground that hardly rises.
bool Terrain::seem_depths(const std::vector<double> &slip, double least, bool thick) const {
  constexpr double shallow = 0.25;  // of the height of the ground over it
  double low = std::numeric_limits<double>::infinity(), high = -low, lowest = low, highest = high;
  for (std::size_t k = 0; k < slip.size(); ++k) {
    if (std::isnan(slip[k])) continue;
    low = std::min(low, slip[k]), high = std::max(high, slip[k]);
    lowest = std::min(lowest, ground()[k]), highest = std::max(highest, ground()[k]);
  }
  const double largest = std::max(high, -low);
  return (low >= 0 || high <= 0) && largest <= least && (thick || largest < shallow * (highest - lowest));
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
  const double wide = std::sqrt(slide_area_);
  double least = deepest;  // depth of the surface
  for (std::size_t k = 0; k < slip.size(); ++k)
    least = std::min(least, std::isnan(slip[k]) ? least : ground()[k] - slip[k]);
  if (by_grid && (lowest - highest > 0.5 * deep || seem_depths(slip, least, deep > 0.1 * wide)))
    complain(text_of(name, " reaches up to ", highest, " m only, the ground above it down to ", lowest,
                     " m, so that the slide is ", length(deep),
                     " thick on average and its surface comes to light nowhere. Are these depths? Elevations are asked "
                     "for, the ground minus the depth: gdal_calc.py -A ",
                     ground_.file, " -B ", name, " --calc=\"A-B\" --outfile=slip_surface.tif"));
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
                             by_grid ? "Go on with the grid until it is above the ground"
                                     : "Raise the centre of the ellipsoid, or turn it, until its rim is above the "
                                       "ground"));
}

}  // namespace talus
