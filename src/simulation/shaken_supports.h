#pragma once
/// What the boundaries of a scene do to soil in an earthquake.
#include "simulation/world.h"

namespace talus {

/// Complains of boundaries that contradict the motion of the ground: where the base moves something has to take the
/// soil along, and where a wave comes in nothing may hold it; beside dashpots the soil has to be in equilibrium.
/// Collective.
template <int dim>
void check_shaken_supports(const World<dim> &world, const std::vector<NamedBoundary> &sources);

}  // namespace talus
