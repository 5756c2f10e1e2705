#include <petscpartitioner.h>
#include <petscviewer.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "meshes/plex.h"

namespace talus {
namespace {

using Options = Owned<PetscOptions, PetscOptionsDestroy>;
using Viewer = Owned<PetscViewer, PetscViewerDestroy>;
using Partitioner = Owned<PetscPartitioner, PetscPartitionerDestroy>;
using Section = Owned<PetscSection, PetscSectionDestroy>;
using IndexSet = Owned<IS, ISDestroy>;

/// Patches that share a face, in compressed rows.
struct Graph {
  std::vector<PetscInt> first, neighbour;
};

template <int dim>
Graph graph_of_patches(const Simplices<dim> &cells, const std::vector<int> &patch, int patch_count) {
  std::vector<std::set<PetscInt>> touching(patch_count);
  for (std::size_t c = 0; c < patch.size(); ++c)
    for (int j : cells.neighbour[c])
      if (j >= 0 && patch[j] != patch[c]) touching[patch[c]].insert(patch[j]);
  Graph graph;
  graph.first.push_back(0);
  for (const auto &others : touching) {
    graph.neighbour.insert(graph.neighbour.end(), others.begin(), others.end());
    graph.first.push_back(static_cast<PetscInt>(graph.neighbour.size()));
  }
  return graph;
}

PetscErrorCode weights_as_section(const std::vector<double> &weight, PetscSection *section) {
  PetscFunctionBeginUser;
  PetscCall(PetscSectionCreate(PETSC_COMM_SELF, section));
  PetscCall(PetscSectionSetChart(*section, 0, static_cast<PetscInt>(weight.size())));
  for (std::size_t p = 0; p < weight.size(); ++p)
    PetscCall(PetscSectionSetDof(*section, static_cast<PetscInt>(p), std::max<PetscInt>(1, std::lround(weight[p]))));
  PetscCall(PetscSectionSetUp(*section));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode open_gmsh(MPI_Comm comm, const std::string &file, bool binary, bool interpolate, DM *plex) {
  Options options;
  Viewer viewer;
  PetscFunctionBeginUser;
  PetscCall(PetscOptionsCreate(options.create()));
  PetscCall(PetscOptionsSetValue(options, "-dm_plex_gmsh_use_regions", "true"));
  PetscCall(PetscOptionsSetValue(options, "-dm_plex_gmsh_multiple_tags", "true"));
  PetscCall(PetscOptionsSetValue(options, "-dm_plex_gmsh_highorder", "false"));
  PetscCall(PetscOptionsSetValue(options, "-dm_plex_gmsh_periodic", "false"));
  PetscCall(PetscViewerCreate(comm, viewer.create()));
  PetscCall(PetscViewerSetType(viewer, binary ? PETSCVIEWERBINARY : PETSCVIEWERASCII));
  PetscCall(PetscViewerFileSetMode(viewer, FILE_MODE_READ));
  PetscCall(PetscObjectSetOptions((PetscObject)(PetscViewer)viewer, options));
  if (binary) PetscCall(PetscViewerBinarySetSkipInfo(viewer, PETSC_TRUE));
  PetscCall(PetscViewerFileSetName(viewer, file.c_str()));
  PetscCall(DMPlexCreateGmsh(comm, viewer, interpolate ? PETSC_TRUE : PETSC_FALSE, plex));
  PetscCall(PetscObjectSetOptions((PetscObject)(PetscViewer)viewer, nullptr));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode partition_patches(const Simplices<dim> &cells, const std::vector<int> &patch,
                                 const std::vector<double> &weight, int ranks, std::vector<int> &rank_of_patch) {
  Partitioner partitioner;
  Section weights, sizes;
  IndexSet order;
  const PetscInt *index;
  PetscFunctionBeginUser;
  const int count = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
  std::vector<double> patch_weight(count, 0);
  for (std::size_t c = 0; c < patch.size(); ++c) patch_weight[patch[c]] += weight[c];
  Graph graph = graph_of_patches<dim>(cells, patch, count);
  PetscCall(weights_as_section(patch_weight, weights.create()));
  PetscCall(PetscSectionCreate(PETSC_COMM_SELF, sizes.create()));
  PetscCall(PetscPartitionerCreate(PETSC_COMM_SELF, partitioner.create()));
#if defined(PETSC_HAVE_PTSCOTCH)
  PetscCall(PetscPartitionerSetType(partitioner, PETSCPARTITIONERPTSCOTCH));
#elif defined(PETSC_HAVE_PARMETIS)
  PetscCall(PetscPartitionerSetType(partitioner, PETSCPARTITIONERPARMETIS));
#else
  PetscCall(PetscPartitionerSetType(partitioner, PETSCPARTITIONERSIMPLE));
#endif
  PetscCall(PetscPartitionerPartition(partitioner, ranks, count, graph.first.data(), graph.neighbour.data(), weights,
                                      nullptr, sizes, order.create()));
  rank_of_patch.assign(count, 0);
  PetscCall(ISGetIndices(order, &index));
  for (int r = 0; r < ranks; ++r) {
    PetscInt size, first;
    PetscCall(PetscSectionGetDof(sizes, r, &size));
    PetscCall(PetscSectionGetOffset(sizes, r, &first));
    for (PetscInt i = first; i < first + size; ++i) rank_of_patch[index[i]] = r;
  }
  PetscCall(ISRestoreIndices(order, &index));
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

template PetscErrorCode partition_patches(const Simplices<2> &, const std::vector<int> &, const std::vector<double> &,
                                          int, std::vector<int> &);
template PetscErrorCode partition_patches(const Simplices<3> &, const std::vector<int> &, const std::vector<double> &,
                                          int, std::vector<int> &);

}  // namespace talus
