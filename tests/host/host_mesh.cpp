#include "host_mesh.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

constexpr int columns = 10, rows = 30;
constexpr double size = 0.1;  // of a square of two triangles [m]

const char *region_at(double y) { return y < 1 ? "soil" : y > 2 && y < 2.6 ? "block" : "air"; }

const char *group_at(double x, double y) {
  const double near = 1e-6 * size;
  if (std::abs(y) < near) return "base";
  if (std::abs(x) < near) return "left";
  if (std::abs(x - columns * size) < near) return "right";
  return nullptr;
}

PetscErrorCode set_labels(DM plex) {
  PetscInt first, end;
  PetscReal volume, centre[3], normal[3];
  PetscFunctionBeginUser;
  for (const char *name : {"soil", "block", "air", "base", "left", "right"}) PetscCall(DMCreateLabel(plex, name));
  PetscCall(DMPlexGetHeightStratum(plex, 0, &first, &end));
  for (PetscInt cell = first; cell < end; ++cell) {
    PetscCall(DMPlexComputeCellGeometryFVM(plex, cell, &volume, centre, normal));
    PetscCall(DMSetLabelValue(plex, region_at(centre[1]), cell, 1));
  }
  PetscCall(DMPlexGetHeightStratum(plex, 1, &first, &end));
  for (PetscInt facet = first; facet < end; ++facet) {
    PetscCall(DMPlexComputeCellGeometryFVM(plex, facet, &volume, centre, normal));
    if (const char *group = group_at(centre[0], centre[1])) PetscCall(DMSetLabelValue(plex, group, facet, 1));
  }
  PetscFunctionReturn(0);
}

/// Slanted stripes, one for each rank: they cut both bodies, and the block falls from stripe to stripe.
PetscErrorCode choose_stripes(DM plex, int ranks) {
  PetscInt first, end;
  PetscReal volume, centre[3], normal[3];
  PetscPartitioner partitioner;
  PetscFunctionBeginUser;
  PetscCall(DMPlexGetHeightStratum(plex, 0, &first, &end));
  std::vector<std::vector<PetscInt>> stripe(ranks);
  for (PetscInt cell = first; cell < end; ++cell) {
    PetscCall(DMPlexComputeCellGeometryFVM(plex, cell, &volume, centre, normal));
    const double across = centre[0] / (columns * size) - 0.2 * (centre[1] - rows * size / 2);
    stripe[std::clamp(static_cast<int>(across * ranks), 0, ranks - 1)].push_back(cell);
  }
  std::vector<PetscInt> sizes, cells;
  for (const auto &one : stripe) {
    sizes.push_back(static_cast<PetscInt>(one.size()));
    cells.insert(cells.end(), one.begin(), one.end());
  }
  PetscCall(DMPlexGetPartitioner(plex, &partitioner));
  PetscCall(PetscPartitionerSetType(partitioner, PETSCPARTITIONERSHELL));
  PetscCall(PetscPartitionerShellSetPartition(partitioner, ranks, sizes.data(), cells.data()));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode make_host_mesh(MPI_Comm comm, DM *plex) {
  int rank, ranks;
  std::vector<PetscInt> corners;
  std::vector<PetscReal> positions;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  if (rank == 0) {
    for (int j = 0; j <= rows; ++j)
      for (int i = 0; i <= columns; ++i) positions.insert(positions.end(), {i * size, j * size});
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const PetscInt a = j * (columns + 1) + i, b = a + 1, c = b + columns + 1, d = c - 1;
        // diagonals alternate, so that no direction is preferred
        if ((i + j) % 2)
          corners.insert(corners.end(), {a, b, d, b, c, d});
        else
          corners.insert(corners.end(), {a, b, c, a, c, d});
      }
  }
  PetscCall(DMPlexCreateFromCellListPetsc(comm, 2, static_cast<PetscInt>(corners.size() / 3),
                                          static_cast<PetscInt>(positions.size() / 2), 3, PETSC_TRUE, corners.data(), 2,
                                          positions.data(), plex));
  PetscCall(set_labels(*plex));
  if (ranks == 1) PetscFunctionReturn(0);
  PetscCall(choose_stripes(*plex, ranks));
  DM distributed = nullptr;
  PetscCall(DMPlexDistribute(*plex, 0, nullptr, &distributed));
  PetscCall(DMDestroy(plex));
  *plex = distributed;
  PetscFunctionReturn(0);
}
