#pragma once
/// Choices of body.NAME.permeability_change.
namespace talus {

/// Of the permeability with porosity.
enum class PermeabilityChange { none, kozeny_carman, grain_share };

}  // namespace talus
