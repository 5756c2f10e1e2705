#pragma once
/// Values that engineers use, and how sentences say them.
#include <string>

#include "base/units.h"

namespace talus {

/// Elastic constants, of which a soil has two: soft clay to intact rock.
namespace elastic {
inline constexpr Range stiffness{1e-6, 1e15, {1e5, 1e11}}, poisson_ratio{-1, 0.5, {0, 0.495}};
}  // namespace elastic

/// Is there a range, so that a value may lie outside?
bool has_usual(const Usual &usual);
/// Does a number in the unit of its key lie inside? To round-off, which a unit in the scene may add.
bool is_usual(double number, const Usual &usual);
/// "0 to 0.1", "5 to 50, or 0"
std::string text_of(const Usual &usual, Unit unit);
/// The first unit in which a number that is not usual would be; empty if it would be in none. The number may have been
/// meant in it.
std::string unit_meant(double number, Unit unit, const Usual &usual);
/// " kg/m3", empty for a plain number.
std::string in(Unit unit);

}  // namespace talus
