#include <petscpartitioner.h>
#include <petscviewer.h>

#include <algorithm>
#include <numeric>

#include "meshes/plex.h"

namespace talus {
namespace {

using Options = Owned<PetscOptions, PetscOptionsDestroy>;
using Viewer = Owned<PetscViewer, PetscViewerDestroy>;

/// Labels named by physical groups from PETSc's numbered ones. (PETSc's own named labels take the entity of an element
/// of format 2 for a second group.)
PetscErrorCode name_groups(DM plex, const std::vector<PhysicalName> &groups) {
  PetscInt dimension;
  PetscFunctionBeginUser;
  PetscCall(DMGetDimension(plex, &dimension));
  for (const PhysicalName &group : groups) {
    IS stratum;
    const PetscInt *point;
    PetscInt size;
    if (group.dimension != dimension && group.dimension != dimension - 1) continue;
    const char *numbered = group.dimension == dimension ? "Cell Sets" : "Face Sets";
    PetscCall(DMGetStratumIS(plex, numbered, group.tag, &stratum));
    if (!stratum) continue;
    PetscCall(ISGetLocalSize(stratum, &size));
    PetscCall(ISGetIndices(stratum, &point));
    for (PetscInt i = 0; i < size; ++i) PetscCall(DMSetLabelValue(plex, group.name.c_str(), point[i], 1));
    PetscCall(ISRestoreIndices(stratum, &point));
    PetscCall(ISDestroy(&stratum));
  }
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode open_gmsh(MPI_Comm comm, const GmshFile &file, bool interpolate, DM *plex) {
  Options options;
  Viewer viewer;
  PetscFunctionBeginUser;
  PetscCall(PetscOptionsCreate(options.create()));
  // in format 2 the further tags of an element are the numbers of its entity and partitions, not of groups
  PetscCall(PetscOptionsSetValue(options, "-dm_plex_gmsh_multiple_tags", file.entities ? "true" : "false"));
  PetscCall(PetscOptionsSetValue(options, "-dm_plex_gmsh_highorder", "false"));
  PetscCall(PetscOptionsSetValue(options, "-dm_plex_gmsh_periodic", "false"));
  PetscCall(PetscViewerCreate(comm, viewer.create()));
  PetscCall(PetscViewerSetType(viewer, file.binary ? PETSCVIEWERBINARY : PETSCVIEWERASCII));
  PetscCall(PetscViewerFileSetMode(viewer, FILE_MODE_READ));
  PetscCall(PetscObjectSetOptions((PetscObject)(PetscViewer)viewer, options));
  if (file.binary) PetscCall(PetscViewerBinarySetSkipInfo(viewer, PETSC_TRUE));
  PetscCall(PetscViewerFileSetName(viewer, file.name.c_str()));
  PetscCall(DMPlexCreateGmsh(comm, viewer, interpolate ? PETSC_TRUE : PETSC_FALSE, plex));
  PetscCall(PetscObjectSetOptions((PetscObject)(PetscViewer)viewer, nullptr));
  if (interpolate) PetscCall(name_groups(*plex, file.groups));
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
