#pragma once
/// The free surface of the soil as finite elements have it.
#include <vector>

#include "physics/boundary/conditions.h"

namespace talus {

/// Faces of active cells without soil across that no boundary which decides on the water names: what acts on
/// `free_surface`, or else the atmosphere, is beyond them. Without the numbers of their nodes. Collective.
template <int dim>
std::vector<Facet<dim>> unnamed_faces(const BackgroundMesh<dim> &mesh, const std::vector<char> &active,
                                      const std::vector<NamedBoundary> &sources);

}  // namespace talus
