#pragma once
/// Quantities as a scene writes them: "20 MPa", "1.3e-4 s", "30 deg", "0.5 m/s", "18 kN/m3", "1 day", "1e-3 Pa s".
/// A unit is a product of named units with SI prefixes, joined by `*`, `.`, a blank or `/` and raised by `m2`, `m^2`,
/// `s-1` or `m²`; it is read from left to right (`kg/m s` is kg s/m), parentheses group.
#include <string>
#include <string_view>

#include "base/units.h"

namespace talus {

/// A number and, where it was given one, its unit.
struct Quantity {
  double number = 0;      ///< as written
  bool plain = true;      ///< no unit was written: the number is in the unit of its key
  double si = 1;          ///< value in SI = number * si
  Dimension dimension{};  ///< of the unit that was written
};

/// Does the text start with a number that is its whole or that a unit follows? If not, it may be an expression ("2 *
/// t").
bool looks_like_quantity(std::string_view text);

/// Reads a quantity. Throws std::invalid_argument when the text is no finite number with a known unit.
Quantity parse_quantity(std::string_view text);

/// The number that `text` states, in the unit of its key. Throws std::invalid_argument as `parse_quantity` does, and
/// when the dimensions differ; two quantities that are often confused get a hint ("m/s is a hydraulic_conductivity").
double in_unit(std::string_view text, const Unit &unit);

/// A number in the shortest form that reads back the same: 0.3, 1e-5, 30.
std::string shortest(double value);

}  // namespace talus
