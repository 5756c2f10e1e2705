#pragma once
/// Values and measures as they are typed: series, lists with units, columns of a history.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "scene/reader.h"
#include "scene/words.h"

namespace talus {

/// A line of the chart: keys with the values that they take in turn.
struct Series {
  std::string name;
  std::vector<std::pair<std::string, std::vector<std::string>>> lists;
};

inline std::string trimmed(const std::string &text) {
  const size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Pieces between separators that stand outside brackets and quotes.
inline std::vector<std::string> pieces(const std::string &text, char separator) {
  std::vector<std::string> out(1);
  int depth = 0;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (!quoted) depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (c == separator && depth == 0 && !quoted)
      out.emplace_back();
    else
      out.back() += c;
  }
  for (std::string &piece : out) piece = trimmed(piece);
  return out;
}

/// A number, also one with a unit behind it ("5 mm"); NaN if it is none.
inline double number_of(const std::string &text) {
  const std::string bare = !text.empty() && text.front() == '"' ? text.substr(1) : text;
  char *end = nullptr;
  const double value = std::strtod(bare.c_str(), &end);
  return end == bare.c_str() ? NAN : value;
}

/// What stands behind the number of a value, its unit; empty where it is none.
inline std::string unit_behind(const std::string &text) {
  if (std::isnan(number_of(text))) return "";
  std::string bare = text;
  std::erase(bare, '"');
  char *end = nullptr;
  std::strtod(bare.c_str(), &end);
  return trimmed(end);
}

/// What is wrong with a list whose numbers have different units, or some of them a unit and others none: those would be
/// read in the unit of the key, "4,8,12 kPa" as 4 Pa, 8 Pa and 12 kPa, and charts would order them by their numbers.
/// Empty if nothing is.
inline std::string mixed_units(const std::vector<std::string> &values) {
  std::vector<std::string> numbers;
  for (const std::string &value : values)
    if (!std::isnan(number_of(value))) numbers.push_back(value);
  if (numbers.empty()) return "";
  const std::string &last = numbers.back(), unit = unit_behind(last);
  for (const std::string &value : numbers) {
    const std::string other = unit_behind(value), named = unit.empty() ? other : unit;
    if (other == unit) continue;
    std::string all;
    for (const std::string &one : numbers)
      all += (all.empty() ? "" : ",") + one + (unit_behind(one).empty() ? " " + named : "");
    return !other.empty() && !unit.empty()
               ? "has values in " + other + " and in " + unit + ": give all of them in one unit"
               : "has a unit at " + (unit.empty() ? value : last) + " and none at " + (unit.empty() ? last : value) +
                     ", which would be a number in the unit of the key: give all of them a unit, such as " + all +
                     ", or none";
  }
  return "";
}

/// "NAME: key=a,b; key=c". Throws SceneError.
inline Series parse_series(const std::string &text) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos || trimmed(text.substr(0, colon)).empty())
    throw SceneError("--series \"" + text +
                     "\" needs a name and a colon first, such as \"euler: integrator.fraction=0.2,0.4\"");
  Series series{trimmed(text.substr(0, colon)), {}};
  for (const std::string &part : pieces(text.substr(colon + 1), ';')) {
    if (part.empty()) continue;
    const size_t equal = part.find('=');
    if (equal == std::string::npos || equal == 0)
      throw SceneError("--series \"" + text + "\": `" + part + "` must be key.path=value,value,...");
    series.lists.emplace_back(trimmed(part.substr(0, equal)), pieces(part.substr(equal + 1), ','));
    for (const std::string &value : series.lists.back().second)
      if (value.empty()) throw SceneError("--series \"" + text + "\": `" + part + "` has an empty value");
    if (const std::string wrong = mixed_units(series.lists.back().second); !wrong.empty())
      throw SceneError("--series \"" + text + "\": `" + part + "` " + wrong);
  }
  return series;
}

/// Every combination as overrides key=value; the last key varies fastest.
inline std::vector<std::vector<std::string>> products(const Series &series) {
  std::vector<std::vector<std::string>> all{{}};
  for (const auto &[key, values] : series.lists) {
    std::vector<std::vector<std::string>> next;
    for (const auto &head : all)
      for (const std::string &value : values) {
        next.push_back(head);
        next.back().push_back(key + "=" + value);
      }
    all = std::move(next);
  }
  return all;
}

/// What is read off a history.
struct Measure {
  std::string column;
  double time = NAN;  ///< NaN: the last line
  bool largest = false;
};

inline Measure parse_measure(const std::string &text) {
  Measure m;
  m.largest = text.rfind("max:", 0) == 0;
  m.column = m.largest ? text.substr(4) : text;
  const size_t at = m.column.find('@');
  if (at == std::string::npos) return m;
  m.time = number_of(m.column.substr(at + 1)), m.column = m.column.substr(0, at);
  if (m.largest || !std::isfinite(m.time))
    throw SceneError("--measure " + text + " must be COLUMN, COLUMN@TIME or max:COLUMN");
  return m;
}

/// A cell of a CSV file without its quotes.
inline std::string unquoted(const std::string &cell) {
  if (cell.size() < 2 || cell.front() != '"' || cell.back() != '"') return cell;
  std::string text;
  for (std::size_t i = 1; i + 1 < cell.size(); ++i) {
    text += cell[i];
    if (cell[i] == '"') ++i;  // a doubled quote stands for one
  }
  return text;
}

/// The names of the columns of a history.csv; none where its first line is not written yet.
inline std::vector<std::string> columns_of(const std::string &path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || file.eof()) return {};
  std::vector<std::string> names = pieces(line, ',');
  for (std::string &name : names) name = unquoted(name);
  return names;
}

/// Throws SceneError with the nearest name where history.csv with the columns `names` lacks one.
inline void require_column(const std::vector<std::string> &names, const std::string &column) {
  if (std::find(names.begin(), names.end(), column) == names.end())
    throw SceneError("history.csv has no column " + column + "; " + suggestion(column, names));
}

}  // namespace talus
