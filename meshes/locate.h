#pragma once
/// The walk from cell to cell by barycentric coordinates.
#include "meshes/background_mesh.h"

namespace talus {

/// Barycentric coordinates of x in a cell, frozen at the mesh's own node positions.
template <int dim>
inline std::array<double, dim + 1> barycentric(const Cell<dim> &cell, const Vec<dim> &x) {
  std::array<double, dim + 1> n;
  n[0] = 1;
  for (int k = 0; k < dim; ++k) {
    double s = 0;
    for (int d = 0; d < dim; ++d) s += cell.gradient[k][d] * (x[d] - cell.origin[d]);
    n[k + 1] = s;
    n[0] -= s;
  }
  return n;
}

/// Where a walk ended: in local `cell`; at a partition face (`partition_face` >= 0, `cell` the last local one); or against the
/// boundary (`outside`, `cell` the boundary cell; x is then moved just inside it).
struct Located {
  int cell;
  int partition_face = -1;
  bool outside = false;
};

/// Walks from `start` to the cell that holds x. A point beyond the boundary is put back into the nearest boundary cell met.
template <int dim>
Located walk(const BackgroundMesh<dim> &mesh, int start, Vec<dim> &x);

/// The cell of a point given without a start, by a search over all local cells; -1 when no local cell holds it.
template <int dim>
int find(const BackgroundMesh<dim> &mesh, const Vec<dim> &x);

}  // namespace talus
