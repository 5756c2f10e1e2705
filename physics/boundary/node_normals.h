#pragma once
/// Normals of boundaries at nodes, the same on all ranks. The facets of a boundary at a node form patches, which end at
/// true edges only, and each patch has one normal, docs/theory section 6.
#include <vector>

#include "meshes/background_mesh.h"

namespace talus {

/// One patch of a boundary at one of its nodes.
template <int dim>
struct NodeNormal {
  int source, node;  ///< boundary, mesh node
  Vec<dim> normal;   ///< unit normal pointing out of the mesh
  double area;       ///< the node's share of the facets of the patch [m2]
};

/// The local facets of a boundary.
template <int dim>
struct SourceFacets {
  int source;
  std::vector<Facet<dim>> facets;
};

/// Finds the patches of all boundaries at the nodes of this rank. A node has one entry for each of its patches, and the
/// entries are in an order that does not depend on the partition at any node. Collective.
template <int dim>
PetscErrorCode find_node_normals(const BackgroundMesh<dim> &mesh, const std::vector<SourceFacets<dim>> &sources,
                                 std::vector<NodeNormal<dim>> &normals);

}  // namespace talus
