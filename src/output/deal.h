#pragma once
/// Deals the state of a run out to another partition of the mesh: each row of an archive goes to the ranks that have
/// its cell, node or edge now. Resuming on another number of ranks and balancing the load of ranks both do this.
#include <mpi.h>

#include <vector>

#include "base/archive.h"

namespace talus {

/// What a rank has, by global numbers, in the order in which it wants rows.
struct Holdings {
  std::vector<long long> cells;   ///< each on one rank
  std::vector<long long> points;  ///< nodes and edges, which several ranks may have
};

/// The state of this rank. `parts` are some of the ranks that wrote the state, dealt out so that the ranks have them in
/// their order, one after the other; the first rank has at least one of them. Where several of these had a point, the
/// rows of the first count. Throws std::runtime_error, the same on all ranks, where the parts contradict each other or
/// a row belongs to nothing that a rank has. Collective.
Archive deal(MPI_Comm comm, const std::vector<Archive> &parts, const Holdings &mine);

}  // namespace talus
