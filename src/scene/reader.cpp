#include "scene/reader.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>
#include <tuple>

#include "scene/quantity.h"
#include "scene/words.h"

namespace talus {
namespace {

constexpr std::string_view override_place = "--set";
constexpr Range unbounded{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

/// "a number from 0 to 60 deg"
std::string number_in(Range range, Unit unit) {
  const std::string in = unit.dimension == Dimension{} ? "" : std::string(" ") + unit.name;
  if (std::isinf(range.low)) return in.empty() ? "a number" : "a number in" + in;
  return "a number from " + shortest(range.low) + " to " + shortest(range.high) + in;
}

std::string place(const std::string &file, const toml::node &node, bool root) {
  const toml::source_region &where = node.source();
  if (where.path && *where.path == override_place) return std::string(override_place);
  return root || where.begin.line == 0 ? file : file + " line " + std::to_string(where.begin.line);
}

/// The number of a node that is one (toml++'s own conversion refuses integers that a double rounds).
double number_of(const toml::node &node) {
  return node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
}

/// A value as a scene would write it.
std::string literal(const toml::node &node) {
  if (node.is_string()) return "\"" + node.value_or(std::string()) + "\"";
  if (node.is_number()) return shortest(number_of(node));
  if (const toml::array *list = node.as_array()) {
    std::vector<std::string> elements;
    for (const toml::node &element : *list) elements.push_back(literal(element));
    return "[" + join(elements) + "]";
  }
  std::ostringstream stream;
  node.visit([&](const auto &value) { stream << value; });
  return stream.str();
}

/// " = value", not too long, empty for tables.
std::string written(const toml::node &node) {
  if (node.is_table()) return "";
  const std::string text = literal(node);
  constexpr std::size_t longest = 72;
  return " = " + (text.size() > longest ? text.substr(0, longest) + " ..." : text);
}

bool before(const toml::node &a, const toml::node &b) {
  const auto rank = [](const toml::node &node) {
    const toml::source_region &where = node.source();
    const bool overridden = where.path && *where.path == override_place;
    return std::tuple(overridden, where.begin.line, where.begin.column);
  };
  return rank(a) < rank(b);
}

/// Keys of a table in the order of the file (toml++ sorts them by name).
std::vector<std::pair<std::string, const toml::node *>> in_file_order(const toml::table &table) {
  std::vector<std::pair<std::string, const toml::node *>> keys;
  for (const auto &[key, node] : table) keys.emplace_back(key.str(), &node);
  std::stable_sort(keys.begin(), keys.end(), [](const auto &a, const auto &b) { return before(*a.second, *b.second); });
  return keys;
}

/// Position of a list's entry that is given by its position or by its `name`; the size of the list if there is none.
std::size_t position(const toml::array &list, const std::string &word) {
  const bool number = !word.empty() && word.size() < 9 && std::all_of(word.begin(), word.end(), ::isdigit);
  if (number) return std::min<std::size_t>(std::stoul(word), list.size());
  const auto named = [&](const toml::node &node) {
    return node.is_table() && (*node.as_table())["name"].value_or(std::string()) == word;
  };
  return std::find_if(list.begin(), list.end(), named) - list.begin();
}

/// The entry of a table or list, null if there is none.
template <class Node>
Node *child(Node &parent, const std::string &word) {
  if (auto *table = parent.as_table()) return table->get(word);
  if (auto *list = parent.as_array()) return list->get(position(*list, word));
  return nullptr;
}

bool is_function_name(const std::string &name) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
  const bool variable = name == "x" || name == "y" || name == "z" || name == "t" || name == "table" || name == "pi";
  return !variable && !name.empty() && !std::isdigit((unsigned char)name[0]) &&
         std::all_of(name.begin(), name.end(), fits);
}

// ---- overrides ----

/// A table with the one key `value`, at the place "--set".
toml::table parse_override(const std::string &text) {
  try {
    toml::table table = toml::parse("value = " + text, override_place);
    if (table.size() == 1) return table;
  } catch (const toml::parse_error &) {  // a bare word is a string
  }
  std::ostringstream quoted;
  quoted << "value = " << toml::value<std::string>(text);
  return toml::parse(quoted.str(), override_place);
}

/// Moves the value of `holder` to a key of a table or in place of a list's entry; null if there is no such place.
toml::node *put(toml::node &parent, const std::string &word, toml::table holder) {
  return holder.get("value")->visit([&](auto &value) -> toml::node * {
    if (toml::table *table = parent.as_table()) return &table->insert_or_assign(word, std::move(value)).first->second;
    toml::array *list = parent.as_array();
    if (!list || position(*list, word) == list->size()) return nullptr;
    return &*list->replace(list->cbegin() + position(*list, word), std::move(value));
  });
}

void apply_override(toml::table &root, const std::string &text) {
  const std::size_t equals = text.find('=');
  const std::string path = text.substr(0, equals);
  const std::vector<std::string> words = split(path);
  if (equals == std::string::npos || words.empty() || std::find(words.begin(), words.end(), "") != words.end())
    throw SceneError("--set " + text + ": write key.path=value, for instance body.sand.cohesion=5e3");
  toml::node *node = &root;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool last = i + 1 == words.size();
    toml::node *next = last ? nullptr : child(*node, words[i]);
    if (!next) next = put(*node, words[i], parse_override(last ? text.substr(equals + 1) : "{}"));
    if (!next) throw SceneError("--set " + path + ": the scene has no such entry `" + words[i] + "`");
    node = next;
  }
}

}  // namespace

// ---- the file ----

struct TableReader::Document {
  std::string file;
  toml::table root;
  NamedFunctions functions;
};

/// One value of the file and what complaints say about it.
class TableReader::Value {
 public:
  Value(const Document &document, const toml::node &node, std::string path, const char *meaning)
      : document_(&document), node_(&node), path_(std::move(path)), meaning_(meaning) {}

  const toml::node &node() const { return *node_; }

  [[noreturn]] void must_be(const std::string &expected, const std::string &why = "") const {
    throw SceneError(place(document_->file, *node_, false) + ": " + path_ + written(*node_) + " (" + meaning_ +
                     ") must be " + expected + (why.empty() ? "" : "; " + why));
  }

  std::string string(const std::string &expected) const {
    const auto text = node_->value_exact<std::string>();
    if (!text) must_be(expected);
    return *text;
  }

  /// The number in the key's unit.
  double number(Unit unit, Range range) const {
    const double number = is_number() ? number_of(*node_) : quantity(unit, range);
    if (!std::isfinite(number) || !(range.low <= number && number <= range.high)) must_be(number_in(range, unit));
    return number;
  }

  bool is_number() const { return node_->is_number(); }

  std::vector<Value> elements(const std::string &expected) const {
    const toml::array *list = node_->as_array();
    if (!list) must_be(expected);
    std::vector<Value> values;
    for (const toml::node &node : *list)
      values.emplace_back(*document_, node, path_ + "." + std::to_string(values.size()), meaning_);
    return values;
  }

  /// A list's elements, or the value itself.
  std::vector<Value> elements_or_self() const {
    return node_->is_array() ? elements("a list") : std::vector<Value>{*this};
  }

  std::vector<double> point(Unit unit) const {
    std::vector<double> coordinates;
    for (const Value &value : elements_or_self()) coordinates.push_back(value.number(unit, unbounded) * unit.si);
    return coordinates;
  }

  Function function(Unit unit, Range range) const {
    const std::string expected =
        number_in(range, unit) + ", a list of [t, value] points or an expression of x, y, z, t";
    const auto value = [&](const Value &element) { return element.number(unit, range) * unit.si; };
    if (node_->is_array()) return table(expected, value);
    if (is_number() || looks_like_quantity(string(expected))) return value(*this);
    return expression(expected, unit.si);
  }

  /// A function of [functions]: of t alone, its values in any unit.
  Function named_function() const {
    const std::string expected = "a list of [t, value] points or an expression of t";
    if (node_->is_array()) return table(expected, [](const Value &element) { return element.any_quantity(); });
    if (is_number() || looks_like_quantity(string(expected))) return any_quantity();
    const Function function = expression(expected, 1);
    for (const char *place : {"x", "y", "z", "table"})
      if (function.uses(place)) must_be(expected, std::string("a named function cannot depend on ") + place);
    return function;
  }

 private:
  double quantity(Unit unit, Range range) const {
    const std::string text = string(number_in(range, unit));
    try {
      return in_unit(text, unit);
    } catch (const std::invalid_argument &error) {
      must_be(number_in(range, unit), error.what());
    }
  }

  double any_quantity() const {
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
  Function table(const std::string &expected, const ReadValue &read_value) const {
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

  Function expression(const std::string &expected, double scale) const {
    try {
      return Function(string(expected), scale, document_->functions);
    } catch (const std::invalid_argument &error) {
      must_be(expected, error.what());
    }
  }

  const Document *document_;
  const toml::node *node_;
  std::string path_;
  const char *meaning_;
};

TableReader::TableReader(std::shared_ptr<const Document> document, const void *table, std::string path)
    : document_(std::move(document)), table_(table), path_(std::move(path)) {}

TableReader TableReader::from_file(const std::string &file, const std::vector<std::string> &overrides) {
  return from_text(read_text(file), file, overrides);
}

TableReader TableReader::from_text(const std::string &text, const std::string &name,
                                   const std::vector<std::string> &overrides) {
  auto document = std::make_shared<Document>();
  document->file = name;
  try {
    document->root = toml::parse(text, name);
  } catch (const toml::parse_error &error) {
    throw SceneError(name + " line " + std::to_string(error.source().begin.line) + ": " +
                     std::string(error.description()));
  }
  for (const std::string &one : overrides) apply_override(document->root, one);
  TableReader reader(document, &document->root, "");
  constexpr const char *meaning = "function of time, called by name in expressions";
  if (const auto functions = reader.find("functions", "named functions of time")) {
    if (!functions->node().is_table()) functions->must_be("a table, [functions]");
    for (const auto &[key, node] : in_file_order(*functions->node().as_table())) {
      const Value value(*document, *node, "functions." + key, meaning);
      if (!is_function_name(key)) value.must_be("named by letters, digits and _, other than x, y, z, t, table, pi");
      document->functions[key] = value.named_function();
    }
  }
  return reader;
}

std::string read_text(const std::string &file) {
  if (std::filesystem::is_directory(file)) throw SceneError("cannot read " + file + ": it is a directory");
  std::ifstream stream(file);
  if (!stream) throw SceneError("cannot read " + file + ": " + std::generic_category().message(errno));
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// ---- the visitor ----

void TableReader::number(const char *key, double &value, Unit unit, Range range, const char *meaning) {
  if (const auto given = find(key, meaning))
    value = given->number(unit, range) * unit.si;
  else if (std::isnan(value))
    complain("", std::string("needs ") + key + " (" + meaning + "), " + number_in(range, unit) + misspelt(key));
}

void TableReader::integer(const char *key, int &value, Range range, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  const double number = given->is_number() ? number_of(given->node()) : range.low - 1;
  if (!(range.low <= number && number <= range.high) || number != std::floor(number))
    given->must_be("a whole number from " + shortest(range.low) + " to " + shortest(range.high));
  value = static_cast<int>(number);
}

void TableReader::flag(const char *key, bool &value, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  if (!given->node().is_boolean()) given->must_be("true or false");
  value = *given->node().value<bool>();
}

void TableReader::text(const char *key, std::string &value, const char *meaning) {
  if (const auto given = find(key, meaning)) value = given->string("a text in quotes");
}

void TableReader::texts(const char *key, std::vector<std::string> &value, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  value.clear();
  for (const Value &element : given->elements_or_self())
    value.push_back(element.string("a text in quotes or a list of texts"));
}

std::optional<std::size_t> TableReader::choose(const char *key, const std::vector<std::string> &names,
                                               const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return std::nullopt;
  const std::string expected = "one of " + join(names);
  const std::string name = given->string(expected);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return found - names.begin();
  const std::string near = nearest(name, names);
  given->must_be(expected, near.empty() ? "" : "did you mean `" + near + "`?");
}

void TableReader::point(const char *key, std::vector<double> &value, Unit unit, const char *meaning) {
  if (const auto given = find(key, meaning)) value = given->point(unit);
}

void TableReader::points(const char *key, std::vector<std::vector<double>> &value, Unit unit, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  value.clear();
  for (const Value &row : given->elements("a list of points")) {
    if (!row.node().is_array()) row.must_be("a point, a list of coordinates");
    value.push_back(row.point(unit));
  }
}

void TableReader::function(const char *key, Function &value, Unit unit, Range range, const char *meaning) {
  if (const auto given = find(key, meaning)) value = given->function(unit, range);
}

void TableReader::functions(const char *key, std::vector<Function> &value, Unit unit, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  value.clear();
  for (const Value &component : given->elements_or_self()) value.push_back(component.function(unit, unbounded));
}

void TableReader::elasticity(double &young_modulus, double &poisson_ratio) {
  constexpr Range stiffness{1e-6, 1e15};
  std::vector<std::string> names;
  const auto constant = [&](const char *key, Unit unit, Range range, const char *meaning) {
    const auto given = find(key, meaning);
    if (given) names.push_back(key);
    return given ? given->number(unit, range) : 0;
  };
  double E = constant("young_modulus", pascal, stiffness, "Young's modulus E");
  double nu = constant("poisson_ratio", one, Range{-1, 0.5}, "Poisson's ratio nu");
  const double G = constant("shear_modulus", pascal, stiffness, "shear modulus G");
  const double K = constant("bulk_modulus", pascal, stiffness, "bulk modulus K");
  if (names.size() != 2)
    complain("", "needs exactly two of young_modulus, poisson_ratio, shear_modulus, bulk_modulus; it has " +
                     (names.empty() ? "none" : join(names)));
  const bool has_nu = names[0] == "poisson_ratio" || names[1] == "poisson_ratio";
  if (has_nu) {
    if (G > 0) E = 2 * G * (1 + nu);
    if (K > 0) E = 3 * K * (1 - 2 * nu);
  } else if (E > 0) {
    nu = G > 0 ? E / (2 * G) - 1 : 0.5 - E / (6 * K);
  } else {
    E = 9 * K * G / (3 * K + G);
    nu = (3 * K - 2 * G) / (2 * (3 * K + G));
  }
  if (!(E > 0 && -1 < nu && nu < 0.5))
    complain("", names[0] + " and " + names[1] + " give Poisson's ratio " + shortest(nu) + " and Young's modulus " +
                     shortest(E) + " Pa; a stable material has -1 < nu < 0.5 and E > 0");
  young_modulus = E, poisson_ratio = nu;
}

void TableReader::deferred(const char *key, DeferredTable &value, const char *) {
  value.reader = std::make_shared<TableReader>(*this);
  value.reader->known_.push_back(key);
  rest_deferred_ = true;
}

void TableReader::deferred_table(const char *key, DeferredTable &value, const char *meaning) {
  if (const auto reader = sub_table(key, meaning)) value.reader = std::make_shared<TableReader>(*reader);
}

std::size_t TableReader::kind(const char *key, const std::vector<std::string> &kinds) {
  const bool announced = std::find(known_.begin(), known_.end(), key) != known_.end();
  const auto index = choose(key, kinds, "kind, which decides on the further keys of this table");
  if (!index && announced) complain("", std::string("needs ") + key + ", one of " + join(kinds));
  return index.value_or(0);
}

// ---- walking the file ----

std::string TableReader::path_to(const std::string &key) const {
  return path_.empty() || key.empty() ? path_ + key : path_ + "." + key;
}

std::optional<TableReader::Value> TableReader::find(const char *key, const char *meaning) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  const toml::node *node = static_cast<const toml::table *>(table_)->get(key);
  if (!node) return std::nullopt;
  return Value(*document_, *node, path_to(key), meaning);
}

std::optional<TableReader> TableReader::sub_table(const char *key, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return std::nullopt;
  const toml::table *table = given->node().as_table();
  if (!table) given->must_be("a table, [" + path_to(key) + "]");
  return TableReader(document_, table, path_to(key));
}

std::optional<std::vector<std::pair<std::string, TableReader>>> TableReader::named_tables(const char *key,
                                                                                          const char *meaning) {
  const auto parent = sub_table(key, meaning);
  if (!parent) return std::nullopt;
  std::vector<std::pair<std::string, TableReader>> tables;
  for (const auto &[name, node] : in_file_order(*static_cast<const toml::table *>(parent->table_))) {
    const std::string path = parent->path_to(name);
    if (!node->is_table())
      Value(*document_, *node, path, meaning)
          .must_be("a table with a name of your choice, [" + path_to(key) + ".NAME]");
    tables.emplace_back(name, TableReader(document_, node->as_table(), path));
  }
  return tables;
}

std::optional<std::vector<TableReader>> TableReader::listed_tables(const char *key, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return std::nullopt;
  const std::string expected = "a list of tables, [[" + path_to(key) + "]]";
  std::vector<TableReader> tables;
  for (const Value &element : given->elements(expected)) {
    if (!element.node().is_table()) element.must_be("a table");
    tables.push_back(
        TableReader(document_, element.node().as_table(), path_to(key) + "." + std::to_string(tables.size())));
  }
  return tables;
}

/// What may be meant by a key that is missing: one of the table that nothing has asked for and that looks like it.
std::string TableReader::misspelt(const std::string &key) const {
  std::vector<std::string> unclaimed;
  for (const auto &[name, node] : in_file_order(*static_cast<const toml::table *>(table_)))
    if (std::find(known_.begin(), known_.end(), name) == known_.end()) unclaimed.push_back(name);
  const std::string near = nearest(key, unclaimed);
  return near.empty() ? "" : "; did you mean it by `" + near + "`?";
}

void TableReader::refuse_unknown_keys() const {
  for (const auto &[key, node] : in_file_order(*static_cast<const toml::table *>(table_))) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    throw SceneError(place(document_->file, *node, false) + ": " + path_to(key) + " is no known key; " +
                     suggestion(key, known_));
  }
}

void TableReader::refuse(const std::string &sentence) const {
  const auto *table = static_cast<const toml::table *>(table_);
  throw SceneError(place(document_->file, *table, table == &document_->root) + ": " +
                   (path_.empty() ? "" : path_ + ": ") + sentence);
}

void TableReader::complain(const std::string &key_path, const std::string &sentence) const {
  const toml::node *node = static_cast<const toml::table *>(table_);
  bool found = true;
  for (const std::string &word : split(key_path)) {
    const toml::node *next = child(*node, word);
    found = next != nullptr;
    if (!found) break;
    node = next;
  }
  const bool root = node == &document_->root;
  const std::string path = path_to(key_path);
  throw SceneError(place(document_->file, *node, root) + ": " + (path.empty() ? "the scene" : path) +
                   (found ? written(*node) : "") + " " + sentence);
}

}  // namespace talus
