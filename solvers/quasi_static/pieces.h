#pragma once
/// Pieces of soil: elements that nodes join.
#include <functional>
#include <map>

#include "solvers/quasi_static/element_nodes.h"

namespace talus {

/// Calls visit(nodes, their number) for each element of some soil.
using EachElement = std::function<PetscErrorCode(const std::function<PetscErrorCode(const int *, int)> &visit)>;

/// Gives all nodes of a piece the largest label that one of them has; nodes outside of the elements keep theirs.
/// Collective.
template <int dim>
PetscErrorCode spread_labels(const ElementNodes<dim> &nodes, const EachElement &each, std::vector<PetscInt> &label) {
  PetscFunctionBeginUser;
  for (int changed = 1; changed;) {
    changed = 0;
    for (bool again = true; again;) {
      again = false;
      PetscCall(each([&](const int *node, int count) -> PetscErrorCode {
        PetscInt largest = -1;
        for (int k = 0; k < count; ++k) largest = std::max(largest, label[node[k]]);
        for (int k = 0; k < count; ++k)
          if (label[node[k]] < largest) label[node[k]] = largest, again = true, changed = 1;
        return 0;
      }));
    }
    PetscCall(nodes.maximum(label));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, nodes.comm()));
  }
  PetscFunctionReturn(0);
}

/// The different labels of all ranks, each with its place in ascending order. Collective.
inline PetscErrorCode number_labels(MPI_Comm comm, std::vector<PetscInt> mine, std::map<PetscInt, size_t> *number) {
  int ranks, count = static_cast<int>(mine.size());
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  PetscCallMPI(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm));
  for (int r = 0; r < ranks; ++r) starts[r + 1] = starts[r] + counts[r];
  std::vector<PetscInt> all(starts[ranks]);
  PetscCallMPI(MPI_Allgatherv(mine.data(), count, MPIU_INT, all.data(), counts.data(), starts.data(), MPIU_INT, comm));
  number->clear();
  for (PetscInt label : all) number->emplace(label, 0);
  size_t next = 0;
  for (auto &[label, place] : *number) place = next++;
  PetscFunctionReturn(0);
}

}  // namespace talus
