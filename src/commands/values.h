#pragma once
/// Values and measures as they are typed: series, lists with units, columns of a history.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scene/reader.h"

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

/// A number with so many digits.
inline std::string in_digits(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// A number and what stands behind it, its unit: "5 mm". NaN and nothing where it is none.
struct Typed {
  double number = NAN;
  std::string unit{};
};
inline Typed typed(std::string text) {
  std::erase(text, '"');
  char *end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  return end == text.c_str() ? Typed{} : Typed{number, trimmed(end)};
}

/// What is wrong with a list whose numbers have different units, or some of them a unit and others none: "4,8,12 kPa"
/// would be 4 Pa, 8 Pa and 12 kPa. Empty if nothing is.
inline std::string mixed_units(const std::vector<std::string> &values) {
  std::set<std::string> units;
  for (const std::string &value : values)
    if (!std::isnan(typed(value).number)) units.insert(typed(value).unit);
  std::string said;
  for (const std::string &unit : units)
    said += (said.empty() ? "has numbers " : " and ") + (unit.empty() ? "without a unit" : "in " + unit);
  return units.size() < 2 ? "" : said + ": give all of them one unit, or none";
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
    const auto values = pieces(equal == std::string::npos ? "" : part.substr(equal + 1), ',');
    std::string wrong = mixed_units(values);
    for (const std::string &value : values)
      if (equal == 0 || value.empty()) wrong = "must be key.path=value,value,...";
    if (!wrong.empty()) throw SceneError("--series \"" + text + "\": `" + part + "` " + wrong);
    series.lists.emplace_back(trimmed(part.substr(0, equal)), values);
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
};

/// COLUMN, COLUMN@TIME or max:COLUMN. Throws SceneError.
inline Measure parse_measure(const std::string &text) {
  const bool largest = text.starts_with("max:");
  const size_t at = text.find('@'), from = largest ? 4 : 0;
  if (at == std::string::npos) return {text.substr(from)};
  const double time = typed(text.substr(at + 1)).number;
  if (largest || !std::isfinite(time))
    throw SceneError("--measure " + text + " must be COLUMN, COLUMN@TIME or max:COLUMN");
  return {text.substr(0, at), time};
}

}  // namespace talus
