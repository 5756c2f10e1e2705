#pragma once
/// Internal variables of a law at a point: a few doubles, each with a name, a unit and a meaning.
#include <array>

#include "base/units.h"

namespace talus {

struct HistoryField {
  const char *name;
  Unit unit;
  const char *meaning;
  bool kept = false;  ///< part of the state: stays where a stage resets plastic strain or does not accumulate it
};

/// History of the frictional laws. Softening reads the first; the volume cap of dilatant soil reads the second.
inline constexpr std::array<HistoryField, 2> plastic_strains{{
    {"plastic_strain", one, "accumulated deviatoric plastic strain, the sum of sqrt(2/3 de_p : de_p)"},
    {"plastic_volume", one, "plastic volumetric strain, positive in expansion"},
}};

}  // namespace talus
