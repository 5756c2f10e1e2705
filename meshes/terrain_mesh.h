#pragma once
/// From terrain to a Gmsh mesh of tetrahedra with named groups. Part of talus-mesh: Gmsh is GPL, and no library of
/// Talus links it.
#include "meshes/terrain.h"

namespace talus {

/// Builds the mesh as Gmsh's current model, between gmsh::initialize and gmsh::finalize. With a flat base: soil from
/// the base to the ground, and air above it where asked for. Without: the space between the bed and the air's upper
/// end. Surfaces follow the grid as nearly as the cell sizes allow; sides are vertical. What a cell of soil is made of
/// is decided by its centre.
///
/// Groups of cells: slide (above the slip surface and below the ground), ground (below it, on a flat base), air. Groups
/// of facets: base (the flat base, or the bed), terrain (the ground, where a flat base lies below it), top (of the
/// air), west, east, south, north, and void, where cells are left out because the terrain has no data. The mesh is the
/// same every time.
void mesh_terrain(const Terrain &terrain);

}  // namespace talus
