#include "scene/describe.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/tables.h"
#include "scene/usual.h"
#include "scene/words.h"

namespace talus {
namespace {

std::string rounded(double value) {
  std::ostringstream text;
  text.precision(10);  // hides the last digits of a default that went from degrees to radians and back
  text << value;
  return shortest(std::stod(text.str()));
}

bool plain(Unit unit) { return unit.dimension == Dimension{}; }

std::string number_in(Unit unit) { return plain(unit) ? "number" : unit.name; }

bool has_time(const char *variables) { return std::string(variables).find('t') != std::string::npos; }

std::string usually(const Usual &usual) { return has_usual(usual) ? ", usual " + text_of(usual, one) : ""; }

std::string from_to(const Range &range) {
  return rounded(range.low) + " to " + rounded(range.high) + usually(range.usual);
}

std::string coordinates(const std::vector<double> &point, Unit unit) {
  std::string text;
  for (const double coordinate : point) text += (text.empty() ? "" : ", ") + rounded(coordinate / unit.si);
  return text.empty() ? "" : "[" + text + "]";
}

bool placeholder(const std::string &word) { return word == "NAME" || word == "N"; }

/// Does the path begin with the words of the query? A placeholder is passed over, or stands for a word before the
/// query's last.
bool begins(const std::vector<std::string> &path, std::size_t i, const std::vector<std::string> &query, std::size_t j) {
  if (j == query.size()) return true;
  if (i == path.size()) return false;
  const bool inside = j + 1 < query.size();
  if (placeholder(path[i])) return begins(path, i + 1, query, j) || (inside && begins(path, i + 1, query, j + 1));
  return path[i] == query[j] && begins(path, i + 1, query, j + 1);
}

bool matches(const Describer::Key &key, const std::string &query) {
  const std::vector<std::string> path = split(key.path);
  return begins(path, 0, split(query), 0) || path.back() == query;
}

/// What could have been meant: last words of keys, their paths, and kinds.
std::vector<std::string> names(const std::vector<Describer::Block> &blocks) {
  std::vector<std::string> all;
  for (const Describer::Block &block : blocks) {
    if (!block.kind.empty()) all.push_back(block.kind);
    for (const Describer::Key &key : block.keys) {
      std::string path;
      for (const std::string &word : split(key.path))
        if (!placeholder(word)) path += (path.empty() ? "" : ".") + word;
      all.push_back(split(key.path).back());
      all.push_back(path);
    }
  }
  return all;
}

/// A Markdown table whose columns line up in a terminal too.
void print_block(std::ostream &out, const Describer::Block &block) {
  const auto cells = [](const Describer::Key &key) {
    return std::vector<std::string>{split(key.path).back(), key.allowed, key.initial, key.meaning};
  };
  std::vector<std::vector<std::string>> rows = {{"key", "value", "default", "meaning"}};
  for (const Describer::Key &key : block.keys) rows.push_back(cells(key));
  std::vector<std::size_t> width(rows[0].size());
  for (const auto &row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  width.back() = rows[0].back().size();  // the last column is long and need not line up

  const auto print_row = [&](const std::vector<std::string> &row, char fill) {
    for (std::size_t c = 0; c < row.size(); ++c)
      out << "| " << row[c] << std::string(width[c] - std::min(width[c], row[c].size()), fill) << ' ';
    out << "|\n";
  };
  out << "## " << block.title << "\n\n";
  if (!block.meaning.empty()) out << block.meaning << "\n\n";
  if (block.keys.empty()) return;
  print_row(rows[0], ' ');
  print_row(std::vector<std::string>(width.size()), '-');
  for (std::size_t r = 1; r < rows.size(); ++r) print_row(rows[r], ' ');
  out << "\n";
}

}  // namespace

void Describer::print(std::ostream &out, const std::string &key) const {
  bool found = false;
  for (const Block &block : blocks_) {
    Block shown = block;
    if (!key.empty() && block.kind != key) std::erase_if(shown.keys, [&](const Key &k) { return !matches(k, key); });
    if (shown.keys.empty() && block.kind != key && !key.empty()) continue;
    print_block(out, shown);
    found = true;
  }
  if (found) return;
  const std::string near = nearest(key, names(blocks_));
  throw SceneError("no key `" + key + "` is known; " +
                   (near.empty() ? "`talus describe` prints them all" : "did you mean `" + near + "`?"));
}

std::string Describer::path_to(const std::string &key) const {
  const std::string &path = blocks_[current_].path;
  return path.empty() ? key : path + "." + key;
}

void Describer::line(const char *key, std::string allowed, std::string initial, const char *meaning, Unit unit,
                     bool over_time) {
  blocks_[current_].keys.push_back(
      {path_to(key), std::move(allowed), std::move(initial), meaning, plain(unit) ? "" : unit.name, over_time});
}

void Describer::number(const char *key, double value, Unit unit, Range range, const char *meaning) {
  line(key, number_in(unit) + ", " + from_to(range), std::isnan(value) ? "required" : rounded(value / unit.si), meaning,
       unit);
}

void Describer::by_place(const char *key, double value, bool, Unit unit, Range range, const char *meaning) {
  line(key, number_in(unit) + ", " + from_to(range) + ", function of place",
       std::isnan(value) ? "required" : rounded(value / unit.si), meaning, unit);
}

void Describer::integer(const char *key, int value, Range range, const char *meaning) {
  line(key, "whole number, " + from_to(range), std::to_string(value), meaning);
}

void Describer::flag(const char *key, bool value, const char *meaning) {
  line(key, "true or false", value ? "true" : "false", meaning);
}

void Describer::text(const char *key, const std::string &value, const char *meaning) {
  line(key, "text", value, meaning);
}

void Describer::path(const char *key, const std::string &value, const char *meaning) {
  line(key, "path", value, meaning);
}

void Describer::quantities(const char *key, const std::vector<double> &, const char *meaning) {
  line(key, "list of numbers or quantities", "", meaning);
}

void Describer::texts(const char *key, const std::vector<std::string> &value, const char *meaning) {
  line(key, "text or list of texts", join(value), meaning);
}

void Describer::point(const char *key, const std::vector<double> &value, Unit unit, const char *meaning) {
  line(key, number_in(unit) + ", list", coordinates(value, unit), meaning, unit);
}

void Describer::point(const char *key, const std::vector<double> &value, Unit unit, const Usual &usual,
                      const char *meaning) {
  line(key, number_in(unit) + ", list" + usually(usual), coordinates(value, unit), meaning, unit);
}

void Describer::points(const char *key, const std::vector<std::vector<double>> &value, Unit unit, const char *meaning) {
  std::string initial;
  for (const std::vector<double> &point : value) initial += (initial.empty() ? "" : ", ") + coordinates(point, unit);
  line(key, number_in(unit) + ", list of points", initial, meaning, unit);
}

void Describer::water_table(const char *key, const WaterTable &, Unit unit, const char *meaning) {
  line(key, number_in(unit) + std::string(", list of points [x, elevation], or an expression of ") + of::place, "",
       meaning, unit);
}

void Describer::function(const char *key, const Function &value, Unit unit, Range range, const char *variables,
                         const char *meaning) {
  line(key, number_in(unit) + ", " + from_to(range) + ", function of " + variables,
       value.constant() ? rounded(value(0) / unit.si) : "", meaning, unit, has_time(variables));
}

void Describer::functions(const char *key, const std::vector<Function> &, Unit unit, const char *variables,
                          const char *meaning) {
  line(key, number_in(unit) + ", list of functions of " + variables, "", meaning, unit, has_time(variables));
}

void Describer::elasticity(double, double) {
  const std::string stiffness = "Pa, above 0" + usually(elastic::stiffness.usual);
  line("young_modulus", stiffness, "two of four", "Young's modulus E", pascal);
  line("poisson_ratio", "number, between -1 and 0.5" + usually(elastic::poisson_ratio.usual), "two of four",
       "Poisson's ratio nu");
  line("shear_modulus", stiffness, "two of four", "shear modulus G", pascal);
  line("bulk_modulus", stiffness, "two of four", "bulk modulus K", pascal);
}

void Describer::deferred(const char *key, const DeferredTable &, const char *meaning) {
  line(key, "name of a kind", "required", meaning);
}

void Describer::deferred_table(const char *key, const DeferredTable &, const char *meaning) {
  line(key, "table [" + path_to(key) + "]", "", meaning);
}

void describe_scene(Describer &describer) {
  describer.add({"Scene", "", "Numbers are SI, angles in degrees, or quantities with a unit: \"20 MPa\".", "", {}},
                Scene{});
  describer.add({"[functions]",
                 "functions",
                 "Functions of time that expressions call by name: excess = \"1e3 * rain(t)\".",
                 "",
                 {{"functions.NAME", "expression of t or list of [t, value] points", "",
                   "function of time, values in SI or with a unit"}}});
  describer.add(
      {"[grids]",
       "grids",
       "Grid files that expressions call by name at a place: excess = \"max(0, 9810 * (water(x, y) - z))\".",
       "",
       {{"grids.NAME", "path", "",
         "grid of values (ESRI ASCII, GeoTIFF), relative to the scene; called with x and y of the mesh, linear "
         "between its nodes; counts in the coordinates of the terrain, or of the mesh where there is none"}}});
}

void describe_scene(std::ostream &out, const std::string &key) {
  Describer describer;
  describe_scene(describer);
  describer.print(out, key);
}

}  // namespace talus
