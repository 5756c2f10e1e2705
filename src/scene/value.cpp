#include "scene/value.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <regex>
#include <string_view>

#include "base/rounded.h"
#include "scene/quantity.h"
#include "scene/toml_nodes.h"
#include "scene/usual.h"
#include "scene/words.h"

namespace talus {

std::string number_in(Range range, Unit unit) {
  if (std::isinf(range.low)) return in(unit).empty() ? "a number" : "a number in" + in(unit);
  return "a number from " + shortest(range.low) + " to " + shortest(range.high) + in(unit);
}

std::string TableReader::Document::beside(const std::string &name) const {
  if (name.empty()) return name;
  const std::filesystem::path path(name);
  return *files
              .insert(path.is_absolute()
                          ? name
                          : (std::filesystem::path(file).parent_path() / path).lexically_normal().string())
              .first;
}

void TableReader::Value::must_be(const std::string &expected, const std::string &why) const {
  throw SceneError(place(document_->file, *node_, false) + ": " + path_ + written(*node_) + " (" + meaning_ +
                   ") must be " + expected + (why.empty() ? "" : "; " + why));
}

std::string TableReader::Value::string(const std::string &expected) const {
  const auto text = node_->value_exact<std::string>();
  if (!text) must_be(expected);
  return *text;
}

double TableReader::Value::number(Unit unit, Range range) const {
  const double number = is_number() ? number_of(*node_) : quantity(unit, range);
  if (!std::isfinite(number) || !(range.low <= number && number <= range.high))
    must_be(number_in(range, unit), has_usual(range.usual) ? "usual " + text_of(range.usual, unit) : "");
  return number;
}

void TableReader::Value::doubt(double number, Unit unit, const Usual &usual) const {
  if (is_usual(number, usual)) return;
  std::vector<std::string> words = split(path_);
  const auto counts = [](const std::string &word) { return std::ranges::all_of(word, ::isdigit); };
  while (words.size() > 1 && counts(words.back())) words.pop_back();  // a point of a list
  const std::string key = words.back(), path = join(words, ".");
  words.pop_back();
  std::string table;
  if (!words.empty() && counts(words.back())) {  // stage.0
    const toml::table *own = document_->root[words.front()][std::stoul(words.back())].as_table();
    const auto name = own ? (*own)["name"].value<std::string>() : std::nullopt;
    words.back() = name ? '"' + *name + '"' : words.back();
  }
  if (!words.empty()) table = " in " + (words.size() == 1 ? "[" + words[0] + "]" : join(words, " "));
  const std::string meant = is_number() ? unit_meant(number, unit, usual) : "";
  const std::string sentence = place(document_->file, *node_, false) + ": " + key + " = " + rounded(number) + in(unit) +
                               table + "; usual " + text_of(usual, unit) +
                               (meant.empty() ? "" : "; is it in " + meant + "?");
  document_->unusual.try_emplace(path, Doubt{key, sentence});
}

std::vector<TableReader::Value> TableReader::Value::elements(const std::string &expected) const {
  const toml::array *list = node_->as_array();
  if (!list) must_be(expected);
  std::vector<Value> values;
  for (const toml::node &node : *list)
    values.emplace_back(*document_, node, path_ + "." + std::to_string(values.size()), meaning_);
  return values;
}

std::vector<TableReader::Value> TableReader::Value::elements_or_self() const {
  return node_->is_array() ? elements("a list") : std::vector<Value>{*this};
}

std::vector<double> TableReader::Value::point(Unit unit) const {
  std::vector<double> coordinates;
  for (const Value &value : elements_or_self()) coordinates.push_back(value.number(unit, unbounded) * unit.si);
  return coordinates;
}

double TableReader::Value::quantity(Unit unit, Range range) const {
  const std::string text = string(number_in(range, unit));
  try {
    return in_unit(text, unit);
  } catch (const std::invalid_argument &error) {
    must_be(number_in(range, unit), error.what());
  }
}

double TableReader::Value::any_quantity() const {
  if (is_number()) return number(one, unbounded);
  const std::string expected = "a number or a quantity";
  const std::string text = string(expected);
  try {
    const Quantity quantity = parse_quantity(text);
    return quantity.number * quantity.si;
  } catch (const std::invalid_argument &error) {
    must_be(expected, error.what());
  }
}

template <class ReadValue>
Function TableReader::Value::table(const std::string &expected, const ReadValue &read_value) const {
  std::vector<double> times, values;
  for (const Value &row : elements(expected)) {
    const std::vector<Value> pair = row.elements(expected);
    if (pair.size() != 2) row.must_be("a point [t, value]");
    times.push_back(pair[0].number(second, unbounded));
    values.push_back(read_value(pair[1]));
  }
  try {
    return Function(times, values);
  } catch (const std::invalid_argument &error) {
    must_be(expected, error.what());
  }
}

Function TableReader::Value::expression(const std::string &expected, double scale) const {
  try {
    return Function(string(expected), scale, document_->functions, document_->grids);
  } catch (const std::invalid_argument &error) {
    must_be(expected, error.what());
  }
}

Function TableReader::Value::function(Unit unit, Range range, const char *variables) const {
  const bool of_time = std::string_view(variables).find('t') != std::string_view::npos;
  const std::string expected =
      number_in(range, unit) + (of_time ? ", a list of [t, value] points" : "") + " or an expression of " + variables;
  const auto value = [&](const Value &element) {
    const double number = element.number(unit, range);
    element.doubt(number, unit, range.usual);
    return number * unit.si;
  };
  if (node_->is_array() && of_time) return table(expected, value);
  if (!is_number() && looks_like_quantity(string(expected)) &&
      string(expected).find_first_of("*+<>=?(") != std::string::npos &&
      string(expected).find(',') == std::string::npos) {
    try {
      (void)parse_quantity(string(expected));  // units have * and ( too
    } catch (const std::invalid_argument &) {
      must_be(expected, std::string("numbers in an expression have no units: they count in ") + unit.name);
    }
  }
  if (is_number() || looks_like_quantity(string(expected))) return value(*this);
  return limited_expression(expected, unit, range, variables);
}

Function TableReader::Value::place_function(Unit unit, Range range) const {
  const std::string expected = number_in(range, unit) + ", or an expression of " + of::place;
  if (node_->is_array()) must_be(expected);
  if (is_number() || looks_like_quantity(string(expected))) return {};
  return limited_expression(expected, unit, range, of::place);
}

/// From above, x and z of a mesh whose y points up are the east and the south: a grid asked for (x, z) is its mirror
/// image.
void TableReader::Value::refuse_mirrored_grids(const std::string &expected) const {
  if (document_->root["dimension"].value_or(2) != 3 || document_->root["up"].value_or(std::string("y")) != "y") return;
  const std::string text = string(expected);
  for (const auto &[name, grid] : document_->grids)
    if (std::regex_search(text, std::regex("\\b" + name + "\\s*\\([^(),]*,\\s*z\\s*\\)")))
      must_be(expected, "with up = \"y\" north is -z, and " + name +
                            "(x, z) would be the mirror image of the map: write " + name + "(x, -z)");
}

Function TableReader::Value::limited_expression(const std::string &expected, Unit unit, Range range,
                                                const char *variables) const {
  Function function = expression(expected, unit.si);
  refuse_mirrored_grids(expected);
  const std::string known = std::string(", ") + variables + ",";
  for (const std::string name : {"x", "y", "z", "t", "table", "slip"})
    if (function.uses(name) && known.find(" " + name + ",") == std::string::npos)
      must_be(expected, "it cannot depend on " + name);
  constexpr double largest = std::numeric_limits<double>::max();
  const auto limits = std::make_shared<const FunctionLimits>(FunctionLimits{
      place(document_->file, *node_, false) + ": " + path_ + written(*node_), number_in(range, unit), in(unit),
      std::max(-largest, range.low * unit.si), std::min(largest, range.high * unit.si), unit.si});
  function.limit(limits);
  document_->expressions.emplace_back(function, limits);
  return function;
}

std::shared_ptr<PlaceGrid> TableReader::Value::named_grid() const {
  const std::string expected = "the name of a grid file, ESRI ASCII or GeoTIFF, relative to the scene";
  auto grid = std::make_shared<PlaceGrid>();
  grid->file = document_->beside(string(expected));
  return grid;
}

Function TableReader::Value::named_function() const {
  const std::string expected = "a list of [t, value] points or an expression of t";
  std::optional<Value> first;
  Dimension dimension{};  // of the first value; 0 without a unit is 0 in each
  // in the plain unit of the keys whose expressions call it: degrees where an angle is meant, otherwise SI
  const auto value = [&](const Value &element) {
    const double si = element.any_quantity();
    const Dimension own = element.is_number() ? Dimension{} : parse_quantity(element.string(expected)).dimension;
    if (si == 0 && own == Dimension{}) return si;
    if (!first)
      first = element, dimension = own;
    else if (!(own == dimension))
      element.must_be("a quantity of the same dimension as " + first->path_ + written(*first->node_),
                      "all values of a function have units of one dimension, or none has a unit");
    return si / std::pow(degree.si, own.angle);
  };
  if (node_->is_array()) return table(expected, value);
  if (is_number() || looks_like_quantity(string(expected))) return value(*this);
  const Function function = expression(expected, 1);
  for (const char *place : {"x", "y", "z", "table", "slip"})
    if (function.uses(place)) must_be(expected, std::string("a named function cannot depend on ") + place);
  return function;
}

}  // namespace talus
