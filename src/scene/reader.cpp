#include "scene/reader.h"

#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <sstream>
#include <system_error>

#include "base/read_file.h"
#include "scene/apply_materials.h"
#include "scene/overrides.h"
#include "scene/quantity.h"
#include "scene/toml_nodes.h"
#include "scene/usual.h"
#include "scene/value.h"
#include "scene/words.h"

namespace talus {
namespace {

bool is_function_name(const std::string &name) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
  const bool variable =
      name == "x" || name == "y" || name == "z" || name == "t" || name == "table" || name == "slip" || name == "pi";
  return !variable && !mu::Parser().GetFunDef().contains(name) && !name.empty() &&
         !std::isdigit((unsigned char)name[0]) && std::all_of(name.begin(), name.end(), fits);
}

}  // namespace

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
                     std::string(error.description()) +
                     (error.description().find("could not determine value type") != std::string_view::npos
                          ? "; a text, or a number with a unit, is written in quotes"
                          : ""));
  }
  for (const std::string &one : overrides) apply_override(document->root, one);
  apply_materials(document->root, name);
  TableReader reader(document, &document->root, "");
  const auto check_name = [](const Value &value, const std::string &key) {
    if (!is_function_name(key))
      value.must_be(
          "named by letters, digits and _, other than x, y, z, t, table, pi and the functions that expressions "
          "have of themselves, such as sin or min");
  };
  if (const auto grids = reader.find("grids", "grids of values by place")) {
    if (!grids->node().is_table()) grids->must_be("a table, [grids]");
    for (const auto &[key, node] : in_file_order(*grids->node().as_table())) {
      const Value value(*document, *node, "grids." + key, "grid of values, called by name in expressions");
      check_name(value, key);
      document->grids[key] = value.named_grid();
    }
  }
  constexpr const char *meaning = "function of time, called by name in expressions";
  if (const auto functions = reader.find("functions", "named functions of time")) {
    if (!functions->node().is_table()) functions->must_be("a table, [functions]");
    for (const auto &[key, node] : in_file_order(*functions->node().as_table())) {
      const Value value(*document, *node, "functions." + key, meaning);
      check_name(value, key);
      if (document->grids.contains(key)) value.must_be("named otherwise than a grid of [grids]");
      document->functions[key] = value.named_function();
    }
  }
  return reader;
}

/// Files of [grids] that have been read appear with a digest of their content, since another content is another scene.
std::string TableReader::values() const {
  toml::table with = document_->root;
  for (const auto &[name, grid] : document_->grids)
    if (!grid->digest.empty())
      with["grids"].as_table()->insert_or_assign(name, grid->file + ", content " + grid->digest);
  std::ostringstream text;
  text << with;
  return text.str();
}

std::string read_text(const std::string &file) {
  if (std::filesystem::is_directory(file)) throw SceneError("cannot read " + file + ": it is a directory");
  try {
    return read_file(file);
  } catch (const std::system_error &error) {
    throw SceneError(error.what());
  }
}

// ---- the visitor ----

void TableReader::number(const char *key, double &value, Unit unit, Range range, const char *meaning) {
  if (const auto given = find(key, meaning)) {
    const double number = given->number(unit, range);
    if (number * unit.si != value) given->doubt(number, unit, range.usual);
    value = number * unit.si;
  } else if (std::isnan(value))
    complain("", std::string("needs ") + key + " (" + meaning + "), " + number_in(range, unit) + misspelt(key));
}

void TableReader::by_place(const char *key, double &value, bool &varies, Unit unit, Range range, const char *meaning) {
  const auto given = find(key, meaning);
  if (given && given->place_function(unit, range).given())
    value = std::numeric_limits<double>::quiet_NaN(), varies = true;
  else
    number(key, value, unit, range, meaning);
}

Function TableReader::function_of_place(const char *key, Unit unit, Range range, const char *meaning) {
  const auto given = find(key, meaning);
  return given ? given->place_function(unit, range) : Function();
}

void TableReader::integer(const char *key, int &value, Range range, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  const double number = given->is_number() ? number_of(given->node()) : range.low - 1;
  if (!(range.low <= number && number <= range.high) || number != std::floor(number))
    given->must_be("a whole number from " + shortest(range.low) + " to " + shortest(range.high));
  if (number != value) given->doubt(number, one, range.usual);
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

void TableReader::path(const char *key, std::string &value, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  value = document_->beside(given->string("the name of a file in quotes"));
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

void TableReader::point(const char *key, std::vector<double> &value, Unit unit, const Usual &usual,
                        const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  value = given->point(unit);
  given->doubt(std::sqrt(std::inner_product(value.begin(), value.end(), value.begin(), 0.)) / unit.si, unit, usual);
}

void TableReader::quantities(const char *key, std::vector<double> &value, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  value.clear();
  for (const Value &one : given->elements_or_self()) value.push_back(one.any_quantity());
}

void TableReader::points(const char *key, std::vector<std::vector<double>> &value, Unit unit, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  value.clear();
  const std::vector<Value> rows = given->elements("a list of points");
  if (rows.empty()) given->must_be("a list with at least one point; leave it out for none");
  for (const Value &row : rows) {
    if (!row.node().is_array()) row.must_be("a point, a list of coordinates");
    value.push_back(row.point(unit));
  }
}

void TableReader::water_table(const char *key, WaterTable &value, Unit unit, const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  constexpr Range elevations{-1e4, 1e4};
  if (given->node().is_string() || given->node().is_number()) {
    const Function elevation = given->function(unit, elevations, of::place);
    if (elevation.constant())
      value.points = {{0, elevation(0)}};
    else
      value.elevation = elevation;
    return;
  }
  if (!given->node().is_array())
    given->must_be("an elevation, a list of points [x, elevation] or an expression of " + std::string(of::place));
  points(key, value.points, unit, meaning);
}

void TableReader::function(const char *key, Function &value, Unit unit, Range range, const char *variables,
                           const char *meaning) {
  if (const auto given = find(key, meaning)) value = given->function(unit, range, variables);
}

const std::map<std::string, Doubt> &TableReader::unusual() const { return document_->unusual; }

const NamedGrids &TableReader::grids() const { return document_->grids; }

const std::set<std::string> &TableReader::files() const { return document_->files; }

std::string TableReader::one_path(const std::string &key_path) const {
  const toml::node *node = static_cast<const toml::table *>(table_);
  std::string path;
  for (const std::string &word : split(key_path)) {
    const toml::array *list = node ? node->as_array() : nullptr;
    const std::size_t at = list ? position(*list, word) : 0;
    path += (path.empty() ? "" : ".") + (list && at < list->size() ? std::to_string(at) : word);
    if (node) node = child(*node, word);
  }
  return path;
}

std::string TableReader::function_fault() const {
  for (const auto &[function, limits] : document_->expressions)
    if (!limits->fault.empty()) return limits->fault;
  return "";
}

void TableReader::forget_function_faults() const {
  for (const auto &[function, limits] : document_->expressions) limits->fault.clear();
}

void TableReader::each_expression(const std::function<void(const Function &)> &visit) const {
  for (const auto &[function, limits] : document_->expressions) visit(function);
}

void TableReader::functions(const char *key, std::vector<Function> &value, Unit unit, const char *variables,
                            const char *meaning) {
  const auto given = find(key, meaning);
  if (!given) return;
  value.clear();
  for (const Value &component : given->elements_or_self())
    value.push_back(component.function(unit, unbounded, variables));
}

void TableReader::elasticity(double &young_modulus, double &poisson_ratio) {
  std::vector<std::string> names;
  const auto constant = [&](const char *key, Unit unit, Range range, const char *meaning) {
    const auto given = find(key, meaning);
    if (!given) return 0.;
    names.push_back(key);
    const double number = given->number(unit, range);
    given->doubt(number, unit, range.usual);
    return number;
  };
  double E = constant("young_modulus", pascal, elastic::stiffness, "Young's modulus E");
  double nu = constant("poisson_ratio", one, elastic::poisson_ratio, "Poisson's ratio nu");
  const double G = constant("shear_modulus", pascal, elastic::stiffness, "shear modulus G");
  const double K = constant("bulk_modulus", pascal, elastic::stiffness, "bulk modulus K");
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
  if (has_nu && !(-1 < nu && nu < 0.5))
    complain(
        "poisson_ratio",
        "(Poisson's ratio nu) must lie above -1 and below 0.5, where a material keeps its volume; 0.49 is nearly that");
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
    if (has_control_characters(name))
      Value(*document_, *node, path, meaning).must_be("named without line breaks and other control characters");
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
    if (const auto other = elsewhere_.find(std::string(key)); other != elsewhere_.end())
      complain(key, "belongs to " + other->second + ": set that, or leave the key out");
    throw SceneError(place(document_->file, *node, false) + ": " + path_to(key) + " is no known key; " +
                     suggestion(key, known_));
  }
}

bool TableReader::has(const char *key) const { return static_cast<const toml::table *>(table_)->contains(key); }

void TableReader::refuse(const std::string &sentence) const {
  const std::size_t must = sentence.find(" must ");
  if (must != std::string::npos && has(sentence.substr(0, must).c_str()))
    complain(sentence.substr(0, must), sentence.substr(must + 1));
  const auto *table = static_cast<const toml::table *>(table_);
  throw SceneError(place(document_->file, *table, table == &document_->root) + ": " +
                   (path_.empty() ? "" : path_ + ": ") + sentence);
}

std::string TableReader::written_at(const std::string &key_path) const {
  const toml::node *node = static_cast<const toml::table *>(table_);
  for (const std::string &word : split(key_path))
    if (node) node = child(*node, word);
  return !node || node->is_table() ? "" : literal(*node);
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
