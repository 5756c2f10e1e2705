#pragma once
/// One value of a scene file: how numbers, quantities, points and functions are read from it, and what complaints say
/// about it. Included only by the reader's own files.
#include <toml++/toml.h>

#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "scene/place_grid.h"
#include "scene/reader.h"

namespace talus {

inline constexpr Range unbounded{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

/// "a number from 0 to 60 deg"
std::string number_in(Range range, Unit unit);

struct TableReader::Document {
  std::string file;
  toml::table root;
  NamedFunctions functions;
  NamedGrids grids;
  mutable std::vector<std::pair<Function, std::shared_ptr<const FunctionLimits>>> expressions;  ///< of all keys
  mutable std::set<std::string> files;             ///< and folders that keys have named
  mutable std::map<std::string, Doubt> unusual{};  ///< see TableReader::unusual

  /// A file or folder that a key names, relative to the folder of this file; enters it into `files`. An empty name
  /// stays empty.
  std::string beside(const std::string &name) const;
};

/// One value of the file and what complaints say about it.
class TableReader::Value {
 public:
  Value(const Document &document, const toml::node &node, std::string path, const char *meaning)
      : document_(&document), node_(&node), path_(std::move(path)), meaning_(meaning) {}

  const toml::node &node() const { return *node_; }
  [[noreturn]] void must_be(const std::string &expected, const std::string &why = "") const;

  bool is_number() const { return node_->is_number(); }
  std::string string(const std::string &expected) const;
  /// The number in the key's unit.
  double number(Unit unit, Range range) const;
  std::vector<Value> elements(const std::string &expected) const;
  /// A list's elements, or the value itself.
  std::vector<Value> elements_or_self() const;
  std::vector<double> point(Unit unit) const;
  /// `variables` are those that the key gives its function, as in namespace `of`.
  Function function(Unit unit, Range range, const char *variables) const;
  /// An expression of the place; not given where the value is a number or a quantity, or of another kind.
  Function place_function(Unit unit, Range range) const;
  /// A file of [grids], relative to the folder of the scene; not opened yet.
  std::shared_ptr<PlaceGrid> named_grid() const;
  /// A function of [functions]: of t alone, its values in any unit.
  Function named_function() const;
  /// Doubts a number of this value, in the unit of its key, that is not usual.
  void doubt(double number, Unit unit, const Usual &usual) const;
  /// A number or a quantity of any unit, in SI.
  double any_quantity() const;

 private:
  double quantity(Unit unit, Range range) const;
  template <class ReadValue>
  Function table(const std::string &expected, const ReadValue &read_value) const;
  Function expression(const std::string &expected, double scale) const;
  void refuse_mirrored_grids(const std::string &expected) const;
  /// An expression whose values are held against the range of the key as they are used.
  Function limited_expression(const std::string &expected, Unit unit, Range range, const char *variables) const;

  const Document *document_;
  const toml::node *node_;
  std::string path_;
  const char *meaning_;
};

}  // namespace talus
