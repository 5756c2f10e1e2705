#pragma once
/// Reads a scene (TOML) into the structs of scene.h and of the rooms further on.
///
/// A struct names its keys once, in `template <class Visitor> void fields(Visitor &&v)`; `TableReader` is the visitor
/// that fills them from one table of the file. Numbers are in the key's unit (SI, angles in degrees) or quantities with
/// a unit; what is stored is SI and radians. Keys that no field claims are refused. Every complaint is a `SceneError`
/// that names the file, the line, the key, the value, what is allowed and what the key means.
#include <concepts>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/units.h"
#include "scene/deferred.h"
#include "scene/doubt.h"
#include "scene/function.h"
#include "scene/water_table.h"

namespace talus {

/// Bad input: the program ends with status 2 and this text.
class SceneError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// One table of a parsed file; copies share the file.
class TableReader {
 public:
  /// The root table of a file. Each override is `key.path=value`: a path runs through named tables (body.sand.cohesion)
  /// and through lists by position or by name (stage.0.duration, stage.creep.duration); the value is TOML, or else a
  /// string.
  static TableReader from_file(const std::string &file, const std::vector<std::string> &overrides = {});
  /// The same from text; `name` stands for the file in complaints.
  static TableReader from_text(const std::string &text, const std::string &name,
                               const std::vector<std::string> &overrides = {});

  /// Does the table have this key?
  bool has(const char *key) const;

  /// Visits the struct's fields, refuses keys that none of them claimed, then asks `value.problem()`, where there is
  /// such a member, for a sentence on what is wrong between its keys.
  template <class Struct>
  void fill(Struct &value);

  // The visitor. A key that the table lacks leaves its value alone.

  /// An initial value of NaN (`required`) makes the key a required one. The range is in the key's unit.
  void number(const char *key, double &value, Unit unit, Range range, const char *meaning);
  /// A number, or an expression of the undeformed place x, y, z: then `varies` is set and the value NaN. The expression
  /// is that of `function_of_place`. An initial value of NaN makes the key a required one.
  void by_place(const char *key, double &value, bool &varies, Unit unit, Range range, const char *meaning);
  void integer(const char *key, int &value, Range range, const char *meaning);
  void flag(const char *key, bool &value, const char *meaning);
  void text(const char *key, std::string &value, const char *meaning);
  /// A file or a folder, relative to the folder of this file; it becomes one of `files`.
  void path(const char *key, std::string &value, const char *meaning);
  /// A string or a list of strings.
  void texts(const char *key, std::vector<std::string> &value, const char *meaning);
  template <class Enum>
  void choice(const char *key, Enum &value,
              std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>> choices, const char *meaning);
  /// One of the alternatives of a variant by its `name`, whose fields are keys of this table; the first one if the
  /// table does not say which. Keys of the others are refused with the name of theirs. Defined in one_of.h.
  template <class Variant>
  void one_of(const char *key, Variant &value, const char *meaning);
  /// A list of numbers or of quantities of any unit, in SI; a single one gives a vector of size 1.
  void quantities(const char *key, std::vector<double> &value, const char *meaning);
  /// A list of quantities; a single one gives a vector of size 1.
  void point(const char *key, std::vector<double> &value, Unit unit, const char *meaning);
  /// The same of a vector, with the usual range of its magnitude.
  void point(const char *key, std::vector<double> &value, Unit unit, const Usual &usual, const char *meaning);
  /// A list of points [x, elevation], or an expression of the place.
  void water_table(const char *key, WaterTable &value, Unit unit, const char *meaning);
  void points(const char *key, std::vector<std::vector<double>> &value, Unit unit, const char *meaning);
  /// A quantity, a list of [t, value] points, or an expression; numbers and tables are checked against the range.
  /// `variables` are those that the function may name, as in namespace `of`; its values are checked as they are used.
  void function(const char *key, Function &value, Unit unit, Range range, const char *variables, const char *meaning);
  /// A list of functions; a single one gives a vector of size 1.
  void functions(const char *key, std::vector<Function> &value, Unit unit, const char *variables, const char *meaning);
  /// The expression of the place at a key that `by_place` reads; not given where the key has a number, or is absent.
  Function function_of_place(const char *key, Unit unit, Range range, const char *meaning);
  /// Exactly two of young_modulus, poisson_ratio, shear_modulus, bulk_modulus.
  void elasticity(double &young_modulus, double &poisson_ratio);
  template <class Struct>
  void table(const char *key, Struct &value, const char *meaning);
  /// [key.NAME] tables in the order of the file; each struct's `name` is set.
  template <class Struct>
  void named(const char *key, std::vector<Struct> &value, const char *meaning);
  /// [[key]] tables.
  template <class Struct>
  void list(const char *key, std::vector<Struct> &value, const char *meaning);
  /// The key and all further keys of this table are read later, by `read_one_of`; stands last in `fields`.
  void deferred(const char *key, DeferredTable &value, const char *meaning);
  /// The sub-table is read later.
  void deferred_table(const char *key, DeferredTable &value, const char *meaning);

  /// Refuses the table as a whole, "slope.toml line 12: body.sand: needs library", or where the sentence begins with
  /// one of its keys and `must`, that key: "slope.toml line 17: body.sand.residual_cohesion = 6e3 must not exceed
  /// cohesion".
  [[noreturn]] void refuse(const std::string &sentence) const;
  /// Complains about a key of this table, given by its path from here (`failure_point`, `output.point.crest.position`;
  /// empty: the table itself), at its place in the file or, if it is not there, at the nearest enclosing table's.
  /// The sentence goes on from the key: "must name a point".
  [[noreturn]] void complain(const std::string &key_path, const std::string &sentence) const;

  /// The first value of a function that its key does not admit, as a sentence with key, line, place and time; empty if
  /// there was none.
  std::string function_fault() const;
  void forget_function_faults() const;
  /// Calls visit for each function of the file that is an expression.
  void each_expression(const std::function<void(const Function &)> &visit) const;

  /// A doubt about each value so far that is not usual, by the path of its key; the key is its name, and the sentence
  /// is `slope.toml line 14: damping = 0.7 in stage "slide"; usual 0 to 0.1`. A value at its default is none, and the
  /// values of an expression are not looked at.
  const std::map<std::string, Doubt> &unusual() const;

  /// The value at a key as the scene writes it, with its unit if it has one; the key is given by its path from here.
  /// Empty if it is not there, or is a table.
  std::string written_at(const std::string &key_path) const;
  /// The whole file with overrides applied, as TOML without its comments.
  std::string values() const;
  /// The files of [grids], whose values arrive later.
  const NamedGrids &grids() const;
  /// The files and folders that keys and [grids] have named so far, as the program opens them; those of a deferred
  /// table come when it is read.
  const std::set<std::string> &files() const;
  /// A path with the positions of entries of lists in place of their names, so that one key has one path:
  /// stage.0.duration for stage.gravity.duration. Words that the scene lacks stay as they are.
  std::string one_path(const std::string &key_path) const;

  /// Number of the kind named at `key`; 0 for an absent key unless `deferred` announced it.
  std::size_t kind(const char *key, const std::vector<std::string> &kinds);

 private:
  struct Document;
  class Value;

  TableReader(std::shared_ptr<const Document> document, const void *table, std::string path);
  std::string path_to(const std::string &key) const;
  std::optional<Value> find(const char *key, const char *meaning);
  std::optional<std::size_t> choose(const char *key, const std::vector<std::string> &names, const char *meaning);
  std::optional<TableReader> sub_table(const char *key, const char *meaning);
  std::optional<std::vector<std::pair<std::string, TableReader>>> named_tables(const char *key, const char *meaning);
  std::optional<std::vector<TableReader>> listed_tables(const char *key, const char *meaning);
  std::string misspelt(const std::string &key) const;
  void refuse_unknown_keys() const;

  std::shared_ptr<const Document> document_;
  const void *table_;  ///< a toml::table of the document; toml++ stays inside the reader's own files
  std::string path_;   ///< of this table from the root: body.sand, stage.0
  std::vector<std::string> known_;
  std::map<std::string, std::string> elsewhere_;  ///< key of another kind: that kind, `kind = "seepage"`
  bool rest_deferred_ = false;
};

/// Picks the alternative of a variant whose `static constexpr const char *name` stands at `key` (law = "mohr_coulomb"),
/// default-constructs it and fills it from the table. A table that the scene lacks gives the first alternative.
template <class Variant>
void read_one_of(const DeferredTable &deferred, const char *key, Variant &value);

/// The text of a file. Throws SceneError when it cannot be read.
std::string read_text(const std::string &file);

struct Scene;

/// Reads a scene, applies the overrides, and checks what one key demands of another.
Scene read_scene(const std::string &file, const std::vector<std::string> &overrides = {});
/// The same from text; `file` stands for the path of the scene.
Scene parse_scene(const std::string &text, const std::string &file, const std::vector<std::string> &overrides = {});
/// A scene whose mesh a host program brings, so without [mesh]; `name` stands for the file in complaints. Also in
/// talus.h.
Scene parse_host_scene(const std::string &text, const std::string &name);

// ---- templates ----

template <class Struct>
void TableReader::fill(Struct &value) {
  value.fields(*this);
  if (!rest_deferred_) refuse_unknown_keys();
  if constexpr (requires {
                  { value.problem() } -> std::convertible_to<std::string>;
                }) {
    const std::string sentence = value.problem();
    if (!sentence.empty()) refuse(sentence);
  }
}

template <class Enum>
void TableReader::choice(const char *key, Enum &value,
                         std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>> choices,
                         const char *meaning) {
  std::vector<std::string> names;
  for (const auto &[name, meant] : choices) names.emplace_back(name);
  if (const auto index = choose(key, names, meaning)) value = choices.begin()[*index].second;
}

template <class Struct>
void TableReader::table(const char *key, Struct &value, const char *meaning) {
  if (auto reader = sub_table(key, meaning)) reader->fill(value);
}

template <class Struct>
void TableReader::named(const char *key, std::vector<Struct> &value, const char *meaning) {
  auto tables = named_tables(key, meaning);
  if (!tables) return;
  value.clear();
  for (auto &[name, reader] : *tables) {
    value.emplace_back().name = name;
    reader.fill(value.back());
  }
}

template <class Struct>
void TableReader::list(const char *key, std::vector<Struct> &value, const char *meaning) {
  auto tables = listed_tables(key, meaning);
  if (!tables) return;
  value.clear();
  for (TableReader &reader : *tables) reader.fill(value.emplace_back());
}

/// Names of a variant's alternatives in their order.
template <class Variant>
std::vector<std::string> kinds_of() {
  return []<class... Kind>(std::type_identity<std::variant<Kind...>>) {
    return std::vector<std::string>{Kind::name...};
  }(std::type_identity<Variant>{});
}

/// Default-constructs the alternative with this number.
template <class Variant>
Variant make_kind(std::size_t index) {
  return [&]<class... Kind>(std::type_identity<std::variant<Kind...>>) {
    Variant value;
    std::size_t i = 0;
    ((i++ == index ? void(value.template emplace<Kind>()) : void()), ...);
    return value;
  }(std::type_identity<Variant>{});
}

template <class Variant>
void read_one_of(const DeferredTable &deferred, const char *key, Variant &value) {
  value = make_kind<Variant>(0);
  if (!deferred.reader) return;
  TableReader reader = *deferred.reader;  // a copy, so that the table can be read again
  value = make_kind<Variant>(reader.kind(key, kinds_of<Variant>()));
  std::visit([&](auto &kind) { reader.fill(kind); }, value);
}

}  // namespace talus
