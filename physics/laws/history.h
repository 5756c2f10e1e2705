#pragma once
/// Internal variables of a law at a point: a few doubles, each with a name, a unit and a meaning.
#include <array>

#include "base/units.h"

namespace talus {

struct HistoryField {
  const char *name;
  Unit unit;
  const char *meaning;
  bool kept = false;       ///< part of the state: stays where a stage resets plastic strain or does not accumulate it
  bool of_tensor = false;  ///< a component that turns with the soil; results do not show it
  bool of_stress = false;  ///< goes with the stress: accumulates in every stage
};

/// What softening reads.
inline constexpr HistoryField field_of_plastic_strain{
    "plastic_strain", one, "accumulated deviatoric plastic strain, the sum of sqrt(2/3 de_p : de_p)"};
/// What raises the volume cap, theory (3.10).
inline constexpr HistoryField field_of_dilation{
    "dilation", one,
    "plastic volumetric strain of soil that shears, positive in expansion; not of soil that opens at the apex or the "
    "tension cut-off",
    true};
/// Of soil whose pore water cannot leave, behind the internal variables of its law.
inline constexpr HistoryField field_of_excess_pressure{
    "excess_pore_pressure",
    pascal,
    "pore pressure beyond that of [water], of soil with drainage = \"undrained\"",
    true,
    false,
    true};
/// History of laws that do not dilate: fluids and mu(I).
inline constexpr std::array shear_history{field_of_plastic_strain};
/// History of the frictional laws.
inline constexpr std::array frictional_history{field_of_plastic_strain, field_of_dilation};

}  // namespace talus
