#pragma once
/// Tetrahedra without height on the surface of a mesh.
#include <cstddef>
#include <functional>
#include <vector>

#include "base/vec.h"

namespace talus {

/// Simplices, numbers of nodes one after the other, of one surface or volume.
using NodeList = std::vector<std::size_t>;

/// Takes out tetrahedra that lie flat on a surface: two of their facets are in it, and the other two, which are nearly
/// in the same plane, take their place. Gmsh leaves a few of these where a volume meets a surface that it may not
/// change, beside the ends of terrain with a quality of 0.001, and soil that comes into them takes steps as short.
/// `place` gives the places of nodes [m], `volumes` the cells of each volume, `surfaces` the facets of each surface.
/// Surfaces between two volumes stay as they are. Returns how many cells were taken out.
int drop_flat_cells(const std::function<Vec<3>(std::size_t)> &place, std::vector<NodeList> &volumes,
                    std::vector<NodeList> &surfaces);

}  // namespace talus
