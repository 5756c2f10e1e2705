#pragma once
/// Says what every key of a scene means: a visitor of the same `fields` that the reader fills (`talus describe`,
/// docs/reference).
#include <initializer_list>
#include <iosfwd>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/units.h"
#include "scene/deferred.h"
#include "scene/function.h"
#include "scene/water_table.h"

namespace talus {

/// Walks default-constructed structs and collects one block per table and one line per key.
class Describer {
 public:
  struct Key {
    std::string path;     ///< body.NAME.density; NAME stands for a name of choice, N for a position in a list
    std::string allowed;  ///< unit and range, or choices
    std::string initial;  ///< default in the key's unit, `required`, or empty
    std::string meaning;
    std::string unit{};      ///< of numbers without one; empty where they have none
    bool over_time = false;  ///< a list at this key is one of points [t, value]
  };
  struct Block {
    std::string title;  ///< [body.NAME], [[stage]]
    std::string path;   ///< body.NAME, stage.N
    std::string meaning;
    std::string kind;  ///< mohr_coulomb: alternative of a variant, else empty
    std::vector<Key> keys;
  };

  /// Adds the block of a table, and blocks for the tables in it.
  template <class Struct>
  void add(Block block, Struct value);
  void add(Block block) { blocks_.push_back(std::move(block)); }

  const std::vector<Block> &blocks() const { return blocks_; }

  /// Prints all blocks or, of those, the keys whose path begins with `key` (body.density and body.NAME.density alike)
  /// or ends in it (density), and whole blocks of that kind (mohr_coulomb). Throws SceneError with the nearest key when
  /// there is none.
  void print(std::ostream &out, const std::string &key = "") const;

  // The visitor.

  void number(const char *key, double value, Unit unit, Range range, const char *meaning);
  void by_place(const char *key, double value, bool varies, Unit unit, Range range, const char *meaning);
  void integer(const char *key, int value, Range range, const char *meaning);
  void flag(const char *key, bool value, const char *meaning);
  void text(const char *key, const std::string &value, const char *meaning);
  void path(const char *key, const std::string &value, const char *meaning);
  void quantities(const char *key, const std::vector<double> &value, const char *meaning);
  void texts(const char *key, const std::vector<std::string> &value, const char *meaning);
  template <class Enum>
  void choice(const char *key, Enum value,
              std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>> choices, const char *meaning);
  template <class Variant>
  void one_of(const char *key, const Variant &value, const char *meaning);
  void point(const char *key, const std::vector<double> &value, Unit unit, const char *meaning);
  void point(const char *key, const std::vector<double> &value, Unit unit, const Usual &usual, const char *meaning);
  void water_table(const char *key, const WaterTable &value, Unit unit, const char *meaning);
  void points(const char *key, const std::vector<std::vector<double>> &value, Unit unit, const char *meaning);
  void function(const char *key, const Function &value, Unit unit, Range range, const char *variables,
                const char *meaning);
  void functions(const char *key, const std::vector<Function> &value, Unit unit, const char *variables,
                 const char *meaning);
  void elasticity(double young_modulus, double poisson_ratio);
  template <class Struct>
  void table(const char *key, const Struct &value, const char *meaning);
  template <class Struct>
  void named(const char *key, const std::vector<Struct> &value, const char *meaning);
  template <class Struct>
  void list(const char *key, const std::vector<Struct> &value, const char *meaning);
  void deferred(const char *key, const DeferredTable &value, const char *meaning);
  void deferred_table(const char *key, const DeferredTable &value, const char *meaning);

 private:
  std::string path_to(const std::string &key) const;
  void line(const char *key, std::string allowed, std::string initial, const char *meaning, Unit unit = one,
            bool over_time = false);

  std::vector<Block> blocks_;
  std::size_t current_ = 0;  ///< block that takes the visited keys
};

/// Adds a block per alternative of a variant that `read_one_of` reads at `key` of the table `path`:
/// describe_one_of<Law>(describer, "body.NAME", "law"). An alternative may say what it is by `static constexpr const
/// char *meaning`.
template <class Variant>
void describe_one_of(Describer &describer, const std::string &path, const char *key);

/// Adds every key of scene.h.
void describe_scene(Describer &describer);
/// Prints the keys of scene.h, as `Describer::print` does.
void describe_scene(std::ostream &out, const std::string &key = "");

// ---- templates ----

template <class Struct>
void Describer::add(Block block, Struct value) {
  const std::size_t outer = current_;
  current_ = blocks_.size();
  blocks_.push_back(std::move(block));
  value.fields(*this);
  current_ = outer;
}

template <class Enum>
void Describer::choice(const char *key, Enum value,
                       std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>> choices,
                       const char *meaning) {
  std::string names, initial;
  for (const auto &[name, meant] : choices) {
    names += (names.empty() ? "" : ", ") + std::string(name);
    if (meant == value) initial = name;
  }
  line(key, names, initial, meaning);
}

template <class Struct>
void Describer::table(const char *key, const Struct &value, const char *meaning) {
  const std::string path = path_to(key);
  line(key, "table [" + path + "]", "", meaning);
  add(Block{"[" + path + "]", path, meaning, "", {}}, value);
}

template <class Struct>
void Describer::named(const char *key, const std::vector<Struct> &, const char *meaning) {
  const std::string path = path_to(key) + ".NAME";
  line(key, "tables [" + path + "]", "", meaning);
  add(Block{"[" + path + "]", path, meaning, "", {}}, Struct{});
}

template <class Struct>
void Describer::list(const char *key, const std::vector<Struct> &, const char *meaning) {
  const std::string path = path_to(key);
  line(key, "tables [[" + path + "]]", "", meaning);
  add(Block{"[[" + path + "]]", path + ".N", meaning, "", {}}, Struct{});
}

/// The same with what titles of blocks begin with.
template <class Variant>
void describe_kinds(Describer &describer, const std::string &title, const std::string &path, const char *key) {
  const auto describe = [&]<class Kind>(std::type_identity<Kind>) {
    std::string meaning = "selects the keys of this block";
    if constexpr (requires { Kind::meaning; }) meaning = Kind::meaning;
    const std::string quoted = std::string("\"") + Kind::name + "\"";
    const Describer::Key chooser{path + "." + key, quoted, "", meaning};
    describer.add({title + key + " = " + quoted, path, "", Kind::name, {chooser}}, Kind{});
  };
  [&]<class... Kind>(std::type_identity<std::variant<Kind...>>) {
    (describe(std::type_identity<Kind>{}), ...);
  }(std::type_identity<Variant>{});
}

template <class Variant>
void describe_one_of(Describer &describer, const std::string &path, const char *key) {
  describe_kinds<Variant>(describer, "[" + path + "] ", path, key);
}

template <class Variant>
void Describer::one_of(const char *key, const Variant &, const char *meaning) {
  std::string names, first;
  [&]<class... Kind>(std::type_identity<std::variant<Kind...>>) {
    ((names += (names.empty() ? "" : ", ") + std::string(Kind::name)), ...);
    first = std::get<0>(std::tuple{Kind::name...});
  }(std::type_identity<Variant>{});
  line(key, names, first, meaning);
  const Block here = blocks_[current_];  // a copy: blocks are added
  describe_kinds<Variant>(*this, here.title + (here.kind.empty() ? " " : ", "), here.path, key);
}

}  // namespace talus
