#pragma once
/// Smaller cells in the part of a rank: the edges of all cells are halved, a triangle becomes 4 cells and a tetrahedron
/// 8. Of the tetrahedron four are its corners; the octahedron between them is divided along the shortest of its
/// diagonals. Source: Bey (1995), "Tetrahedral grid refinement", Computing 55.
#include "meshes/mesh_part.h"

namespace talus {

/// Cells, numbers and groups do not depend on the partition; nor does `patch`, the patch that held the larger cell.
/// Neighbours exchange the edges that they have in common. Collective.
template <int dim>
MeshPart<dim> refine(MPI_Comm comm, const MeshPart<dim> &coarse);

}  // namespace talus
