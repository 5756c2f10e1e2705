#pragma once
/// The arithmetic of `talus compare`: what its arguments mean, and what a series converges to.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "output/events.h"
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

/// A sentence with # for each of its numbers and their signs, alike for sentences that differ in their numbers alone.
inline std::string without_numbers(const std::string &sentence) {
  static const std::regex number("-?[0-9][0-9.]*(e[-+]?[0-9]+)?");
  return std::regex_replace(sentence, number, "#");
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

/// Did the run with this history.csv end with its soil at rest, by rest_speed, or in equilibrium?
inline bool ended_at_rest(const std::string &history, const std::string &last_stage) {
  return std::ranges::any_of(read_events(std::filesystem::path(history).parent_path()), [&](const Event &one) {
    return one.stage == last_stage &&
           (one.kind == event::rest || one.kind == event::slow || one.kind == event::equilibrium);
  });
}

/// The measure of a history.csv, linear between its lines. At a time after the end of a run that came to rest before,
/// the last line counts; after another end there is no value (NaN). Throws SceneError for a column it lacks.
inline double value_of(const std::string &path, const Measure &measure) {
  std::ifstream file(path);
  std::string line, last_stage;
  std::getline(file, line);
  const std::vector<std::string> names = columns_of(path);
  require_column(names, measure.column);
  const auto place = [&](const std::string &name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const std::size_t column = place(measure.column), stage = place("stage");
  double last_time = 0, last = NAN, largest = -INFINITY;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = pieces(line, ',');
    if (cells.size() != names.size()) continue;
    const double time = number_of(cells[0]), value = number_of(cells[column]);
    if (time >= measure.time * (1 - 1e-9))
      return std::isnan(last) || time <= measure.time
                 ? value
                 : last + (value - last) * (measure.time - last_time) / (time - last_time);
    last_time = time, last = value, largest = std::max(largest, value);
    if (stage < cells.size()) last_stage = unquoted(cells[stage]);
  }
  if (measure.largest) return std::isfinite(largest) ? largest : NAN;
  return std::isnan(measure.time) || ended_at_rest(path, last_stage) ? last : NAN;
}

struct Reference {
  double value, uncertainty;
  std::string origin;
};

/// Limit of values refined by a parameter that goes to zero, from the three finest: Richardson's extrapolation with the
/// order that they show, if they converge at one between 0.5 and 8, and if above 2.5 a fourth run, where there is one,
/// lies on the same way (a high order is otherwise a coincidence of the last two runs); otherwise the finest value, as
/// uncertain as the last two refinements changed it. A refinement that changed nothing, such as a tolerance where
/// stability rules, is none.
inline Reference extrapolate(std::vector<std::pair<double, double>> refined) {
  std::erase_if(refined, [](const auto &p) { return !std::isfinite(p.first) || !std::isfinite(p.second); });
  std::sort(refined.rbegin(), refined.rend());
  refined.erase(std::unique(refined.begin(), refined.end(),
                            [](const auto &p, const auto &finer) { return finer.second == p.second; }),
                refined.end());
  std::reverse(refined.begin(), refined.end());
  if (refined.size() < 2) return {NAN, INFINITY, "too few runs"};
  const double finest = refined[0].second, change = refined[1].second - finest;
  double uncertain = std::abs(change);
  if (refined.size() > 2) {
    const double before = refined[2].second - refined[1].second, r1 = refined[1].first / refined[0].first,
                 r2 = refined[2].first / refined[1].first;
    uncertain = std::max(uncertain, std::abs(before));
    if (change * before > 0 && std::abs(r1 - r2) < 0.05 * r1) {
      const double order = std::log(before / change) / std::log(r1);
      const double earlier = refined.size() > 3 ? refined[3].second - refined[2].second : before;
      const bool by_chance = order > 2.5 && !(earlier * before > 0 && std::abs(earlier) >= std::abs(before));
      if (order > 0.5 && order < 8 && !by_chance) {
        const double rest = change / (std::pow(r1, order) - 1);
        std::ostringstream text;
        text.precision(2);
        text << "extrapolated at the observed order " << order;
        return {finest - rest, std::abs(rest), text.str()};
      }
    }
  }
  return {finest, uncertain, "its finest run"};
}

}  // namespace talus
