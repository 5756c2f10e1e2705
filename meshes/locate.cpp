#include "meshes/locate.h"

namespace talus {
namespace {

// Straight walks end after a few steps; where cells are badly shaped the walk towards the most negative coordinate may
// run in a circle, and taking the negative sides in turn leaves it.
constexpr int straight_steps = 200, longest_walk = 20000;

/// Sides of a cell that x lies beyond, the farthest first. Returns their number.
template <int dim>
int sides_beyond(const std::array<double, dim + 1> &n, std::array<int, dim + 1> &side) {
  int count = 0;
  for (int k = 0; k <= dim; ++k) {
    if (n[k] >= inside_tolerance) continue;
    int at = count++;
    for (; at > 0 && n[side[at - 1]] > n[k]; --at) side[at] = side[at - 1];
    side[at] = k;
  }
  return count;
}

template <int dim>
Located put_inside(const BackgroundMesh<dim> &mesh, int cell, std::array<double, dim + 1> n, Point<dim> &x) {
  constexpr double deepest = -0.5;  // beyond it a point has not met a rough face but flown through it
  const int farthest = static_cast<int>(std::min_element(n.begin(), n.end()) - n.begin());
  const bool closed = n[farthest] > deepest && !mesh.closed.empty() && (mesh.closed[cell] >> farthest & 1);
  double sum = 0;
  for (double &one : n) sum += one = std::max(one, 1e-9);
  x = {};
  for (int k = 0; k <= dim; ++k)
    for (int d = 0; d < dim; ++d) x[d] += n[k] / sum * mesh.position[mesh.cells[cell].node[k]][d];
  return {.cell = cell, .left_by = closed ? -1 : farthest};
}

}  // namespace

template <int dim>
Located walk_on(const BackgroundMesh<dim> &mesh, int start, Point<dim> &x) {
  int cell = start;
  std::array<int, dim + 1> side;
  for (int step = 0; step < longest_walk; ++step) {
    const Cell<dim> &here = mesh.cells[cell];
    const auto n = barycentric(here, x);
    const int count = sides_beyond<dim>(n, side);
    if (count == 0) return {cell};
    const int turn = step < straight_steps ? 0 : step % count;
    int next = boundary;
    for (int k = 0; k < count && next == boundary; ++k) next = here.neighbour[side[(k + turn) % count]];
    if (next == boundary) return put_inside(mesh, cell, n, x);
    if (next < boundary) return {.cell = cell, .partition_face = -2 - next};
    cell = next;
  }
  const int found = find(mesh, x, cell / mesh.cells_in_sheet());
  if (found >= 0) return {found};
  return put_inside(mesh, cell, barycentric(mesh.cells[cell], x), x);
}

template <int dim>
int find(const BackgroundMesh<dim> &mesh, const Point<dim> &x, int sheet) {
  const int cells = mesh.cells_in_sheet();
  for (int cell = sheet * cells; cell < (sheet + 1) * cells; ++cell) {
    const auto n = barycentric(mesh.cells[cell], x);
    if (*std::min_element(n.begin(), n.end()) >= inside_tolerance) return cell;
  }
  return -1;
}

template Located walk_on<2>(const BackgroundMesh<2> &, int, Vec<2> &);
template Located walk_on<3>(const BackgroundMesh<3> &, int, Vec<3> &);
template int find<2>(const BackgroundMesh<2> &, const Vec<2> &, int);
template int find<3>(const BackgroundMesh<3> &, const Vec<3> &, int);

}  // namespace talus
