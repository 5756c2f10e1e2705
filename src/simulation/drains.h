#pragma once
/// Boundaries of the water on faces inside the soil, and on faces that have none.
#include "simulation/world.h"

namespace talus {

/// Refuses what boundaries of the water cannot do inside the soil. Collective.
template <int dim>
void check_drains(const BackgroundMesh<dim> &mesh, const Scene &scene);

/// A sentence for each boundary of the water that touches no soil at the start. Collective.
template <int dim>
std::vector<std::string> water_without_soil(const World<dim> &world);

}  // namespace talus
