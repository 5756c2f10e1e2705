#pragma once
/// Fields of points (particles, Gauss points) in results: every field is one entry that holds its name, unit, meaning,
/// number of components and where its value comes from. Snapshots and the columns of tracked points in history.csv are
/// made from the same entries.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "output/results.h"

namespace talus {

/// Name of a column of history.csv: quantity and unit, "crest_velocity" and "m/s" give "crest_velocity_m_s", and "kg
/// m/s" is written "kg_m_s".
inline std::string history_column(const std::string &quantity, std::string unit) {
  if (unit == "-") return quantity;
  std::ranges::replace_if(
      unit, [](char c) { return c == '/' || c == ' '; }, '_');
  return quantity + "_" + unit;
}

/// A column of history.csv as history_columns.csv describes it: a quantity of a point, a boundary, a rigid body or the
/// run.
struct HistoryColumn {
  std::string name, quantity, unit, of, which;  ///< of: "point" and so on; which of them, or of their parts
};
inline HistoryColumn column_of(const std::string &of, const std::string &which, const std::string &quantity,
                               const std::string &unit) {
  return {history_column(which + "_" + quantity, unit), quantity, unit, of, which};
}

/// What history.csv holds of a field for each tracked point: nothing, its value, the magnitude of a vector, this and
/// its components, the components of the position, which are named x, y and z, or the components of a tensor.
enum class Tracked { no, value, magnitude, vector, coordinates, components };

/// One field of a `Point`.
template <class Point>
struct OutputField {
  std::string name, unit, meaning;
  int components = 1;
  Tracked tracked = Tracked::no;
  std::function<void(const Point &, double *values)> get;  ///< writes `components` numbers
};

/// A list of fields in the order of the results.
template <class Point>
class OutputFields {
 public:
  /// `value(point)` is a double or a std::array of doubles, whose length is the number of components.
  template <class Value>
  void add(std::string name, std::string unit, std::string meaning, Tracked tracked, Value value) {
    using Type = std::decay_t<std::invoke_result_t<Value, const Point &>>;
    OutputField<Point> field{std::move(name), std::move(unit), std::move(meaning), 1, tracked, {}};
    if constexpr (std::is_arithmetic_v<Type>) {
      field.get = [value](const Point &p, double *values) { *values = value(p); };
    } else {
      field.components = static_cast<int>(std::tuple_size_v<Type>);
      field.get = [value](const Point &p, double *values) { std::ranges::copy(value(p), values); };
    }
    list_.push_back(std::move(field));
  }

  const std::vector<OutputField<Point>> &list() const { return list_; }

  /// The columns of a snapshot without points, with room for so many.
  std::vector<Column> columns(std::size_t points) const {
    std::vector<Column> columns;
    for (const auto &field : list_) {
      columns.push_back({field.name, field.unit, field.meaning, field.components, {}});
      columns.back().values.reserve(points * field.components);
    }
    return columns;
  }
  /// Adds a point to the columns, which are those of `columns()`.
  void append(const Point &point, std::vector<Column> &columns) const {
    for (std::size_t k = 0; k < list_.size(); ++k) {
      auto &values = columns[k].values;
      values.resize(values.size() + list_[k].components);
      list_[k].get(point, &values[values.size() - list_[k].components]);
    }
  }

  /// Quantities and units of the columns of history.csv for a tracked point.
  std::vector<std::pair<std::string, std::string>> tracked() const {
    std::vector<std::pair<std::string, std::string>> columns;
    for (const auto &field : list_)
      if (field.tracked == Tracked::coordinates)
        for (int d = 0; d < field.components; ++d) columns.emplace_back(std::string(1, "xyz"[d]), field.unit);
      else if (field.tracked != Tracked::no) {
        if (field.tracked != Tracked::components) columns.emplace_back(field.name, field.unit);
        if (field.tracked == Tracked::components || field.tracked == Tracked::vector)
          for (const std::string &component : component_names(field.components))
            columns.emplace_back(field.name + "_" + component, field.unit);
      }
    return columns;
  }
  /// Appends the values of these columns: zeros where `point` is null, so that sums over ranks are those of the rank
  /// that has the point.
  void append_tracked(const Point *point, std::vector<double> &row) const {
    for (const auto &field : list_) {
      if (field.tracked == Tracked::no) continue;
      std::vector<double> values(field.components, 0.);
      if (point) field.get(*point, values.data());
      if (field.tracked == Tracked::magnitude || field.tracked == Tracked::vector) {
        double square = 0;
        for (const double value : values) square += value * value;
        row.push_back(std::sqrt(square));
      }
      if (field.tracked != Tracked::magnitude) row.insert(row.end(), values.begin(), values.end());
    }
  }

 private:
  std::vector<OutputField<Point>> list_;
};

}  // namespace talus
