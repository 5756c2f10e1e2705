#pragma once
/// Bodies that elements of first order cannot resolve.
#include <vector>

#include "meshes/background_mesh.h"

namespace talus {

/// Which bodies have no node inside, that is, one that only cells of this body touch, and no face without soil beyond
/// it: they are one element across, and each of their elements bends as a whole. `body_of`: of the mesh's cells, -1 of
/// those without soil. Bodies without cells are not thin. Collective.
template <int dim>
std::vector<char> find_thin_bodies(const BackgroundMesh<dim> &mesh, const std::vector<int> &body_of,
                                   std::size_t bodies);

}  // namespace talus
