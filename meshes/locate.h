#pragma once
/// The walk from cell to cell by barycentric coordinates.
#include <algorithm>
#include <type_traits>

#include "meshes/background_mesh.h"

namespace talus {

/// Keeps a point out of the deduction of `dim`, which std::array (counted by std::size_t) would spoil.
template <int dim>
using Point = std::type_identity_t<Vec<dim>>;

/// Barycentric coordinates of x in a cell, frozen at the mesh's own node positions.
template <int dim>
inline std::array<double, dim + 1> barycentric(const Cell<dim> &cell, const Point<dim> &x) {
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

/// A point counts as inside a cell while no barycentric coordinate is below this.
inline constexpr double inside_tolerance = -1e-12;

/// Where a walk ended: in local `cell`; at a partition face (`partition_face` >= 0, `cell` the last local one); or
/// outside, beyond face `left_by` of boundary cell `cell` (x is then moved just inside it). Beyond a closed face
/// (BackgroundMesh::closed) by less than half of the cell's altitude x is moved inside as well and counts as inside.
struct Located {
  int cell;
  int partition_face = -1;
  int left_by = -1;
};

/// The walk of a point known to be outside `start`: what `walk` does when its first look fails.
template <int dim>
Located walk_on(const BackgroundMesh<dim> &mesh, int start, Point<dim> &x);

/// Walks from `start` to the cell that holds x. A point beyond the boundary is put back into the nearest boundary cell
/// met. Most points stay in their cell: that test is inline.
template <int dim>
inline Located walk(const BackgroundMesh<dim> &mesh, int start, Point<dim> &x) {
  const auto n = barycentric(mesh.cells[start], x);
  if (*std::min_element(n.begin(), n.end()) >= inside_tolerance) return {start};
  return walk_on(mesh, start, x);
}

/// The cell of a point given without a start, by a search over all local cells of a sheet; -1 when none holds it. A
/// point on a face belongs to the lowest of its cells; on a partition face each of the two ranks finds it.
template <int dim>
int find(const BackgroundMesh<dim> &mesh, const Point<dim> &x, int sheet = 0);

}  // namespace talus
