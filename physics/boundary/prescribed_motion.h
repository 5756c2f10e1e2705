#pragma once
/// Nodes whose motion boundaries prescribe, docs/theory section 6: their directions, orthonormalised per node once.
/// There are two sets: in motion, and with the supports that stand in for dashpots.
#include <vector>

#include "physics/boundary/boundary.h"
#include "physics/boundary/prescribed_directions.h"
#include "transfer/filled_grid.h"

namespace talus {

template <int dim>
class PrescribedMotion {
 public:
  struct Active {
    int node;  // compact
    const PrescribedDirections<dim> *condition;
    Vec<dim> change;  // of the velocity of the node, beside contacts [m/s]
  };
  void setup(int nodes, const std::vector<NamedBoundary> &sources);
  /// Adds the directions that the boundary `source` prescribes at a mesh node where its normal is `normal`.
  void add(int node, int source, const Vec<dim> &normal);
  /// Room for all nodes, so that `begin` asks for no memory. Returns the number of nodes.
  size_t reserve();
  /// Picks the nodes of the filled grid.
  void begin(const FilledGrid<dim> &grid, bool stand_ins);

  std::vector<Active> &active() { return active_; }
  const std::vector<Active> &active() const { return active_; }
  /// The directions of a compact node; null: none.
  Active *find(int node);
  /// Gives the velocity `v` of the node of `p` at `x` the prescribed value in its direction `k`, or in all of them.
  void impose(const Active &p, int k, double t, const Vec<dim> &x, Vec<dim> &v) const;
  void impose(const Active &p, double t, const Vec<dim> &x, Vec<dim> &v) const {
    for (int k = 0; k < p.condition->count; ++k) impose(p, k, t, x, v);
  }

 private:
  struct Set {
    std::vector<int> of_node;  // mesh node -> entry, -1: none
    std::vector<PrescribedDirections<dim>> entry;
  };
  std::vector<Boundary> kinds_;  ///< of the sources
  std::array<Set, 2> sets_;
  std::vector<Active> active_;  ///< by compact node
};

}  // namespace talus
