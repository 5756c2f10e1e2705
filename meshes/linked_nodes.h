#pragma once
/// Nodes of a mesh that stand for each other although they lie apart: those of two sides that move alike, or of a side
/// and of the column of soil beside it.
#include <petscsys.h>

#include <string>
#include <vector>

#include "base/vec.h"

namespace talus {

template <int dim>
class BackgroundMesh;  // meshes/background_mesh.h
template <int dim>
struct Facet;  // meshes/background_mesh.h

class LinkedNodes {
 public:
  LinkedNodes() = default;
  /// Each group lists the global numbers of nodes that stand for each other; no node is in two groups. All ranks give
  /// the same groups. `owned` [local nodes] is 1 on the one rank that counts a node.
  LinkedNodes(MPI_Comm comm, std::vector<std::vector<long long>> groups, const std::vector<long long> &global_node,
              const std::vector<char> &owned);

  bool empty() const { return groups_.empty(); }
  const std::vector<std::vector<long long>> &groups() const { return groups_; }
  /// Local nodes of all groups.
  const std::vector<int> &nodes() const { return nodes_; }
  /// From now on `sum` finds what belongs to a local node at `place(node)`; -1: nothing does.
  template <class Place>
  void find_places(Place &&place) {
    for (std::size_t k = 0; k < members_.size(); ++k) place_[k] = members_[k] < 0 ? -1 : place(members_[k]);
  }
  /// Gives all nodes of a group the sum of `width` doubles over them (`values[place * width + k]`), in the order of the
  /// group, so that all ranks agree to the bit. What ranks that share a node have of it must be equal. Collective;
  /// allocates nothing after the first call of the largest width.
  PetscErrorCode sum(double *values, int width);

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  int ranks_ = 1;
  std::vector<std::vector<long long>> groups_;
  std::vector<int> first_;          // of the members of each group
  std::vector<int> members_;        // local nodes, -1 where this rank has none
  std::vector<int> place_, nodes_;  // of the members; local nodes
  std::vector<char> counts_;        // members that this rank counts
  std::vector<double> records_;
};

/// A node of a plane face of the mesh, as all ranks know it.
template <int dim>
struct FaceNode {
  long long number;  ///< global
  Vec<dim> position;
  int side;  ///< +1 or -1: which way the face looks
};

/// The nodes of facets that lie in one or two parallel planes, each once, ascending by number; `normal` is that of the
/// facets of side +1. Complains, on all ranks alike, about facets that look another way and about more than one plane
/// on a side. Collective.
template <int dim>
std::vector<FaceNode<dim>> nodes_of_planes(const BackgroundMesh<dim> &mesh, const std::vector<Facet<dim>> &facets,
                                           Vec<dim> &normal, std::string &complaint);

/// Pairs of nodes, one of each list, that lie on one line along `normal`; complains about the first one without a
/// partner. `near` is the distance across this line within which they do [m].
template <int dim>
std::vector<std::vector<long long>> opposite_nodes(const std::vector<FaceNode<dim>> &one,
                                                   const std::vector<FaceNode<dim>> &other, const Vec<dim> &normal,
                                                   double near, std::string &complaint);

/// Unites groups that have a node in common.
std::vector<std::vector<long long>> united(const std::vector<std::vector<long long>> &groups);

}  // namespace talus
