#pragma once
/// What Talus asks of DMPlex: the mesh of a host program, and the mesh on which finite elements number their nodes.
#include <petscdmplex.h>

#include <string>
#include <vector>

#include "base/owned.h"
#include "meshes/mesh_part.h"

namespace talus {

struct GmshMesh;

/// DMPlex's own labels name no groups.
bool is_reserved_label(const std::string &name);

/// Points of a host's DMPlex.
struct HostPoints {
  std::vector<PetscInt> vertex;   ///< of the nodes of its part
  std::vector<long long> number;  ///< of points; no two points of all ranks have the same
};
/// The part of this rank in a host's DMPlex, without patches. Labels on cells name regions, labels on facets groups.
/// Collective.
template <int dim>
PetscErrorCode part_of_plex(DM plex, MeshPart<dim> &part, HostPoints &points);

/// Some cells of a mesh with their nodes, in the order of its file.
struct TakenCells {
  long long all_cells = 0, all_nodes = 0;  ///< of the mesh
  std::vector<PetscInt> corner;            ///< `dimension` + 1 of each cell: places in `node`
  std::vector<int> node;                   ///< of the mesh
  std::vector<double> position;            ///< of these nodes, `dimension` numbers each [m]
};
/// The cells that `take` marks.
TakenCells take_cells(int dimension, const GmshMesh &mesh, const std::vector<char> &take);

/// The cells of rank 0 as an interpolated DMPlex, each on `rank_of_cell`; elsewhere both are empty. `number` are those
/// of the points: of a vertex that of its node (MeshPart::node_number), of all others higher ones. Collective.
PetscErrorCode make_plex(MPI_Comm comm, int dimension, const TakenCells &taken, const std::vector<int> &rank_of_cell,
                         Dm &plex, std::vector<long long> &number);

}  // namespace talus
