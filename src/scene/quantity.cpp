#include "scene/quantity.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <vector>

#include "scene/words.h"

namespace talus {
namespace {

struct NamedUnit {
  std::string_view name;
  double si;
  Dimension dimension;
  bool prefixed;  ///< takes SI prefixes
};

constexpr Dimension mass{1, 0, 0, 0}, length{0, 1, 0, 0}, time{0, 0, 1, 0}, angle{0, 0, 0, 1};
constexpr Dimension force{1, 1, -2, 0}, pressure{1, -1, -2, 0}, energy{1, 2, -2, 0}, power{1, 2, -3, 0};

constexpr double foot = 0.3048, pound_force = 0.45359237 * 9.80665;  // [m], [N], exact by definition

constexpr NamedUnit named_units[] = {
    {"m", 1, length, true},
    {"s", 1, time, true},
    {"g", 1e-3, mass, true},
    {"t", 1e3, mass, true},
    {"N", 1, force, true},
    {"Pa", 1, pressure, true},
    {"bar", 1e5, pressure, true},
    {"atm", 101325, pressure, false},
    {"lbf", pound_force, force, false},
    {"kip", 1e3 * pound_force, force, false},
    {"in", foot / 12, length, false},
    {"ft", foot, length, false},
    {"psf", pound_force / (foot * foot), pressure, false},
    {"psi", pound_force / (foot * foot / 144), pressure, false},
    {"pcf", pound_force / (foot * foot * foot), {1, -2, -2, 0}, false},  // a unit weight
    {"J", 1, energy, true},
    {"W", 1, power, true},
    {"K", 1, {0, 0, 0, 0, 1}, false},
    {"Hz", 1, {0, 0, -1, 0}, true},
    {"l", 1e-3, {0, 3, 0, 0}, true},
    {"L", 1e-3, {0, 3, 0, 0}, true},
    {"darcy", 9.869233e-13, {0, 2, 0, 0}, true},
    {"min", 60, time, false},
    {"h", 3600, time, false},
    {"hour", 3600, time, false},
    {"hours", 3600, time, false},
    {"d", 86400, time, false},
    {"day", 86400, time, false},
    {"days", 86400, time, false},
    {"year", 31557600, time, false},
    {"years", 31557600, time, false},
    {"rad", 1, angle, false},
    {"deg", degree.si, angle, false},
    {"°", degree.si, angle, false},
    {"%", 0.01, {}, false},
};

struct Prefix {
  std::string_view name;
  double factor;
};
constexpr Prefix prefixes[] = {{"n", 1e-9}, {"u", 1e-6}, {"µ", 1e-6}, {"μ", 1e-6}, {"m", 1e-3}, {"c", 1e-2},
                               {"d", 1e-1}, {"h", 1e2},  {"k", 1e3},  {"M", 1e6},  {"G", 1e9}};

/// Factor to SI and dimension of a unit or of a product of units.
struct Measure {
  double si = 1;
  Dimension dimension{};
};

Measure operator*(const Measure &a, const Measure &b) {
  const Dimension &p = a.dimension, &q = b.dimension;
  return {a.si * b.si,
          {p.mass + q.mass, p.length + q.length, p.time + q.time, p.angle + q.angle, p.temperature + q.temperature}};
}

/// By repeated products and one quotient, so that (1e-2)^-2 is exactly 1e4.
Measure power_of(const Measure &a, int exponent) {
  const Dimension &d = a.dimension;
  double si = 1;
  for (int i = 0; i < std::abs(exponent); ++i) si *= a.si;
  return {exponent < 0 ? 1 / si : si,
          {d.mass * exponent, d.length * exponent, d.time * exponent, d.angle * exponent, d.temperature * exponent}};
}

std::optional<Measure> find_unit(std::string_view name) {
  for (const NamedUnit &unit : named_units)
    if (unit.name == name) return Measure{unit.si, unit.dimension};
  for (const Prefix &prefix : prefixes) {
    if (!name.starts_with(prefix.name)) continue;
    for (const NamedUnit &unit : named_units)
      if (unit.prefixed && unit.name == name.substr(prefix.name.size()))
        return Measure{unit.name == "g" ? prefix.factor / 1e3 : prefix.factor * unit.si, unit.dimension};
  }
  return std::nullopt;
}

/// The unit that a name is but for small and capital letters, `kPa` for `KPA`; empty if there is none. Of several, the
/// first prefix.
std::string unit_in_other_case(std::string_view name) {
  const auto same = [&](const std::string &unit) {
    return std::ranges::equal(name, unit,
                              [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
  };
  for (const NamedUnit &unit : named_units) {
    if (same(std::string(unit.name))) return std::string(unit.name);
    for (const Prefix &prefix : prefixes)
      if (const std::string with = std::string(prefix.name) + std::string(unit.name); unit.prefixed && same(with))
        return with;
  }
  return "";
}

[[noreturn]] void refuse_unit(std::string_view name) {
  std::vector<std::string> names;
  for (const NamedUnit &unit : named_units) names.emplace_back(unit.name);
  if (const std::string meant = unit_in_other_case(name); !meant.empty())
    throw std::invalid_argument("`" + std::string(name) + "` is no unit; did you mean `" + meant + "`?");
  throw std::invalid_argument("`" + std::string(name) + "` is no unit; known, with SI prefixes where usual, are " +
                              join(names));
}

/// Reads a unit from left to right.
class UnitText {
 public:
  explicit UnitText(std::string_view text) : rest_(text) {}

  Measure read() {
    const Measure measure = product();
    if (!rest_.empty()) throw std::invalid_argument("cannot read `" + std::string(rest_) + "` in the unit");
    return measure;
  }

 private:
  Measure product() {
    Measure all = factor();
    while (!rest_.empty() && rest_[0] != ')') {
      const bool divides = take("/");
      if (!divides) (void)(take("*") || take("·") || take("."));
      all = all * power_of(factor(), divides ? -1 : 1);
      skip_blanks();
    }
    return all;
  }

  Measure factor() {
    skip_blanks();
    if (take("(")) {
      if (++depth_ > deepest) throw std::invalid_argument("parentheses are nested too deeply in the unit");
      const Measure inner = product();
      --depth_;
      if (!take(")")) throw std::invalid_argument("a parenthesis is not closed in the unit");
      return power_of(inner, exponent());
    }
    if (take("1")) return {};
    std::size_t end = 0;
    while (end < rest_.size() && is_letter(rest_.substr(end))) ++end;
    const std::string_view name = rest_.substr(0, end);
    const std::optional<Measure> unit = find_unit(name);
    if (!unit) refuse_unit(name.empty() ? rest_ : name);
    rest_.remove_prefix(end);
    return power_of(*unit, exponent());
  }

  int exponent() {
    int value = 1;
    if (take("²")) {
      value = 2;
    } else if (take("³")) {
      value = 3;
    } else {
      const bool caret = take("^");
      const auto [end, error] = std::from_chars(rest_.begin(), rest_.end(), value);
      if (caret && error != std::errc()) throw std::invalid_argument("a whole number must follow `^` in the unit");
      if (error == std::errc()) rest_.remove_prefix(end - rest_.begin());
      if (std::abs(value) > 9) throw std::invalid_argument("a power of more than 9 in the unit");
    }
    skip_blanks();
    return value;
  }

  /// Letters, %, and the bytes of ° and µ, but not those of · ² ³, which begin alike.
  static bool is_letter(std::string_view text) {
    for (const std::string_view mark : {"·", "²", "³"})
      if (text.starts_with(mark)) return false;
    const unsigned char c = text[0];
    return std::isalpha(c) || c == '%' || c >= 0x80;
  }

  bool take(std::string_view token) {
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }

  void skip_blanks() {
    while (take(" ")) {
    }
  }

  static constexpr int deepest = 20;  // of parentheses: each takes room on the stack
  std::string_view rest_;
  int depth_ = 0;
};

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Takes a number off the front of the text; `1e5`, `.5` and `+3` are numbers, `inf` and `nan` are not.
std::optional<double> take_number(std::string_view &text) {
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  const std::size_t first = digits.starts_with('-') ? 1 : 0;
  if (digits.size() <= first || !(std::isdigit((unsigned char)digits[first]) || digits[first] == '.')) return {};
  double number = 0;
  const auto [end, error] = std::from_chars(digits.begin(), digits.end(), number);
  if (error != std::errc()) return {};
  text = trim(digits.substr(end - digits.begin()));
  return number;
}

/// Does a decimal comma follow the digits that were read?
bool has_decimal_comma(std::string_view rest) {
  return rest.size() > 1 && rest[0] == ',' && std::isdigit((unsigned char)rest[1]);
}

/// What is likely meant where `given` stands for a key of dimension `wanted`.
struct Confusion {
  Dimension wanted, given;
  const char *hint;
};
constexpr Dimension unit_weight{1, -2, -2, 0}, speed{0, 1, -1, 0};
constexpr Confusion confusions[] = {
    {square_metre.dimension, speed, "that is a hydraulic_conductivity; permeability is in m2"},
    {speed, square_metre.dimension, "that is a permeability; hydraulic_conductivity is in m/s"},
    {kilogram_per_cubic_metre.dimension, unit_weight, "that is a unit weight; divide by g for a density"},
    {unit_weight, kilogram_per_cubic_metre.dimension, "that is a density; multiply by g for a unit weight"},
    {pressure, force, "that is a force; divide by the area it acts on"},
    {pressure, {1, -2, 0, 0}, "that is a mass per area; multiply by g for a stress"},
    {pascal_second.dimension, {0, 2, -1, 0}, "that is a kinematic viscosity; multiply by the density"},
    {angle, {}, "that is a slope or a share; state the angle in deg or rad"},
};

std::string hint(const Dimension &wanted, const Dimension &given) {
  for (const Confusion &confusion : confusions)
    if (confusion.wanted == wanted && confusion.given == given) return confusion.hint;
  return "";
}

}  // namespace

bool looks_like_quantity(std::string_view text) {
  text = trim(text);
  if (!take_number(text)) return false;
  const bool per = text.starts_with("1/");
  return text.empty() || per || has_decimal_comma(text) || std::isalpha((unsigned char)text[0]) || text[0] == '%' ||
         (unsigned char)text[0] >= 0x80;
}

Quantity parse_quantity(std::string_view text) {
  std::string_view rest = trim(text);
  const std::optional<double> number = take_number(rest);
  if (!number) throw std::invalid_argument("a number, or a number and its unit, is expected");
  if (!std::isfinite(*number)) throw std::invalid_argument("the number is not finite");
  if (rest.empty()) return {*number, true, 1, {}};
  if (has_decimal_comma(rest)) throw std::invalid_argument("decimals are written with a point, 7.5 and not 7,5");
  const Measure measure = UnitText(rest).read();
  return {*number, false, measure.si, measure.dimension};
}

double in_unit(std::string_view text, const Unit &unit) {
  const Quantity quantity = parse_quantity(text);
  if (quantity.plain) return quantity.number;
  constexpr Dimension gram{1, 0, 0}, acceleration{0, 1, -2};
  constexpr double standard_gravity = 9.80665;                                              // [m/s2]
  if (unit.dimension == acceleration && quantity.dimension == gram && quantity.si == 1e-3)  // "0.3 g"
    return quantity.number * standard_gravity / unit.si;
  if (!(quantity.dimension == unit.dimension)) {
    const std::string why = hint(unit.dimension, quantity.dimension);
    if (!why.empty()) throw std::invalid_argument(why);
    if (unit.dimension == Dimension{}) throw std::invalid_argument("it is a number without a unit");
    throw std::invalid_argument(std::string("its unit must measure the same as ") + unit.name);
  }
  return quantity.number * (quantity.si / unit.si);
}

std::string shortest(double value) {
  char text[32];
  std::string number(text, std::to_chars(std::begin(text), std::end(text), value).ptr);
  const std::size_t e = number.find('e');
  if (e == std::string::npos) return number;
  if (number[e + 1] == '+') number.erase(e + 1, 1);
  const std::size_t exponent = e + (number[e + 1] == '-' ? 2 : 1);
  if (number[exponent] == '0') number.erase(exponent, 1);  // to_chars writes at least two digits
  return number;
}

}  // namespace talus
