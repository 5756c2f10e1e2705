#include <petscpartitioner.h>

#include <algorithm>
#include <numeric>

#include "meshes/gmsh_file.h"
#include "meshes/plex.h"

namespace talus {
namespace {

/// The facet with these nodes, or -1.
PetscErrorCode facet_of_nodes(DM plex, int nodes, const PetscInt *node, PetscInt *facet) {
  PetscInt count, first, end;
  const PetscInt *join;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetFullJoin(plex, nodes, node, &count, &join));
  PetscCall(DMPlexGetHeightStratum(plex, 1, &first, &end));
  *facet = count == 1 && first <= join[0] && join[0] < end ? join[0] : -1;
  PetscCall(DMPlexRestoreJoin(plex, nodes, node, &count, &join));
  PetscFunctionReturn(0);
}

/// Labels with the names of the groups of cells and facets.
PetscErrorCode name_groups(DM plex, const GmshMesh &mesh, std::string &complaint) {
  const int nodes = mesh.dimension;
  PetscInt first, end;
  PetscFunctionBeginUser;
  for (const auto &[name, cells] : mesh.regions)
    for (int cell : cells) PetscCall(DMSetLabelValue(plex, name.c_str(), cell, 1));
  PetscCall(DMPlexGetDepthStratum(plex, 0, &first, &end));
  for (const auto &[name, facets] : mesh.groups)
    for (int f : facets) {
      std::array<PetscInt, 3> node;
      PetscInt point;
      bool of_cells = true;
      for (int k = 0; k < nodes; ++k) {
        of_cells &= mesh.facets[nodes * f + k] >= 0;
        node[k] = first + mesh.facets[nodes * f + k];
      }
      if (of_cells) PetscCall(facet_of_nodes(plex, nodes, node.data(), &point));
      if (!of_cells || point < 0) {
        complaint = "element " + std::to_string(mesh.facet_number[f]) + " of the group '" + name +
                    "' is not the side of a cell; remesh, so that cells end at the group";
        PetscFunctionReturn(0);
      }
      PetscCall(DMSetLabelValue(plex, name.c_str(), point, 1));
    }
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode make_plex(MPI_Comm comm, int dimension, const GmshMesh &mesh, DM *plex, std::string &complaint) {
  PetscFunctionBeginUser;
  const int corners = dimension + 1;
  std::vector<PetscInt> cells(mesh.cells.begin(), mesh.cells.end());
  // DMPlex stores tetrahedra with their sides turned outward
  for (std::size_t c = 0; dimension == 3 && c < cells.size(); c += 4) std::swap(cells[c], cells[c + 1]);
  PetscCall(DMPlexCreateFromCellListPetsc(comm, dimension, static_cast<PetscInt>(cells.size() / corners),
                                          static_cast<PetscInt>(mesh.position.size() / dimension), corners, PETSC_TRUE,
                                          cells.data(), dimension, mesh.position.data(), plex));
  PetscCall(name_groups(*plex, mesh, complaint));
  PetscFunctionReturn(0);
}

PetscErrorCode distribute(DM plex, const std::vector<int> &rank_of_cell, DM *distributed, PetscSF *migration) {
  PetscPartitioner partitioner;
  const MPI_Comm comm = PetscObjectComm((PetscObject)plex);
  int ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  std::vector<PetscInt> sizes(ranks, 0), cells(rank_of_cell.size());
  for (int r : rank_of_cell) ++sizes[r];
  std::iota(cells.begin(), cells.end(), 0);
  std::stable_sort(cells.begin(), cells.end(),
                   [&](PetscInt a, PetscInt b) { return rank_of_cell[a] < rank_of_cell[b]; });
  PetscCall(DMPlexGetPartitioner(plex, &partitioner));
  PetscCall(PetscPartitionerSetType(partitioner, PETSCPARTITIONERSHELL));
  PetscCall(PetscPartitionerShellSetPartition(partitioner, ranks, sizes.data(), cells.data()));
  PetscCall(DMPlexDistribute(plex, 0, migration, distributed));
  PetscFunctionReturn(0);
}

}  // namespace talus
