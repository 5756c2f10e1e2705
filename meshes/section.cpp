#include "meshes/section.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>
#include <stdexcept>

#include "meshes/polygon.h"
#include "meshes/spreadsheet.h"

namespace talus {
namespace {

[[noreturn]] void complain(const Section &section, int line, const std::string &text) {
  throw std::invalid_argument(section.file + " line " + std::to_string(line) + ": " + text);
}

bool starts_with(const std::string &text, const std::string &start) { return text.rfind(start, 0) == 0; }

/// The number at the end of a part's name, also with a decimal comma.
bool is_number(std::string text, double &value) {
  std::replace(text.begin(), text.end(), ',', '.');
  return Spreadsheet{}.number(text, value);
}

constexpr std::size_t most_points =
    5000;  // more than cells can follow, and more than a quick check of crossings allows

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// The rows of a table, below headers that may state its unit.
class Table {
 public:
  Table(const Spreadsheet &sheet, const std::string &file) : sheet_(sheet), file_(file) {}

  SectionRows read() {
    for (const SpreadsheetRow &row : sheet_.rows) lower(row.cells[0]) == "part" ? take_header(row) : take(row);
    return table_;
  }

 private:
  [[noreturn]] void complain(const SpreadsheetRow &row, const std::string &text) const {
    std::string cells;
    for (const std::string &cell : row.cells) cells += (cells.empty() ? "" : ",") + cell;
    throw std::invalid_argument(file_ + " line " + std::to_string(row.line) + ": '" + cells + "' " + text);
  }

  void take(const SpreadsheetRow &row) {
    SectionRow one{row.cells[0], {}, row.line};
    if (row.cells.size() != 3 || one.part.empty() || !sheet_.number(row.cells[1], one.numbers[0]) ||
        !sheet_.number(row.cells[2], one.numbers[1]))
      complain(row, "must be a row part,x,y with two numbers, in metres or in the unit of a header part,x [ft],y [ft]");
    table_.rows.push_back(one);
  }

  /// The unit in a cell `x [ft]` or `x (ft)` of a header; empty where the cell is the axis alone.
  std::string unit_in(const SpreadsheetRow &row, std::size_t column, char axis) const {
    constexpr const char *form = "must be a header part,x,y or, with a unit, part,x [ft],y [ft]";
    if (row.cells.size() != 3) complain(row, form);
    const std::string cell = row.cells[column];
    if (cell.empty() || std::tolower(static_cast<unsigned char>(cell[0])) != axis) complain(row, form);
    const std::size_t open = cell.find_first_not_of(" \t", 1);
    if (open == std::string::npos) return "";
    if (!(cell[open] == '[' && cell.back() == ']') && !(cell[open] == '(' && cell.back() == ')')) complain(row, form);
    const std::string inside = cell.substr(open + 1, cell.size() - open - 2);
    const std::size_t first = inside.find_first_not_of(" \t");
    if (first == std::string::npos) complain(row, form);
    return inside.substr(first, inside.find_last_not_of(" \t") - first + 1);
  }

  void take_header(const SpreadsheetRow &row) {
    const std::string sign = lower(unit_in(row, 1, 'x')), other = lower(unit_in(row, 2, 'y'));
    if (sign != other) complain(row, "must state the same unit for x and y");
    if (sign.empty()) return;
    const auto *unit = std::ranges::find_if(
        length_units, [&](const LengthUnit &one) { return lower(one.sign) == sign || one.name == sign; });
    if (unit == std::end(length_units))
      complain(row, "states no unit that sections are drawn in: take one of " + known_length_units());
    if (!table_.rows.empty() && table_.unit.sign != std::string(unit->sign))
      complain(row, "states another unit than the rows above it have, " + std::string(table_.unit.name) +
                        "; give all points of a section in one unit, with the header above them");
    table_.unit = *unit, table_.stated = "line " + std::to_string(row.line);
  }

  const Spreadsheet &sheet_;
  const std::string &file_;
  SectionRows table_;
};

class Reader {
 public:
  Reader(const std::string &file, bool drawn) { section_.file = file, section_.drawn = drawn; }

  Section read(const SectionRows &source) {
    const std::vector<SectionRow> &rows = source.rows;
    section_.unit = source.unit, section_.unit_stated = source.stated;
    if (rows.size() > most_points)
      complain(section_, rows.back().line,
               "the section has " + std::to_string(rows.size()) + " points, more than the " +
                   std::to_string(most_points) +
                   " that are taken; leave out points that are closer than cells are wide");
    for (SectionRow row : rows) {
      for (double &number : row.numbers) number *= section_.unit.metres;
      take(row);
    }
    for (const auto &[number, polyline] : interfaces_) section_.interfaces.push_back(polyline);
    for (const auto &[name, polyline] : boundaries_) section_.boundaries.push_back(polyline);
    for (const auto &[part, rows] : boxes_) add_boxes(part, rows);
    return section_;
  }

 private:
  Section section_;
  std::map<int, Polyline> interfaces_;
  std::map<std::string, Polyline> boundaries_;
  std::map<std::string, std::vector<SectionRow>> boxes_;

  static void append(Polyline &polyline, const std::string &part, const SectionRow &row) {
    polyline.part = part;
    polyline.points.push_back(row.numbers);
    polyline.lines.push_back(row.line);
  }

  std::string name_in(const SectionRow &row, const std::string &start) const {
    const std::string name = row.part.substr(start.size());
    if (name.empty()) complain(section_, row.line, "'" + row.part + "' must be followed by a name");
    return name;
  }

  void take(const SectionRow &row) {
    double number;
    if (row.part == "outline") {
      append(section_.outline, row.part, row);
    } else if (starts_with(row.part, "interface") && is_number(row.part.substr(9), number) &&
               number == std::floor(number) && std::abs(number) <= most_points) {
      append(interfaces_[static_cast<int>(number)], row.part, row);
    } else if (starts_with(row.part, "b_")) {
      const std::string name = name_in(row, "b_");
      append(boundaries_[name], name, row);
    } else if (starts_with(row.part, "region_")) {
      section_.seeds.push_back({name_in(row, "region_"), row.numbers, row.line});
    } else if (starts_with(row.part, "refine_")) {
      boxes_[row.part].push_back(row);
    } else if (row.part == "free_space") {
      if (row.numbers[0] <= 0) complain(section_, row.line, "the height of the free space must be above 0 m");
      if (section_.has_free_space)
        complain(section_, row.line, "a section has one row of free_space, this is a second");
      section_.has_free_space = true;
      section_.free_height = row.numbers[0], section_.free_extra = row.numbers[1];
    } else {
      complain(section_, row.line,
               "'" + row.part +
                   "' is no part of a section; parts are outline, interfaceN, b_NAME, region_NAME, refine_SIZE "
                   "and free_space");
    }
  }

  void add_boxes(const std::string &part, const std::vector<SectionRow> &rows) {
    double size;
    if (!is_number(part.substr(7), size) || size <= 0)
      complain(section_, rows[0].line, "'" + part + "' must be refine_SIZE with a cell size above 0 m");
    if (rows.size() % 2)
      complain(section_, rows.back().line, "'" + part + "' needs a second row with the opposite corner of the box");
    for (std::size_t i = 0; i < rows.size(); i += 2) {
      const Vec<2> &a = rows[i].numbers, &b = rows[i + 1].numbers;
      if (a[0] == b[0] || a[1] == b[1]) complain(section_, rows[i + 1].line, "the box of '" + part + "' has no area");
      section_.boxes.push_back({{std::min(a[0], b[0]), std::min(a[1], b[1])},
                                {std::max(a[0], b[0]), std::max(a[1], b[1])},
                                size * section_.unit.metres});
    }
  }
};

std::string segment_text(const Polyline &p, std::size_t i) {
  const std::size_t j = (i + 1) % p.points.size();
  std::ostringstream text;
  text << "(" << p.points[i][0] << ", " << p.points[i][1] << ")-(" << p.points[j][0] << ", " << p.points[j][1] << ") m";
  return text.str();
}

void check_outline(const Section &section, double tolerance) {
  const Polyline &outline = section.outline;
  const auto &x = outline.points;
  const std::size_t count = x.size();
  if (count == 0) throw std::invalid_argument(section.file + ": has no outline; give rows outline,x,y");
  if (count < 3) complain(section, outline.lines.back(), "an outline needs at least 3 points");
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::hypot(x[i][0] - x[j][0], x[i][1] - x[j][1]) <= same_point * section.largest_extent())
        complain(section, outline.lines[i],
                 "repeats the point of line " + std::to_string(outline.lines[j]) +
                     "; leave it out (an outline closes itself)");
  const auto crosses = [&](std::size_t i, std::size_t j) {
    const Vec<2> &a = x[i], &b = x[(i + 1) % count], &c = x[j], &d = x[(j + 1) % count];
    if ((j + 1) % count == i)
      return distance_to_segment(a, b, c) <= tolerance || distance_to_segment(c, d, b) <= tolerance;
    if ((i + 1) % count == j)
      return distance_to_segment(a, b, d) <= tolerance || distance_to_segment(c, d, a) <= tolerance;
    return segments_meet(a, b, c, d, tolerance);
  };
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (crosses(i, j))
        complain(section, outline.lines[i],
                 "the outline crosses itself: segment " + segment_text(outline, i) + " meets segment " +
                     segment_text(outline, j) + " of line " + std::to_string(outline.lines[j]) +
                     "; give its points in order around the section");
}

/// Some piece of the polyline lies inside the domain, or, for boundaries, on its edge. Pieces are cut finely.
bool reaches(const Polyline &polyline, const std::vector<Vec<2>> &domain, bool edge_counts, double tolerance) {
  const int pieces = static_cast<int>(std::max<std::size_t>(1, 1000 / polyline.points.size()));
  for (std::size_t i = 0; i + 1 < polyline.points.size(); ++i)
    for (int k = 0; k < pieces; ++k) {
      const Vec<2> &a = polyline.points[i], &b = polyline.points[i + 1];
      const double t = (k + 0.5) / pieces;
      const Vec<2> x{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
      const bool on_edge = distance_to_polygon(domain, x) <= tolerance;
      if (on_edge ? edge_counts : is_inside(domain, x)) return true;
    }
  return false;
}

/// A ray upward crosses the interface an odd number of times from below it; its ends go on horizontally for ever.
bool is_below(const Polyline &polyline, const Vec<2> &x, double extent) {
  const auto crossed = [&](const Vec<2> &a, const Vec<2> &b) {
    return (a[0] <= x[0]) != (b[0] <= x[0]) && a[1] + (x[0] - a[0]) / (b[0] - a[0]) * (b[1] - a[1]) > x[1];
  };
  const auto &p = polyline.points;
  const bool rightward = p.front()[0] <= p.back()[0];
  const double far = 1e3 * (extent + std::abs(x[0]) + std::abs(p.front()[0]) + std::abs(p.back()[0]));
  bool below = crossed({rightward ? -far : far, p.front()[1]}, p.front());
  for (std::size_t i = 0; i + 1 < p.size(); ++i) below ^= crossed(p[i], p[i + 1]);
  return below ^ crossed(p.back(), {rightward ? far : -far, p.back()[1]});
}

/// A point on a polyline, and the piece that begins there or before it.
struct Station {
  Vec<2> point;
  std::size_t piece;
};

double distance(const Vec<2> &a, const Vec<2> &b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

/// The points of `line` and those of `other` that lie on it, in order.
std::vector<Station> stations_along(const Polyline &line, const Polyline &other, double tolerance) {
  std::vector<Station> stations;
  for (std::size_t k = 0; k + 1 < line.points.size(); ++k) {
    const Vec<2> &a = line.points[k], &b = line.points[k + 1];
    stations.push_back({a, k});
    const auto first = static_cast<std::ptrdiff_t>(stations.size());
    for (const Vec<2> &x : other.points)
      if (distance_to_segment(a, b, x) <= tolerance && distance(a, x) > tolerance && distance(b, x) > tolerance)
        stations.push_back({x, k});
    std::sort(stations.begin() + first, stations.end(),
              [&](const Station &s, const Station &t) { return distance(a, s.point) < distance(a, t.point); });
  }
  stations.push_back({line.points.back(), line.points.size() - 2});
  return stations;
}

/// Where `line` touches `other`, not at an end of that one, and goes on at its other side; nothing without such a
/// place.
std::optional<Station> passage(const Polyline &line, const Polyline &other, double extent, double tolerance) {
  const std::vector<Station> stations = stations_along(line, other, tolerance);
  std::optional<bool> below;
  for (std::size_t s = 0; s + 1 < stations.size(); ++s) {
    const Vec<2> &a = stations[s].point, &b = stations[s + 1].point, middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
    if (is_on(other, middle, tolerance)) continue;
    const bool now = is_below(other, middle, extent);
    if (below && now != *below && is_on(other, a, tolerance) &&
        std::min(distance(a, other.points.front()), distance(a, other.points.back())) > tolerance)
      return stations[s];
    below = now;
  }
  return std::nullopt;
}

/// The piece of a polyline that a point lies on.
std::size_t piece_at(const Polyline &line, const Vec<2> &x) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k + 1 < line.points.size(); ++k)
    if (distance_to_segment(line.points[k], line.points[k + 1], x) <
        distance_to_segment(line.points[nearest], line.points[nearest + 1], x))
      nearest = k;
  return nearest;
}

void check_polyline(const Section &section, const Polyline &polyline, const std::string &what, bool edge_counts,
                    const std::vector<Vec<2>> &domain, double tolerance) {
  if (polyline.points.size() < 2) complain(section, polyline.lines.back(), what + " needs at least 2 points");
  for (std::size_t i = 1; i < polyline.points.size(); ++i)
    if (std::hypot(polyline.points[i][0] - polyline.points[i - 1][0],
                   polyline.points[i][1] - polyline.points[i - 1][1]) <= same_point * section.largest_extent())
      complain(section, polyline.lines[i], what + " repeats its last point; leave it out");
  if (!reaches(polyline, domain, edge_counts, tolerance))
    complain(section, polyline.lines[0],
             what + " lies outside the outline" + (edge_counts ? "" : " or only on it") + "; move it into the section");
}

void check(const Section &section) {
  double extent = section.outline.points.empty() ? 0 : section.largest_extent();
  const double tolerance = 1e-9 * extent;
  check_outline(section, tolerance);
  const std::vector<Vec<2>> domain = section.domain();
  for (const Polyline &p : section.interfaces)
    check_polyline(section, p, "the interface '" + p.part + "'", false, domain, tolerance);
  for (const Polyline &p : section.boundaries)
    check_polyline(section, p, "the boundary 'b_" + p.part + "'", true, domain, tolerance);
  for (const Seed &seed : section.seeds)
    if (!is_inside(domain, seed.point))
      complain(section, seed.line, "the point region_" + seed.name + " lies outside the section");
}

}  // namespace

double Section::largest_extent() const {
  double extent = 0;
  for (int d = 0; d < 2; ++d) {
    const auto [low, high] = std::minmax_element(outline.points.begin(), outline.points.end(),
                                                 [d](const auto &a, const auto &b) { return a[d] < b[d]; });
    extent = std::max(extent, (*high)[d] - (*low)[d]);
  }
  return extent;
}

std::vector<Vec<2>> Section::domain() const {
  std::vector<Vec<2>> x = outline.points;
  if (!has_free_space) return x;
  if (signed_area(x) < 0) std::reverse(x.begin(), x.end());
  const auto lower_left = std::min_element(x.begin(), x.end());
  std::rotate(x.begin(), lower_left, x.end());
  const auto lower_right = std::min_element(
      x.begin(), x.end(), [](const auto &a, const auto &b) { return a[0] != b[0] ? a[0] > b[0] : a[1] < b[1]; });
  const double top = free_height + (*std::max_element(x.begin(), x.end(),
                                                      [](const auto &a, const auto &b) { return a[1] < b[1]; }))[1];
  std::vector<Vec<2>> domain(x.begin(), lower_right + 1);  // counter-clockwise, so this is the underside
  const double left = x.front()[0] + std::min(0., free_extra), right = (*lower_right)[0] + std::max(0., free_extra);
  if (free_extra > 0) domain.push_back({right, (*lower_right)[1]});
  domain.push_back({right, top});
  domain.push_back({left, top});
  if (free_extra < 0) domain.push_back({left, x.front()[1]});
  return domain;
}

namespace {

std::string doubt_about_unit(const Section &section) {
  if (section.unit.metres != 1)
    return section.file + ": all numbers are in " + section.unit.name + " (" + section.unit_stated +
           ") and turned into metres";
  if (section.drawn && section.unit_stated.empty())
    return section.file +
           ": the drawing names no unit ($INSUNITS), and its coordinates are taken as metres; set the "
           "unit in the drawing";
  return "";
}

std::string doubt_about_free_face(const Section &section) {
  constexpr double low = 0.1;    // of the height of the soil: a lower face decides little
  constexpr double steep = 0.2;  // width over height of a face that counts as the end of the soil
  if (!section.has_free_space || section.free_extra == 0) return "";
  const auto &x = section.outline.points;
  const double sign = section.free_extra > 0 ? 1 : -1;
  const auto beyond = [&](const Vec<2> &a, const Vec<2> &b) { return sign * a[0] < sign * b[0]; };
  const auto above = [](const Vec<2> &a, const Vec<2> &b) { return a[1] < b[1]; };
  const double end = (*std::max_element(x.begin(), x.end(), beyond))[0];
  const double height =
      (*std::max_element(x.begin(), x.end(), above))[1] - (*std::min_element(x.begin(), x.end(), above))[1];
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec<2> &a = x[i], &b = x[(i + 1) % x.size()];
    const double rise = std::abs(b[1] - a[1]), tolerance = 1e-6 * section.largest_extent();
    const bool at_end = std::abs(a[0] - end) <= tolerance || std::abs(b[0] - end) <= tolerance;
    if (!at_end || rise <= low * height || std::abs(b[0] - a[0]) > steep * rise) continue;
    if (std::any_of(section.boundaries.begin(), section.boundaries.end(),
                    [&](const Polyline &line) { return is_on(line, a, tolerance) && is_on(line, b, tolerance); }))
      continue;
    std::ostringstream text;
    text
        << "free_space leaves the " << (sign > 0 ? "right" : "left")
        << " end of the soil free: its steep face at x = " << end << " m, y = " << std::min(a[1], b[1]) << " to "
        << std::max(a[1], b[1])
        << " m, has air beyond it, and the soil falls out there unless it stands as a cut. Where the ground goes on in "
           "nature, draw the outline on to the end of the run-out and give free_space no extra width; a face that is "
           "meant is named by b_NAME along it";
    return text.str();
  }
  return "";
}

/// An interface all of which lies above one that is listed before it, where layers are told by their number.
std::string doubt_about_order(const Section &section) {
  const double extent = section.largest_extent(), tolerance = 1e-9 * extent;
  const std::vector<Polyline> &lines = section.interfaces;
  if (section.seeds.size() > lines.size()) return "";  // each layer has a name of its own
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    const Polyline &upper = lines[i], &lower = lines[i + 1];
    int above = 0, below = 0;
    const auto compare = [&](const Polyline &one, const Polyline &other, int &over, int &under) {
      for (const Vec<2> &x : one.points)
        if (!is_on(other, x, tolerance)) ++(is_below(other, x, extent) ? under : over);
    };
    compare(lower, upper, above, below), compare(upper, lower, below, above);
    if (above == 0 || below > 0) continue;
    std::ostringstream text;
    text << "'" << lower.part << "' (line " << lower.lines[0] << ") lies above '" << upper.part << "' (line "
         << upper.lines[0]
         << "), and interfaces are numbered from top to bottom. Layers count from the top whatever these numbers are: "
            "layer0 lies above all interfaces, layer"
         << lines.size()
         << " below all of them. Number the interfaces from the top, or name each layer by a point region_NAME";
    return text.str();
  }
  return "";
}

}  // namespace

std::vector<std::string> Section::doubts() const {
  std::vector<std::string> sentences;
  for (const std::string &sentence : {doubt_about_unit(*this), doubt_about_free_face(*this), doubt_about_order(*this)})
    if (!sentence.empty()) sentences.push_back(sentence);
  return sentences;
}

double Section::area() const { return std::abs(signed_area(domain())); }

std::string Section::layer_at(const Vec<2> &x) const {
  if (has_free_space && !is_inside(outline.points, x)) return "air";
  int layer = 0;
  for (const Polyline &polyline : interfaces) layer += is_below(polyline, x, largest_extent());
  return "layer" + std::to_string(layer);
}

Section section_of(const SectionRows &rows, const std::string &file, bool drawn) {
  Section section = Reader(file, drawn).read(rows);
  check(section);
  return section;
}

Section read_section(const std::string &file) {
  const Spreadsheet sheet = read_spreadsheet(file);
  return section_of(Table(sheet, file).read(), file, false);
}

std::optional<Crossing> crossing_interfaces(const Section &section) {
  const auto opposite = [](double a, double b) { return (a > 0 && b < 0) || (a < 0 && b > 0); };
  const auto &lines = section.interfaces;
  const double extent = section.largest_extent(), tolerance = 1e-9 * extent;
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k + 1 < lines[i].points.size(); ++k)
        for (std::size_t l = 0; l + 1 < lines[j].points.size(); ++l) {
          const Vec<2> &a = lines[i].points[k], &b = lines[i].points[k + 1], &c = lines[j].points[l],
                       &d = lines[j].points[l + 1];
          const double at_a = cross(c, d, a), at_b = cross(c, d, b);
          if (!opposite(at_a, at_b) || !opposite(cross(a, b, c), cross(a, b, d))) continue;
          const double t = at_a / (at_a - at_b);
          return Crossing{&lines[j],
                          &lines[i],
                          {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])},
                          lines[j].lines[l],
                          lines[i].lines[k]};
        }
      if (const auto at = passage(lines[i], lines[j], extent, tolerance))
        return Crossing{&lines[j], &lines[i], at->point, lines[j].lines[piece_at(lines[j], at->point)],
                        lines[i].lines[at->piece]};
    }
  return std::nullopt;
}

bool is_on(const Polyline &line, const Vec<2> &x, double tolerance) {
  for (std::size_t i = 0; i + 1 < line.points.size(); ++i)
    if (distance_to_segment(line.points[i], line.points[i + 1], x) <= tolerance) return true;
  return false;
}

}  // namespace talus
