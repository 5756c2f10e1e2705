#pragma once
/// Nodes of the finite elements on the active cells of a mesh: the vertices and, for order 2, the middles of edges.
/// Numbering and exchange are DMPlex's own: a section on a clone of the mesh's DMPlex for elements.
#include <petscdmplex.h>

#include <vector>

#include "meshes/background_mesh.h"
#include "solvers/quasi_static/simplex_element.h"

namespace talus {

/// Gradients of all barycentric coordinates of a cell [1/m].
template <int dim>
std::array<Vec<dim>, dim + 1> barycentric_gradients(const Cell<dim> &cell) {
  std::array<Vec<dim>, dim + 1> g{};
  for (int k = 0; k < dim; ++k)
    for (int d = 0; d < dim; ++d) g[k + 1][d] = cell.gradient[k][d], g[0][d] -= cell.gradient[k][d];
  return g;
}

/// Place of a cell with these barycentric coordinates.
template <int dim>
Vec<dim> place_in(const BackgroundMesh<dim> &mesh, int cell, const Barycentric<dim> &l) {
  Vec<dim> x{};
  for (int a = 0; a <= dim; ++a)
    for (int d = 0; d < dim; ++d) x[d] += l[a] * mesh.position[mesh.cells[cell].node[a]][d];
  return x;
}

template <int dim>
class ElementNodes {
 public:
  /// `active` [cells] says which cells have elements, `components` how many unknowns a node has. Collective.
  PetscErrorCode setup(const BackgroundMesh<dim> &mesh, int order, const std::vector<char> &active,
                       int components = dim);

  int order() const { return order_; }
  int count() const { return static_cast<int>(position.size()); }
  /// Nodes of an active cell, element_nodes(order) of them.
  const int *of_cell(int cell) const { return &cell_node_[static_cast<size_t>(cell) * per_cell_]; }
  /// Nodes of a facet of an active cell: its vertices, then (order 2) the middles of its edges.
  std::vector<int> of_facet(int cell, int face) const;
  /// Node at a vertex of the mesh; -1 if no active cell of any rank touches it.
  int at_vertex(int mesh_node) const { return vertex_node_[mesh_node]; }

  std::vector<Vec<dim>> position;  ///< of local nodes [m]
  std::vector<char> owned;         ///< 1 on the one rank that has the node's row
  std::vector<PetscInt> point;     ///< of the DMPlex, a local node's
  std::vector<long long> number;   ///< of the same, not depending on the partition (ElementPlex::number)

  PetscErrorCode global_vector(Vector &v) const;
  /// Values of local nodes from a global vector; [count][components].
  PetscErrorCode to_local(::Vec global, std::vector<double> &local) const;
  /// Adds up local values of all ranks.
  PetscErrorCode add_to_global(const std::vector<double> &local, ::Vec global) const;
  /// Adds up nodal values over the ranks that share the node, in place; [count][components].
  PetscErrorCode sum(std::vector<double> &local) const;
  /// Largest value over the ranks that share a node; [count].
  PetscErrorCode maximum(std::vector<PetscInt> &local) const;
  /// Global block number of local nodes.
  const std::vector<PetscInt> &global() const { return global_; }
  MPI_Comm comm() const { return PetscObjectComm(reinterpret_cast<PetscObject>(static_cast<DM>(dm_))); }

 private:
  int order_ = 1, per_cell_ = dim + 1, components_ = dim;
  Dm dm_;
  std::vector<int> cell_node_, vertex_node_;
  std::vector<PetscInt> global_;
  mutable Vector local_, scratch_;
};

}  // namespace talus
