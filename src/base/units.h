#pragma once
/// Units of scene quantities: a name, its factor to SI, and its dimension as exponents of kg, m, s (and angle, K).
#include <limits>

namespace talus {

struct Dimension {
  int mass = 0, length = 0, time = 0, angle = 0, temperature = 0;
  constexpr bool operator==(const Dimension &) const = default;
};
struct Unit {
  const char *name;
  double si;  ///< value in SI = number * si
  Dimension dimension;
};
inline constexpr Unit one{"-", 1, {}};
inline constexpr Unit metre{"m", 1, {0, 1, 0, 0}};
inline constexpr Unit second{"s", 1, {0, 0, 1, 0}};
inline constexpr Unit hertz{"Hz", 1, {0, 0, -1, 0}};
inline constexpr Unit pascal{"Pa", 1, {1, -1, -2, 0}};
inline constexpr Unit degree{"deg", 3.14159265358979323846 / 180, {0, 0, 0, 1}};
inline constexpr Unit metre_per_second{"m/s", 1, {0, 1, -1, 0}};
inline constexpr Unit metre_per_second_squared{"m/s2", 1, {0, 1, -2, 0}};
inline constexpr Unit kilogram_per_cubic_metre{"kg/m3", 1, {1, -3, 0, 0}};
inline constexpr Unit newton_per_cubic_metre{"N/m3", 1, {1, -2, -2, 0}};
inline constexpr Unit square_metre{"m2", 1, {0, 2, 0, 0}};
inline constexpr Unit per_pascal{"1/Pa", 1, {-1, 1, 2, 0}};
inline constexpr Unit degree_per_pascal{"deg/Pa", degree.si, {-1, 1, 2, 1}};
inline constexpr Unit pascal_second{"Pa s", 1, {1, -1, -1, 0}};
inline constexpr Unit joule_per_cubic_metre_kelvin{"J/(m3 K)", 1, {1, -1, -2, 0, -1}};
inline constexpr Unit watt_per_metre_kelvin{"W/(m K)", 1, {1, 1, -3, 0, -1}};
inline constexpr Unit pascal_per_kelvin{"Pa/K", 1, {1, -1, -2, 0, -1}};

/// Values of a scene key that engineers use, in the unit of the key; the program doubts others (scene/usual.h).
struct Usual {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  bool or_zero = false;  ///< 0 has a meaning of its own
};
inline constexpr bool or_zero = true;

/// Allowed values of a scene key, in the unit of the key.
struct Range {
  double low, high;
  Usual usual{};
};

}  // namespace talus
