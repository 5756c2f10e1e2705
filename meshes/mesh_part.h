#pragma once
/// What one rank has of a mesh, before it becomes the flat copy of the time loop.
#include <mpi.h>

#include <string>
#include <vector>

#include "meshes/simplex_edges.h"
#include "meshes/simplices.h"

namespace talus {

/// An edge, or the node in its middle, has a number that belongs to the lowest of the cells with this edge; `edge` is
/// its place in simplex_edges. Numbers below `first` are those of nodes.
template <int dim>
long long edge_number(long long first, long long cell, int edge) {
  return first + static_cast<long long>(simplex_edges<dim>.size()) * cell + edge;
}

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
  long long all_cells = 0;       ///< of all ranks
  long long end_of_numbers = 0;  ///< all nodes have lower numbers
};

/// Cuts the cells of each `kind` into patches, docs/theory 4.5: a combination of regions, or an older patch of which
/// these are the cells in smaller ones. Then no triangle is left alone: of each patch of one, two of four would be.
/// Collective.
template <int dim>
void cut_patches(MPI_Comm comm, MeshPart<dim> &part, const std::vector<int> &kind, bool within_patches = false);

/// 3D, and all nodes of all ranks lie on two planes z = const. Collective.
template <int dim>
bool is_one_element_slice(MPI_Comm comm, const std::vector<Vec<dim>> &position);

/// Divides a mesh that is whole on rank 0: each rank gets the cells that `rank_of_cell` gives it. The highest of the
/// ranks that share a node owns it. Collective.
template <int dim>
MeshPart<dim> deal_out(MPI_Comm comm, const MeshPart<dim> &whole, const std::vector<int> &rank_of_cell);

}  // namespace talus
