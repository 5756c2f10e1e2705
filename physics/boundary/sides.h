#pragma once
/// Sides at which ground goes on: which of their nodes move alike, and which column of free ground stands beside them,
/// docs/theory/earthquakes.md section 8.
#include <string>
#include <vector>

#include "meshes/background_mesh.h"
#include "physics/boundary/boundary.h"

namespace talus {

/// Groups of nodes that move alike, global numbers, on all ranks: those of opposite sides that are tied, and those of
/// both faces of columns. A fault names the boundary that cannot do what it says, and why. Collective.
struct Ties {
  std::vector<std::vector<long long>> groups;
  int source = -1;
  std::string fault;
};
template <int dim>
Ties find_ties(const BackgroundMesh<dim> &mesh, const std::vector<NamedBoundary> &sources);

/// A side with the column beside it.
template <int dim>
struct SideColumn {
  int source;
  std::vector<Facet<dim>> facets;  ///< of the column, towards the side
  LinkedNodes links;               ///< of each node of the side with that of the column
  std::vector<int> beside, nodes;  ///< local nodes of the side, and of the column
};
/// Of all sides, where the mesh has no fault. Collective.
template <int dim>
std::vector<SideColumn<dim>> find_columns(const BackgroundMesh<dim> &mesh, const std::vector<NamedBoundary> &sources);

}  // namespace talus
