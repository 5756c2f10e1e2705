#pragma once
/// Facets of boundaries listed by their nodes, the same on all ranks.
#include <algorithm>
#include <map>
#include <vector>

#include "meshes/background_mesh.h"

namespace talus {

/// One facet of a boundary at one of its nodes.
template <int dim>
struct NodeNormal {
  int source, node;  ///< boundary, mesh node
  Vec<dim> position, normal;
  double area;  ///< the node's share [m2]
};

/// Adds the facets of other ranks at nodes that this rank shares with them: facets of a shared node may lie on one rank
/// only. Every rank sends its own, and receivers find the node by its exact position. Collective.
template <int dim>
PetscErrorCode complete_normals(const BackgroundMesh<dim> &mesh, std::vector<NodeNormal<dim>> &normals) {
  PetscFunctionBeginUser;
  int ranks, rank;
  PetscCallMPI(MPI_Comm_size(mesh.comm(), &ranks));
  PetscCallMPI(MPI_Comm_rank(mesh.comm(), &rank));
  if (ranks == 1) PetscFunctionReturn(0);
  constexpr int width = 2 + 2 * dim;
  std::map<Vec<dim>, int> shared;
  for (int node : mesh.halo.shared_nodes()) shared[mesh.position[node]] = node;
  std::vector<double> mine, all;
  for (const NodeNormal<dim> &n : normals)
    if (shared.count(n.position)) {
      mine.push_back(n.source), mine.push_back(n.area);
      mine.insert(mine.end(), n.position.begin(), n.position.end());
      mine.insert(mine.end(), n.normal.begin(), n.normal.end());
    }
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  const int count = static_cast<int>(mine.size());
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, mesh.comm()));
  for (int r = 0; r < ranks; ++r) starts[r + 1] = starts[r] + counts[r];
  all.resize(starts[ranks]);
  PetscCallMPI(MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE,
                              mesh.comm()));
  for (int r = 0; r < ranks; ++r)
    for (int i = starts[r]; r != rank && i < starts[r + 1]; i += width) {
      NodeNormal<dim> n{static_cast<int>(all[i]), -1, {}, {}, all[i + 1]};
      std::copy_n(&all[i + 2], dim, n.position.begin());
      std::copy_n(&all[i + 2 + dim], dim, n.normal.begin());
      const auto found = shared.find(n.position);
      if (found != shared.end()) n.node = found->second, normals.push_back(n);
    }
  PetscFunctionReturn(0);
}

}  // namespace talus
