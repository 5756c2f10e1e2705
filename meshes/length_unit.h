#pragma once
/// Units of length that sections are drawn in.
#include <algorithm>
#include <string>

namespace talus {

struct LengthUnit {
  const char *sign, *name;
  double metres;
  int in_drawings;  ///< number of $INSUNITS (Autodesk, DXF reference, HEADER section)
};
inline constexpr LengthUnit length_units[] = {
    {"m", "metres", 1, 6},          {"mm", "millimetres", 1e-3, 4},
    {"cm", "centimetres", 1e-2, 5}, {"dm", "decimetres", 0.1, 14},
    {"km", "kilometres", 1e3, 7},   {"ft", "feet", 0.3048, 2},
    {"in", "inches", 0.0254, 1},    {"ftUS", "US survey feet", 1200. / 3937, 21}};
inline constexpr const LengthUnit &metres = length_units[0];

/// "m, mm, ...".
inline std::string known_length_units() {
  std::string signs;
  for (const LengthUnit &unit : length_units) signs += (signs.empty() ? "" : ", ") + std::string(unit.sign);
  return signs;
}

}  // namespace talus
