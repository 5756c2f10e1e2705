#pragma once
/// Columns of cells beside plane sides of a mesh, in which free ground is computed: docs/theory/earthquakes.md,
/// section 8.
#include <string>

#include "meshes/gmsh_file.h"

namespace talus {

/// Name of the group of the two faces of the column along a side.
inline std::string column_of(const std::string &side) { return side + " column"; }

/// Adds a column beside the group `side`, one cell thick and as far away: its nodes are those of the side, moved along
/// the outward normal. A cell belongs to the regions of the cell behind the side, and where a facet of a group meets
/// the side, the column has one of this group too: base and surface go on. The faces of the column along the side
/// become a group of their own. Where another side with a column meets this one the column of that one ends here, and
/// so there is a column at the corner. A mesh without the group stays as it is. Serial. Returns a complaint, or
/// nothing.
template <int dim>
std::string add_column_beside(GmshMesh &mesh, const std::string &side);

}  // namespace talus
