#pragma once
/// What the mass matrices of the cells, docs/theory (4.1), do to nodal fields. `fields` vector fields stand one after
/// the other, each with a vector per node of the grid.
#include "base/lanes.h"
#include "transfer/filled_grid.h"

namespace talus {

/// Nodes to particles and back at frozen positions, out = M^-1 M^c in: S of docs/theory (4.9). Collective.
template <int dim, int fields>
PetscErrorCode to_particles_and_back(FilledGrid<dim> &grid, const Vec<dim> *in, Vec<dim> *out) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count(), cells = grid.cell_count();
  std::fill_n(out, nodes * fields, Vec<dim>{});
  for (int c = 0; c < cells; ++c) {
    const auto &node = grid.shape[c].node;
    const auto &matrix = grid.mass_matrix[c];
    for (int first = 0; first < nodes * fields; first += nodes) {
      Quad v[dim + 1], sum[dim + 1];
#pragma GCC unroll 8
      for (int k = 0; k <= dim; ++k) v[k] = load<dim>(in[first + node[k]].data()), sum[k] = quad(matrix[k]) * v[k];
#pragma GCC unroll 8
      for (int k = 0, pair = dim + 1; k <= dim; ++k)
#pragma GCC unroll 8
        for (int l = k + 1; l <= dim; ++l, ++pair)
          sum[k] += quad(matrix[pair]) * v[l], sum[l] += quad(matrix[pair]) * v[k];
#pragma GCC unroll 8
      for (int k = 0; k <= dim; ++k) {
        double *x = out[first + node[k]].data();
        store<dim>(x, load<dim>(x) + sum[k]);
      }
    }
  }
  for (int f = 0; f < fields; ++f) {
    PetscCall(grid.sum(out[f * nodes].data(), dim));
    for (int i = 0; i < nodes; ++i)
      for (int d = 0; d < dim; ++d) out[f * nodes + i][d] /= grid.mass[i];
  }
  PetscFunctionReturn(0);
}

/// Sum of m_p |x_p|^2 over the particles of this rank, where x_p is the nodal field `x` at particle p.
template <int dim, int fields>
double seen_square(const FilledGrid<dim> &grid, const Vec<dim> *x) {
  double sum = 0;
  for (int f = 0; f < fields; ++f) {
    const Vec<dim> *field = x + f * grid.node_count();
    for (int c = 0; c < grid.cell_count(); ++c) {
      const auto &node = grid.shape[c].node;
      const auto &matrix = grid.mass_matrix[c];
      for (int d = 0; d < dim; ++d)
        for (int k = 0, pair = dim + 1; k <= dim; ++k) {
          const double xk = field[node[k]][d];
          sum += matrix[k] * xk * xk;
          for (int l = k + 1; l <= dim; ++l, ++pair) sum += 2 * matrix[pair] * xk * field[node[l]][d];
        }
    }
  }
  return sum;
}

}  // namespace talus
