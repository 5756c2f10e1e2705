#pragma once
/// What the operator of implicit pressure, docs/theory/pores.md (8.5), is made of, as sparse matrices: for each node of
/// a rank a row with the nodes of its cells. Products with them read a node's row once instead of each of its cells.
#include <array>
#include <vector>

#include "base/lanes.h"
#include "transfer/filled_grid.h"

namespace talus {

/// Of one node: of the skeleton, and of the liquid against it.
struct NodalPair {
  Quad solid, apart;
};

template <int dim>
class PressureMatrices {
 public:
  static constexpr int gap = 3;  ///< lane beyond those of a vector
  /// A corner of a cell at a gap between particles, and its share of the weight of the cell.
  struct GapCorner {
    int node, cell;
    double share;
  };

  /// Takes memory for any part of the mesh.
  void make_room_for(const BackgroundMesh<dim> &mesh);
  /// Finds the rows of a grid that has been filled anew, and its mass matrix.
  void begin(const FilledGrid<dim> &grid);
  /// Integrals of gradients over the cells as they are now, of `shape` and `weight`, and of gaps.
  void integrate(const Shape<dim> *shape, const double *weight, const std::vector<GapCorner> &gaps);

  // Products; each gives the part of the cells of this rank.
  /// Sum of w p grad N over cells that have the mean p of the pressures of their nodes [N]; lane `gap`: sum of w p
  /// times the share, of the gaps at the node [N m].
  void push(const double *pressure, Quad *push) const;
  /// Sums of m_p N_i v_p over particles that have the velocities of nodes [kg m/s].
  void momentum(const NodalPair *velocity, NodalPair *momentum) const;
  /// The adjoint of `push`: for each node its part of the integral of div v [m3/s]; lane `gap` of v is what gaps take.
  void divergence(const Quad *velocity, double *divergence) const;
  /// Diagonal of divergence(mobility . push) [m4].
  void diagonal(const double *mobility, double *diagonal) const;

 private:
  int nodes_ = 0, cells_ = 0;
  std::vector<int> first_, column_;                                   ///< of the rows, and of their entries
  std::vector<std::array<std::array<int, dim + 1>, dim + 1>> place_;  ///< of pairs of nodes of a cell
  std::vector<Quad> gradient_;                                        ///< sum of w grad N / (d + 1) [m2]
  std::vector<double> mass_;                                          ///< [kg]
  std::vector<int> first_cell_, cell_, seen_;                         ///< scratch: cells of nodes; a node's last place
};

}  // namespace talus
