#pragma once
/// Prescribed directions at the nodes of the finite elements, from the boundaries of the scene that support soil in
/// quasi-static stages. A node whose directions are not axes has a frame of its own: its first rows are the prescribed
/// directions.
#include <vector>

#include "physics/boundary/conditions.h"
#include "physics/boundary/prescribed_directions.h"
#include "solvers/quasi_static/element_nodes.h"

namespace talus {

template <int dim>
struct Support : PrescribedDirections<dim> {
  Square<dim> frame;           ///< its rows are the unit vectors of the node's unknowns
  std::array<char, dim> held;  ///< 1 where that unknown is prescribed
  bool turned = false;         ///< the frame is not the identity
};

template <int dim>
class Supports {
 public:
  using Source = NamedBoundary;
  /// Collective. `active` [cells]: facets count where their cell is active.
  PetscErrorCode setup(const BackgroundMesh<dim> &mesh, const ElementNodes<dim> &nodes, const std::vector<char> &active,
                       const std::vector<Source> &sources);
  /// Support of a local node, or null.
  const Support<dim> *at(int node) const { return of_node_[node] < 0 ? nullptr : &supports_[of_node_[node]]; }
  /// Displacement that the boundaries prescribe between two times, at a node, in its own frame; 0 in free components
  /// [m].
  Vec<dim> increment(int node, const Vec<dim> &x, double from, double to) const;
  /// Is any motion prescribed?
  bool moves() const { return moves_; }

 private:
  const std::vector<Source> *sources_ = nullptr;
  std::vector<int> of_node_;
  std::vector<Support<dim>> supports_;
  bool moves_ = false;
};

}  // namespace talus
