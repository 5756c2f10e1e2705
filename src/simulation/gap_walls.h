#pragma once
/// Cracks and trenches that are drawn as a gap in the soil: what fills one presses on both of its walls.
#include "simulation/world.h"

namespace talus {

/// Complains where the pressure of a `traction` acts on one wall of a gap that is narrower than half of what the
/// boundary measures, and nothing holds or loads the wall opposite. Collective.
template <int dim>
void check_gap_walls(const World<dim> &world);

}  // namespace talus
