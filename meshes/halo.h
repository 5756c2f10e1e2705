#pragma once
/// Nodes that several ranks share: sums of nodal records, added in rank order so that all ranks agree to the bit.
#include <petscsys.h>

#include <vector>

namespace talus {

class Halo {
 public:
  Halo() = default;
  /// `shared[k]` lists the local nodes shared with rank `neighbour_ranks[k]`, in an order both ranks agree on (global
  /// number). Neighbours ascend. A node of three or more ranks stands in the list of each pair of them. The
  /// communicator must outlive the halo and is best a private one, as PETSc objects have.
  Halo(MPI_Comm comm, std::vector<int> neighbour_ranks, std::vector<std::vector<int>> shared);

  bool empty() const { return neighbours_.empty(); }
  const std::vector<int> &neighbours() const { return neighbours_; }
  const std::vector<std::vector<int>> &shared() const { return shared_; }
  const std::vector<int> &shared_nodes() const { return node_; }  ///< shared with any rank, ascending

  /// Adds up `width` doubles per node (node-major, `values[node * width + k]`) over the ranks that share the node.
  /// Every rank adds in ascending order of ranks, its own record in its place. Collective over the neighbours;
  /// allocates nothing after the first call of a width.
  PetscErrorCode sum(double *values, int width);

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  std::vector<int> neighbours_;
  std::vector<std::vector<int>> shared_;
  std::vector<int> first_;                  // of each neighbour's records in the buffers
  std::vector<int> node_;                   // nodes shared with any rank, ascending
  std::vector<int> first_source_, source_;  // CSR per shared node, rank order: record in `received_`, or `own`
  std::vector<double> sent_, received_;
  std::vector<MPI_Request> requests_;
};

}  // namespace talus
