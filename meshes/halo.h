#pragma once
/// Nodes that several ranks share: sums of nodal records, added in rank order so that all ranks agree to the bit.
#include <petscsys.h>

#include <vector>

namespace talus {

class Halo {
 public:
  /// `shared[r]` lists local nodes shared with rank neighbour[r], in an order both ranks agree on (global number).
  Halo() = default;
  Halo(MPI_Comm comm, std::vector<int> neighbour_ranks, std::vector<std::vector<int>> shared);

  bool empty() const { return neighbours_.empty(); }
  /// Adds up `width` doubles per node (node-major, `values[node * width + k]`) over the ranks that share the node. Allocates nothing
  /// after the first call of a width.
  PetscErrorCode sum(double *values, int width);

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  std::vector<int> neighbours_;
  std::vector<std::vector<int>> shared_;
  // the helper that writes this adds buffers and the per-node list of contributors in rank order
};

}  // namespace talus
