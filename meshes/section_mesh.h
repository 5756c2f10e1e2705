#pragma once
/// From a section to a Gmsh mesh with named groups. Part of talus-mesh: Gmsh is GPL, and no library of Talus links it.
#include <string>

#include "meshes/section.h"

namespace talus {

struct MeshOptions {
  double size = 0;           ///< of cells [m]
  int dimension = 2;         ///< 2: triangles, 3: tetrahedra
  double thickness = 0;      ///< of a 3D body [m]; 0: one cell size
  int layers = 1;            ///< of elements over the thickness, or over each part of it; 0: free tetrahedra
  std::vector<double> cuts;  ///< z that part the thickness, ascending [m]; groups of cells then end in _1, _2, ...
  std::vector<RefinedBox> boxes;
};

/// Builds the section's mesh as Gmsh's current model, between gmsh::initialize and gmsh::finalize: the domain
/// fragmented by interfaces and boundaries (OpenCASCADE), meshed, extruded. Groups: layerN, air or the names of seeds
/// for cells; base (the lowest edges where horizontal), left, right, surface, front and back (z = 0, z = thickness),
/// and the section's own names for facets. Between cuts
/// the groups of cells are numbered along z: layer1_1, layer1_2. A facet is in one group, first in that of a name. The
/// mesh is the same every time. Throws std::invalid_argument where the section cannot be met: seeds that contradict
/// each other, a boundary that gets no facets.
void mesh_section(const Section &section, const MeshOptions &options);

}  // namespace talus
