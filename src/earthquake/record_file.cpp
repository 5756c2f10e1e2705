#include "earthquake/record_file.h"

#include <cctype>
#include <cstdlib>
#include <map>
#include <ranges>
#include <regex>
#include <sstream>

#include "base/read_file.h"
#include "base/rounded.h"
#include "scene/reader.h"
#include "scene/words.h"

namespace talus {
namespace {

constexpr double gravity = 9.80665;  // of a record in g [m/s2]

/// A file of a record line by line.
class Text {
 public:
  explicit Text(const std::string &file) : file_(file) {
    std::string all;
    try {
      all = read_file(file);
    } catch (const std::system_error &error) {
      throw SceneError(error.what());
    }
    std::istringstream in(all);
    for (std::string line; std::getline(in, line);) {
      if (line.ends_with('\r')) line.pop_back();
      lines_.push_back(line);
    }
  }
  [[noreturn]] void complain(std::size_t line, const std::string &sentence) const {
    throw SceneError(file_ + " line " + std::to_string(line + 1) + ": " + sentence);
  }
  [[noreturn]] void complain(const std::string &sentence) const { throw SceneError(file_ + ": " + sentence); }
  const std::vector<std::string> &lines() const { return lines_; }
  /// Numbers from a line on, in columns or run together, until so many are read; line and column do not count. Ends at
  /// a line that begins with anything else.
  std::vector<double> numbers(std::size_t line, std::size_t count) const {
    std::vector<double> found;
    for (; line < lines_.size() && found.size() < count; ++line) {
      const char *at = lines_[line].c_str();
      while (found.size() < count) {
        char *after;
        const double value = std::strtod(at, &after);
        if (after == at) break;
        if (!std::isfinite(value)) complain(line, "has a value that is no number");
        found.push_back(value), at = after;
      }
      while (std::isspace(static_cast<unsigned char>(*at))) ++at;
      if (*at && found.size() < count)
        complain(line, "has `" + std::string(at).substr(0, 20) + "` among the values" +
                           (*at == ',' ? ": numbers need decimal points, not commas" : ""));
    }
    return found;
  }
  /// The same, for files that say how many values there are.
  std::vector<double> values(std::size_t line, std::size_t count, double unit) const {
    std::vector<double> found = numbers(line, count);
    if (found.size() < count)
      complain("says that it has " + std::to_string(count) + " values, and has " + std::to_string(found.size()) +
               ": it is cut off, or damaged");
    for (double &one : found) one *= unit;
    return found;
  }

 private:
  std::string file_;
  std::vector<std::string> lines_;
};

/// The unit of an acceleration in SI, as records write it; 0 for another one.
double acceleration_unit(std::string name) {
  for (char &c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (const std::size_t square = name.find("\u00b2"); square != std::string::npos) name.replace(square, 2, "2");
  std::erase_if(name, [](char c) { return c == ' ' || c == '^' || c == '*' || c == '_'; });
  if (name == "g") return gravity;
  if (name == "%g") return gravity / 100;
  if (name == "mg") return gravity / 1000;
  if (name == "gal" || name == "cm/s2" || name == "cm/sec2" || name == "cm/s/s" || name == "cm/sec/sec") return 0.01;
  if (name == "m/s2" || name == "m/sec2" || name == "m/s/s" || name == "ms2" || name == "m/sec/sec") return 1;
  return 0;
}

/// The channel that is asked for, among those of a file.
std::size_t choose_channel(const Text &text, const std::string &component, std::size_t channels) {
  if (component.empty() && channels == 1) return 0;
  char *after;
  const long number = std::strtol(component.c_str(), &after, 10);
  if (component.empty() || *after || number < 1 || number > static_cast<long>(channels))
    text.complain("has " + std::to_string(channels) +
                  " channels of acceleration: choose one by component = \"1\" to \"" + std::to_string(channels) + "\"");
  return static_cast<std::size_t>(number) - 1;
}

/// PEER NGA: the fourth line has the number of values and the step, in old files without their names; the third says
/// in which unit accelerations are, g in those of PEER.
GroundMotion read_peer(const Text &text) {
  static const std::regex named(R"(NPTS\s*=\s*(\d+)\s*,\s*DT\s*=\s*([\d.Ee+-]+))", std::regex::icase),
      bare(R"(^\s*(\d+)\s+([\d.]+)\s+NPTS,\s*DT)", std::regex::icase),
      in_unit(R"(UNITS? OF\s+([A-Za-z0-9/^%]+))", std::regex::icase);
  for (std::size_t k = 0; k < text.lines().size() && k < 8; ++k) {
    std::smatch found;
    if (!std::regex_search(text.lines()[k], found, named) && !std::regex_search(text.lines()[k], found, bare)) continue;
    const std::string kind = k > 0 ? text.lines()[k - 1] : "";
    static const std::regex other("VELOCITY|DISPLACEMENT", std::regex::icase);
    if (std::regex_search(kind, other))
      text.complain(k - 1, "is a record of velocity or displacement; take the .AT2 file");
    std::smatch named_unit;
    const bool said = std::regex_search(kind, named_unit, in_unit);
    const double unit = said ? acceleration_unit(named_unit[1]) : gravity;
    if (unit == 0)
      text.complain(k - 1, "has accelerations in " + named_unit[1].str() + "; known are g, cm/s2, gal, m/s2");
    return {std::stod(found[2]), text.values(k + 1, std::stoul(found[1]), unit)};
  }
  text.complain("has no line with NPTS and DT");
}

/// CSMIP volume 2: "4002 points of accel data equally spaced at .010 sec, in cm/sec2. (8f10.3)" before the values.
GroundMotion read_csmip(const Text &text, const std::string &component) {
  static const std::regex begin(
      R"((\d+)\s+points of accel data equally spaced at\s+([\d.]+)\s*sec[^,]*,?\s*in\s+([^\s.(]+))", std::regex::icase);
  std::vector<std::pair<std::size_t, std::smatch>> channels;
  for (std::size_t k = 0; k < text.lines().size(); ++k)
    if (std::smatch found; std::regex_search(text.lines()[k], found, begin)) channels.emplace_back(k, found);
  const auto &[line, found] = channels[choose_channel(text, component, channels.size())];
  const double unit = acceleration_unit(found[3]);
  if (unit == 0) text.complain(line, "has accelerations in " + found[3].str() + "; known are g, cm/s2, gal, m/s2");
  return {std::stod(found[2]), text.values(line + 1, std::stoul(found[1]), unit)};
}

/// COSMOS volume 2: "12091 acceleration pts, approx 120 secs, units=cm/s^2 (4),Format=(1F15.6E)" before the values; the
/// step is the 34th number of the real header [ms] (COSMOS 2001, strong motion data format 1.20).
GroundMotion read_cosmos(const Text &text, const std::string &component) {
  static const std::regex header(R"((\d+)\s+real-header values)", std::regex::icase),
      begin(R"((\d+)\s+acceleration pts,\s*approx\s+[\d.]+\s*secs,\s*units=\s*([^\s,(]+))", std::regex::icase);
  struct Channel {
    std::size_t line, count;
    double step;
    std::string unit;
  };
  std::vector<Channel> channels;
  double step = 0;  // of the last header
  for (std::size_t k = 0; k < text.lines().size(); ++k) {
    std::smatch found;
    if (std::regex_search(text.lines()[k], found, header)) {
      constexpr std::size_t of_step = 34;
      const std::vector<double> reals = text.values(k + 1, std::stoul(found[1]), 1);
      step = reals.size() < of_step ? 0 : reals[of_step - 1] / 1000;
    } else if (std::regex_search(text.lines()[k], found, begin)) {
      channels.push_back({k, std::stoul(found[1]), step, found[2]});
    }
  }
  const Channel &one = channels[choose_channel(text, component, channels.size())];
  const double unit = acceleration_unit(one.unit);
  if (unit == 0) text.complain(one.line, "has accelerations in " + one.unit + "; known are g, cm/s2, gal, m/s2");
  if (!(one.step > 0)) text.complain(one.line, "follows on a header without the step of time");
  return {one.step, text.values(one.line + 1, one.count, unit)};
}

/// ESM: a header of lines KEY: VALUE, then a value a line.
GroundMotion read_esm(const Text &text) {
  static const std::regex entry(R"(^([A-Z0-9_]+)\s*:\s*(.*?)\s*$)");
  std::map<std::string, std::string> header;
  std::size_t first = 0;
  for (std::smatch found; first < text.lines().size() && std::regex_match(text.lines()[first], found, entry); ++first)
    header[found[1]] = found[2];
  if (header["DATA_TYPE"] != "ACCELERATION" && !header["DATA_TYPE"].empty())
    text.complain("is a record of " + header["DATA_TYPE"] + "; take that of acceleration");
  const double unit = acceleration_unit(header["UNITS"]),
               step = std::strtod(header["SAMPLING_INTERVAL_S"].c_str(), nullptr);
  if (unit == 0) text.complain("has UNITS " + header["UNITS"] + "; known are cm/s^2, g, m/s^2");
  return {step, text.values(first, std::strtoul(header["NDATA"].c_str(), nullptr, 10), unit)};
}

/// The name and the unit of a column: "acc_x [g]", "time (s)", "acceleration_m_s2".
struct Column {
  std::string name;
  double unit = 0;  ///< in SI; 0: none of a time or an acceleration
  bool time = false;
};

Column column_of(std::string head) {
  static const std::regex bracketed(R"re(^\s*"?\s*(.*?)\s*[\[(]\s*([^\])]+?)\s*[\])]\s*"?\s*$)re"),
      suffixed(R"re(^\s*"?(.*?)_(m_s2|cm_s2|gal|mg|g|s|ms)"?\s*$)re");
  Column column{head};
  std::smatch found;
  if (!std::regex_match(head, found, bracketed) && !std::regex_match(head, found, suffixed)) return column;
  column.name = found[1];
  std::string unit = found[2];
  if (unit == "m_s2") unit = "m/s2";
  if (unit == "cm_s2") unit = "cm/s2";
  column.time = unit == "s" || unit == "sec" || unit == "ms";
  column.unit = column.time ? (unit == "ms" ? 1e-3 : 1) : acceleration_unit(unit);
  return column;
}

/// Between the names of columns. Where it is no comma, a comma in a number is a decimal one.
char separator_of(const std::string &head) {
  return head.find(';') != std::string::npos ? ';' : head.find('\t') != std::string::npos ? '\t' : ',';
}

std::vector<std::string> fields_of(const std::string &line, char separator) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, separator);) fields.push_back(field);
  return fields;
}

/// CSV: one line of names with units, then time and accelerations. Lines that begin with # are remarks.
GroundMotion read_csv(const Text &text, const std::string &component) {
  std::size_t head = 0;
  const std::vector<std::string> &lines = text.lines();
  const auto idle = [&](std::size_t k) {
    return lines[k].find_first_not_of(" \t") == std::string::npos || lines[k][0] == '#';
  };
  while (head < lines.size() && idle(head)) ++head;
  if (head == lines.size()) text.complain("has no record");
  const char separator = separator_of(lines[head]);
  std::vector<Column> columns;
  for (const std::string &field : fields_of(lines[head], separator)) columns.push_back(column_of(field));
  const auto time = std::ranges::find_if(columns, &Column::time);
  std::vector<std::string> names;
  std::vector<std::size_t> accelerations;
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (!columns[c].time && columns[c].unit > 0) names.push_back(columns[c].name), accelerations.push_back(c);
  if (time == columns.end() || names.empty())
    text.complain(head,
                  "must name the columns of time and acceleration with their units, as in \"time [s], acceleration "
                  "[g]\"; known are s, ms, g, %g, mg, cm/s2, gal, m/s2");
  const auto wanted = component.empty() ? names.begin() : std::ranges::find(names, component);
  if (wanted == names.end() || (component.empty() && names.size() > 1))
    text.complain(head, "has the accelerations " + join(names) + ": choose one by component");
  const std::size_t of_time = static_cast<std::size_t>(time - columns.begin()),
                    of_value = accelerations[static_cast<std::size_t>(wanted - names.begin())];
  std::vector<double> times, values;
  std::vector<std::size_t> line_of;
  for (std::size_t k = head + 1; k < lines.size(); ++k) {
    if (idle(k)) continue;
    std::vector<std::string> fields = fields_of(lines[k], separator);
    if (fields.size() > columns.size())
      text.complain(k, "has " + std::to_string(fields.size()) + " columns, and the header names " +
                           std::to_string(columns.size()) +
                           ": are there decimal commas? Separate columns by semicolons then, also in the header");
    if (separator != ',')
      for (std::string &field : fields) std::ranges::replace(field, ',', '.');
    for (const std::size_t c : {of_time, of_value}) {
      char *after = nullptr;
      const double value = c < fields.size() ? std::strtod(fields[c].c_str(), &after) : 0;
      if (!after || after == fields[c].c_str() || !std::isfinite(value))
        text.complain(k, "has no number in column " + std::to_string(c + 1) + ", " + columns[c].name);
      (c == of_time ? times : values).push_back(value * columns[c].unit);
    }
    line_of.push_back(k);
  }
  if (times.size() < 2) text.complain("has fewer than two values");
  const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  std::vector<double> apart;
  for (std::size_t k = 1; k < times.size(); ++k) {
    apart.push_back(times[k] - times[k - 1]);
    if (!(apart.back() > 0)) text.complain(line_of[k], "does not go on in time");
  }
  std::ranges::nth_element(apart, apart.begin() + static_cast<std::ptrdiff_t>(apart.size() / 2));
  const double usual = apart[apart.size() / 2];
  constexpr double uneven = 0.5;            // of the step: rounded times are apart by less
  const auto drifts = [&](std::size_t k) {  // unlike `usual`, the mean is no rounded time
    return std::abs(times[k] - times.front() - static_cast<double>(k) * step) > uneven * step;
  };
  const auto gap = [&](std::size_t k) { return std::abs(times[k] - times[k - 1] - usual) > uneven * usual; };
  std::size_t first = 1;
  while (first < times.size() && !gap(first)) ++first;
  for (std::size_t k = first < times.size() ? first : 1; k < times.size(); ++k)
    if (gap(k) || drifts(k))
      text.complain(line_of[k], "comes " + rounded(times[k] - times[k - 1]) +
                                    " s after the line before, and most come " + rounded(usual) +
                                    " s after: values must be at equal steps, without gaps");
  return {step, values};
}

}  // namespace

GroundMotion read_record(const std::string &file, const std::string &component) {
  const Text text(file);
  const auto has = [&](const char *words) {
    constexpr std::size_t longest_header = 100;
    const std::regex pattern(words, std::regex::icase);
    return std::ranges::any_of(text.lines() | std::views::take(longest_header),
                               [&](const std::string &line) { return std::regex_search(line, pattern); });
  };
  GroundMotion motion = has("SAMPLING_INTERVAL_S")                   ? read_esm(text)
                        : has("points of accel data equally spaced") ? read_csmip(text, component)
                        : has("acceleration pts, *approx")           ? read_cosmos(text, component)
                        : has("NPTS")                                ? read_peer(text)
                                                                     : read_csv(text, component);
  constexpr double most = 5 * gravity;  // the largest ever recorded on the ground is about 4 g
  if (!(motion.step > 0) || motion.acceleration.size() < 2) text.complain("has no record: its step of time is 0");
  if (motion.peak() == 0) text.complain("has no motion: all of its accelerations are 0");
  if (motion.peak() > most)
    text.complain("has a peak of " + rounded(motion.peak() / gravity) +
                  " g, more than ground has ever had: is its unit right?");
  return motion;
}

}  // namespace talus
