#pragma once
/// Which ranks have parts of the mesh near each other: of the others a rank knows no more than a box.
#include <limits>

#include "meshes/background_mesh.h"

namespace talus {

/// Least and largest coordinates [m].
template <int dim>
struct Box {
  Vec<dim> low, high;
  Box() { low.fill(std::numeric_limits<double>::max()), high.fill(std::numeric_limits<double>::lowest()); }
  void take_in(const Vec<dim> &x) {
    for (int d = 0; d < dim; ++d) low[d] = std::min(low[d], x[d]), high[d] = std::max(high[d], x[d]);
  }
  /// Does the other box come as near as `reach` [m] along all axes but one, -1: along all?
  bool meets(const Box &other, double reach, int but = -1) const {
    for (int d = 0; d < dim; ++d)
      if (d != but && (other.low[d] > high[d] + reach || low[d] > other.high[d] + reach)) return false;
    return true;
  }
};

/// Around the parts of all ranks. Collective.
template <int dim>
std::vector<Box<dim>> boxes_of_parts(const BackgroundMesh<dim> &mesh) {
  int ranks;
  MPI_Comm_size(mesh.comm(), &ranks);
  Box<dim> mine;
  for (const Vec<dim> &x : mesh.position) mine.take_in(x);
  std::vector<Box<dim>> boxes(ranks);
  MPI_Allgather(&mine, 2 * dim, MPI_DOUBLE, boxes.data(), 2 * dim, MPI_DOUBLE, mesh.comm());
  return boxes;
}

}  // namespace talus
