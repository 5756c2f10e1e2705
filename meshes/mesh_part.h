#pragma once
/// What one rank has of a mesh, before it becomes the flat copy of the time loop.
#include <mpi.h>

#include <string>
#include <vector>

#include "meshes/simplices.h"

namespace talus {

/// Cells are in ascending order of their numbers. Neighbours on other ranks are -1 and stand in `seams`.
template <int dim>
struct MeshPart {
  Simplices<dim> cells;
  std::vector<long long> cell_number, node_number;  ///< the same on any partition
  std::vector<int> patch;                           ///< of cells, any numbers
  std::vector<char> owned;                          ///< nodes that count on this rank
  std::vector<double> mean_edge;                    ///< at nodes, over all ranks [m]
  Regions regions;
  Groups groups;
  std::vector<int> neighbours;                 ///< ranks with nodes in common, ascending
  std::vector<std::vector<int>> shared_nodes;  ///< with each of them, in an order that both ranks agree on
  std::vector<Seam> seams;
};

/// Divides a mesh that is whole on rank 0: each rank gets the cells that `rank_of_cell` gives it. The highest of the
/// ranks that share a node owns it. Collective.
template <int dim>
MeshPart<dim> deal_out(MPI_Comm comm, const MeshPart<dim> &whole, const std::vector<int> &rank_of_cell);

}  // namespace talus
