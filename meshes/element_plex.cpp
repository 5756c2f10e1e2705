#include <petscpartitioner.h>
#include <petscsf.h>

#include <algorithm>
#include <numeric>

#include "meshes/gmsh_file.h"
#include "meshes/plex.h"

namespace talus {
namespace {

using StarForest = Owned<PetscSF, PetscSFDestroy>;

/// Sends each cell of rank 0 to its rank. `migration` leads from points there to local points. On one rank nothing
/// moves: `distributed` and `migration` stay null.
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

}  // namespace

TakenCells take_cells(int dimension, const GmshMesh &mesh, const std::vector<char> &take) {
  TakenCells taken;
  const std::size_t corners = dimension + 1;
  taken.all_cells = static_cast<long long>(take.size());
  taken.all_nodes = static_cast<long long>(mesh.position.size()) / dimension;
  std::vector<int> number(taken.all_nodes, -1);
  for (std::size_t c = 0; c < take.size(); ++c)
    for (std::size_t k = 0; k < corners && take[c]; ++k) number[mesh.cells[c * corners + k]] = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<int>(taken.node.size());
    taken.node.push_back(static_cast<int>(i));
    const double *x = &mesh.position[i * dimension];
    taken.position.insert(taken.position.end(), x, x + dimension);
  }
  for (std::size_t c = 0; c < take.size(); ++c) {
    if (!take[c]) continue;
    for (std::size_t k = 0; k < corners; ++k) taken.corner.push_back(number[mesh.cells[c * corners + k]]);
    // DMPlex stores tetrahedra with their sides turned outward
    if (dimension == 3) std::swap(taken.corner[taken.corner.size() - 4], taken.corner[taken.corner.size() - 3]);
  }
  return taken;
}

PetscErrorCode make_plex(MPI_Comm comm, int dimension, const TakenCells &taken, const std::vector<int> &rank_of_cell,
                         Dm &plex, std::vector<long long> &number) {
  PetscInt begin, end, first_vertex, end_vertex;
  PetscFunctionBeginUser;
  PetscCall(DMPlexCreateFromCellListPetsc(comm, dimension, static_cast<PetscInt>(rank_of_cell.size()),
                                          static_cast<PetscInt>(taken.node.size()), dimension + 1, PETSC_TRUE,
                                          taken.corner.data(), dimension, taken.position.data(), plex.create()));
  PetscCall(DMPlexGetChart(plex, &begin, &end));
  PetscCall(DMPlexGetDepthStratum(plex, 0, &first_vertex, &end_vertex));
  std::vector<long long> whole(end);
  for (PetscInt p = begin; p < end; ++p)
    whole[p] =
        taken.all_cells + (first_vertex <= p && p < end_vertex ? taken.node[p - first_vertex] : taken.all_nodes + p);
  Dm distributed;
  StarForest migration;
  PetscCall(distribute(plex, rank_of_cell, distributed.create(), migration.create()));
  if (!distributed) {
    number = std::move(whole);
    PetscFunctionReturn(0);
  }
  std::swap(plex, distributed);
  PetscCall(DMPlexGetChart(plex, &begin, &end));
  number.assign(end, -1);
  PetscCall(PetscSFBcastBegin(migration, MPI_LONG_LONG, whole.data(), number.data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(migration, MPI_LONG_LONG, whole.data(), number.data(), MPI_REPLACE));
  PetscFunctionReturn(0);
}

}  // namespace talus
