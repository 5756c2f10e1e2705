#include "meshes/drawing_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "meshes/spreadsheet.h"

namespace talus {
namespace {

struct Group {
  int code, line;  ///< line of the value in the file
  std::string value;
};

/// Groups without which an entity of a kind says nothing, or GDAL would take a number that the file does not have.
const std::map<std::string, std::vector<int>> needed{{"LINE", {10, 20, 11, 21}},
                                                     {"LWPOLYLINE", {90}},
                                                     {"POLYLINE", {}},
                                                     {"VERTEX", {10, 20}},
                                                     {"ARC", {10, 20, 40, 50, 51}},
                                                     {"CIRCLE", {10, 20, 40}},
                                                     {"ELLIPSE", {10, 20, 11, 21, 40, 41, 42}},
                                                     {"SPLINE", {71, 72, 73}},
                                                     {"POINT", {10, 20}},
                                                     {"TEXT", {10, 20}},
                                                     {"MTEXT", {10, 20}},
                                                     {"INSERT", {2, 10, 20}}};

bool in(int code, std::initializer_list<std::array<int, 2>> ranges) {
  return std::ranges::any_of(ranges, [=](const auto &range) { return range[0] <= code && code <= range[1]; });
}
bool is_real(int code) { return in(code, {{10, 59}, {110, 149}, {210, 239}, {460, 469}, {1010, 1059}}); }
bool is_whole(int code) {
  return in(code,
            {{60, 79}, {90, 99}, {160, 179}, {270, 289}, {370, 389}, {400, 409}, {420, 429}, {440, 459}, {1060, 1071}});
}

class Scanner {
 public:
  Scanner(const std::string &file, const std::function<bool(const std::string &)> &used) : file_(file), used_(used) {
    read_groups();
    for (at_ = 0; at_ < groups_.size();) take();
    for (const auto &[line, name] : inserted_)
      if (!blocks_.count(name))
        complain(line, "inserts the block '" + name + "', which the drawing does not have; bind or explode it");
    if (!has_entities_) complain(groups_.back().line, "the drawing ends without a section ENTITIES, so it is empty");
  }
  DrawingText text;

 private:
  [[noreturn]] void complain(int line, const std::string &what) const {
    throw std::invalid_argument(file_ + " line " + std::to_string(line) + ": " + what);
  }

  void read_groups() {
    const std::vector<std::string> lines = text_lines(file_, "DXF in text form (ASCII)");
    for (std::size_t i = 0; i < lines.size(); i += 2) {
      const std::string code = trim(lines[i]);
      Group group{0, static_cast<int>(i) + 2, i + 1 < lines.size() ? lines[i + 1] : ""};
      if (i + 2 >= lines.size() && trim(code + group.value).empty()) break;  // blank lines at the end
      const auto [end, error] = std::from_chars(code.data(), code.data() + code.size(), group.code);
      if (error != std::errc() || end != code.data() + code.size() || code.empty())
        complain(group.line - 1, std::string("'") + lines[i].substr(0, 40) +
                                     "' stands where a DXF file has the code of a group, a whole number: this is no "
                                     "DXF file in text form, or a line is missing above. Save the drawing again");
      if (group.code == 0) group.value = trim(group.value);
      groups_.push_back(group);
      if (group.code == 0 && group.value == "EOF") return;
    }
    int last = static_cast<int>(lines.size());
    while (last > 1 && trim(lines[last - 1]).empty()) --last;
    complain(last, "the drawing ends here without the group EOF, so that its end is missing; save or fetch it again");
  }

  bool begins(const char *kind) const { return groups_[at_].code == 0 && groups_[at_].value == kind; }

  void take() {
    const Group &group = groups_[at_];
    if (begins("SECTION")) {
      if (!section_.empty()) not_closed(group);
      if (at_ + 1 == groups_.size() || groups_[at_ + 1].code != 2)
        complain(group.line, "the SECTION has no name; save the drawing again");
      section_ = trim(groups_[at_ + 1].value), has_entities_ |= section_ == "ENTITIES";
    } else if (begins("EOF")) {
      if (!section_.empty()) not_closed(group);
    } else if (begins("ENDSEC")) {
      if (section_.empty()) complain(group.line, "ENDSEC ends no section; save the drawing again");
      section_.clear();
    } else if (section_.empty() && group.code != 999) {
      complain(group.line, "'" + group.value + "' stands outside of the sections; save the drawing again");
    } else if (section_ == "HEADER" && group.code == 9 && trim(group.value) == "$INSUNITS") {
      take_unit();
    } else if (group.code == 0 && (section_ == "ENTITIES" || section_ == "BLOCKS")) {
      return take_entity();
    }
    copy(group), ++at_;
  }

  [[noreturn]] void not_closed(const Group &group) const {
    complain(group.line, group.value + " stands within the section " + section_ +
                             ", which no ENDSEC ends: a part of the drawing is missing; save or fetch it again");
  }

  void take_unit() {
    const Group &next = groups_[at_ + 1];  // EOF at the latest
    double number;
    if (next.code != 70 || !is_number(next, number))
      complain(next.line, "$INSUNITS must be followed by group 70 with the number of a unit, not '" + next.value + "'");
    text.unit = static_cast<int>(number);
  }

  static bool is_number(const Group &group, double &value) {
    return Spreadsheet{}.number(trim(group.value), value) &&
           (!is_whole(group.code) || (value == std::floor(value) && std::abs(value) < 1e10));
  }

  void copy(const Group &group) { text.marked += std::to_string(group.code) + "\n" + group.value + "\n"; }

  /// One that begins here, up to the next; a polyline with its vertices.
  void take_entity() {
    const std::size_t first = at_;
    const std::string kind = groups_[first].value;
    std::string layer = "0";
    for (++at_; groups_[at_].code != 0; ++at_)
      if (groups_[at_].code == 8) layer = layer_name(groups_[at_].value);
    const int line = groups_[first].line;
    const bool in_block = section_ == "BLOCKS";
    if (kind == "BLOCK") {
      for (std::size_t k = first; k < at_; ++k)
        if (groups_[k].code == 2) blocks_.insert(layer_name(groups_[k].value));
    } else if (kind != "ENDBLK" && kind != "SEQEND") {
      if (!in_block && kind != "VERTEX") text.entities[line] = {kind, layer};
      const bool inserted = kind == "INSERT", in_polyline = kind == "VERTEX" && checks_vertices_;
      if (used_(layer) || inserted || in_polyline || (in_block && layer == "0" && needed.count(kind)))
        check(kind, layer, first);
    }
    const bool is_polyline = kind == "POLYLINE";
    copy(groups_[first]);
    if (kind != "BLOCK" && kind != "ENDBLK" && kind != "VERTEX" && kind != "SEQEND") {
      std::ostringstream handle;
      handle << std::hex << std::uppercase << line;
      copy({5, line, handle.str()});
    }
    for (std::size_t k = first + 1; k < at_; ++k) {
      if (groups_[k].code == 5) continue;
      const bool block = groups_[k].code == 2 && (kind == "BLOCK" || kind == "INSERT");  // GDAL tells capitals apart
      copy(block ? Group{2, groups_[k].line, layer_name(groups_[k].value)} : groups_[k]);
    }
    if (!is_polyline) return;
    checks_vertices_ = used_(layer) || (in_block && layer == "0");
    int vertices = 0;
    while (begins("VERTEX")) ++vertices, take_entity();
    if (checks_vertices_ && !begins("SEQEND"))
      complain(groups_[at_].line, name(kind, layer) + ", which begins in line " + std::to_string(line) +
                                      ", has no SEQEND before this; save the drawing again");
    if (checks_vertices_ && vertices < 2) complain(line, name(kind, layer) + of_vertices(vertices));
    checks_vertices_ = false;
  }

  static std::string name(const std::string &kind, const std::string &layer) {
    return "the " + kind + " on layer '" + layer + "'";
  }
  static std::string of_vertices(std::size_t count) {
    return " has " + (count ? std::string("1 vertex") : "no vertices") + ", and a line needs 2; delete it, or draw it";
  }

  /// Groups of one entity.
  void check(const std::string &kind, const std::string &layer, std::size_t first) {
    const int line = groups_[first].line;
    const auto required = needed.find(kind);
    if (required == needed.end())
      complain(line, name(kind, layer) +
                         " is neither a line nor a point that is read: explode it into lines and polylines, or move "
                         "it to a layer that is no part of a section");
    std::map<int, std::size_t> count;
    std::map<int, double> last;
    for (std::size_t k = first + 1; k < at_; ++k) {
      const Group &group = groups_[k];
      double value = 0;
      if ((is_real(group.code) || is_whole(group.code)) && !is_number(group, value)) {
        const bool comma = std::count(group.value.begin(), group.value.end(), ',') == 1;
        complain(group.line, "group " + std::to_string(group.code) + " of " + name(kind, layer) + " must be a " +
                                 (is_whole(group.code) ? "whole number" : "number") + ", not '" + group.value + "'" +
                                 (comma ? "; a DXF file has decimal points, so save it again by a program that writes "
                                          "them"
                                        : "; save the drawing again"));
      }
      if (group.code == 10 && count[10] != count[20]) lacks(kind, layer, group.line, 20);
      ++count[group.code], last[group.code] = value;
      if (kind == "INSERT" && group.code == 2) inserted_[line] = layer_name(group.value);
    }
    for (const int code : required->second)
      if (!count[code]) lacks(kind, layer, line, code);
    const auto agree = [&](int stated, int code) {
      if (count[stated] && last[stated] != static_cast<double>(count[code]))
        complain(line, name(kind, layer) + " says that it has " + std::to_string(static_cast<long>(last[stated])) +
                           (code == 40 ? " knots" : " points") + ", and it has " + std::to_string(count[code]) +
                           ": a part is missing; save the drawing again");
    };
    if (count[10] != count[20]) lacks(kind, layer, line, 20);
    if (kind == "LWPOLYLINE") agree(90, 10);
    if (kind == "SPLINE") agree(72, 40), agree(73, 10), agree(74, 11);
    if (kind == "LWPOLYLINE" && count[10] < 2) complain(line, name(kind, layer) + of_vertices(count[10]));
  }

  [[noreturn]] void lacks(const std::string &kind, const std::string &layer, int line, int code) const {
    complain(line, name(kind, layer) + " lacks a number, group " + std::to_string(code) +
                       (code == 10 || code == 11   ? " (x)"
                        : code == 20 || code == 21 ? " (y)"
                                                   : "") +
                       "; draw it again");
  }

  const std::string &file_;
  const std::function<bool(const std::string &)> &used_;
  std::vector<Group> groups_;  ///< the last is EOF
  std::size_t at_ = 0;
  std::string section_;  ///< in which the scanner is; empty: in none
  bool has_entities_ = false, checks_vertices_ = false;
  std::set<std::string> blocks_;
  std::map<int, std::string> inserted_;  ///< names of blocks, by the line that asks for them
};

}  // namespace

std::string layer_name(const std::string &text) {
  std::string name = trim(text);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

DrawingText read_drawing_text(const std::string &file, const std::function<bool(const std::string &)> &used) {
  return Scanner(file, used).text;
}

}  // namespace talus
