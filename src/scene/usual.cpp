#include "scene/usual.h"

#include <cmath>

#include "scene/quantity.h"

namespace talus {

bool has_usual(const Usual &usual) { return std::isfinite(usual.low) || std::isfinite(usual.high); }

bool is_usual(double number, const Usual &usual) {
  const double round_off = 1e-9 * std::abs(number);
  return (usual.low <= number + round_off && number - round_off <= usual.high) || (usual.or_zero && number == 0);
}

std::string text_of(const Usual &usual, Unit unit) {
  return shortest(usual.low) + " to " + shortest(usual.high) + in(unit) + (usual.or_zero ? ", or 0" : "");
}

std::string unit_meant(double number, Unit unit, const Usual &usual) {
  for (const char *name :
       {"kPa",   "MPa",   "GPa",   "t/m3", "g/cm3", "kN/m3", "mm/s", "cm/s", "mm/h", "m/h", "mm/day", "m/day",
        "cm/s2", "mm/s2", "ft/s2", "rad",  "mm",    "cm",    "km",   "ft",   "min",  "h",   "day"}) {
    const Quantity meant = parse_quantity(std::string("1 ") + name);
    const double as_meant = number * meant.si / unit.si;
    if (meant.dimension == unit.dimension && as_meant != 0 && is_usual(as_meant, usual)) return name;
  }
  return "";
}

std::string in(Unit unit) { return unit.dimension == Dimension{} ? "" : std::string(" ") + unit.name; }

}  // namespace talus
