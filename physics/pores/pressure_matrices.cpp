#include "physics/pores/pressure_matrices.h"

#include <algorithm>

#include "base/room.h"

namespace talus {
namespace {

/// The sums of the lanes of four quads.
inline Quad sums(Quad (&q)[4]) {
  transpose(q);
  return (q[0] + q[1]) + (q[2] + q[3]);
}

/// The cells of each node, node by node, into `list`; those of node i begin at `first`[i].
template <int dim, class Nodes>
void list_cells(int nodes, int cells, Nodes &&nodes_of, std::vector<int> &first, std::vector<int> &list) {
  std::fill_n(first.begin(), nodes + 1, 0);
  for (int c = 0; c < cells; ++c)
    for (const int i : nodes_of(c)) ++first[i + 1];
  for (int i = 0; i < nodes; ++i) first[i + 1] += first[i];
  for (int c = 0; c < cells; ++c)
    for (const int i : nodes_of(c)) list[first[i]++] = c;
  for (int i = nodes; i > 0; --i) first[i] = first[i - 1];
  first[0] = 0;
}

}  // namespace

template <int dim>
void PressureMatrices<dim>::make_room_for(const BackgroundMesh<dim> &mesh) {
  const size_t nodes = mesh.node_count(), cells = mesh.cell_count();
  make_room(first_, nodes + 1), make_room(first_cell_, nodes + 1), make_room(seen_, nodes);
  make_room(cell_, (dim + 1) * cells), make_room(place_, cells);
  list_cells<dim>(
      nodes, cells, [&](int c) -> auto & { return mesh.cells[c].node; }, first_cell_, cell_);
  size_t pairs = 0;
  for (int i = 0; i < static_cast<int>(nodes); ++i)
    for (int k = first_cell_[i]; k < first_cell_[i + 1]; ++k)
      for (const int j : mesh.cells[cell_[k]].node)
        if (seen_[j] != i + 1) seen_[j] = i + 1, ++pairs;
  make_room(column_, pairs), make_room(gradient_, pairs), make_room(mass_, pairs);
}

template <int dim>
void PressureMatrices<dim>::begin(const FilledGrid<dim> &grid) {
  nodes_ = grid.node_count(), cells_ = grid.cell_count();
  list_cells<dim>(
      nodes_, cells_, [&](int c) -> auto & { return grid.shape[c].node; }, first_cell_, cell_);
  std::fill_n(seen_.begin(), nodes_, -1);
  int entries = 0;
  for (int i = 0; i < nodes_; ++i) {
    first_[i] = entries;
    for (int n = first_cell_[i]; n < first_cell_[i + 1]; ++n) {
      const int c = cell_[n];
      const auto &node = grid.shape[c].node;
      const int k = static_cast<int>(std::ranges::find(node, i) - node.begin());
      for (int l = 0; l <= dim; ++l) {
        int &last = seen_[node[l]];
        if (last < first_[i]) last = entries, column_[entries] = node[l], mass_[entries++] = 0;
        place_[c][k][l] = last;
      }
    }
  }
  first_[nodes_] = entries;
  for (int c = 0; c < cells_; ++c) {
    const auto &matrix = grid.mass_matrix[c];
    for (int k = 0, pair = dim + 1; k <= dim; ++k) {
      mass_[place_[c][k][k]] += matrix[k];
      for (int l = k + 1; l <= dim; ++l, ++pair)
        mass_[place_[c][k][l]] += matrix[pair], mass_[place_[c][l][k]] += matrix[pair];
    }
  }
}

template <int dim>
void PressureMatrices<dim>::integrate(const Shape<dim> *shape, const double *weight,
                                      const std::vector<GapCorner> &gaps) {
  std::fill_n(gradient_.begin(), first_[nodes_], Quad{});
  for (int c = 0; c < cells_; ++c) {
    const Quad part = quad(weight[c] / (dim + 1));
    Quad g[dim + 1]{};
    for (int k = 1; k <= dim; ++k) g[k] = part * load<dim>(shape[c].gradient[k - 1].data()), g[0] -= g[k];
    for (int k = 0; k <= dim; ++k)
      for (int l = 0; l <= dim; ++l) gradient_[place_[c][k][l]] += g[k];
  }
  for (const GapCorner &corner : gaps) {
    const auto &node = shape[corner.cell].node;
    const int k = static_cast<int>(std::ranges::find(node, corner.node) - node.begin());
    for (int l = 0; l <= dim; ++l)
      gradient_[place_[corner.cell][k][l]][gap] += weight[corner.cell] / (dim + 1) * corner.share;
  }
}

template <int dim>
void PressureMatrices<dim>::push(const double *pressure, Quad *push) const {
  for (int i = 0; i < nodes_; ++i) {
    Quad sum{};
    for (int n = first_[i]; n < first_[i + 1]; ++n) sum += quad(pressure[column_[n]]) * gradient_[n];
    push[i] = sum;
  }
}

template <int dim>
void PressureMatrices<dim>::momentum(const NodalPair *velocity, NodalPair *momentum) const {
  for (int i = 0; i < nodes_; ++i) {
    NodalPair sum{};
    for (int n = first_[i]; n < first_[i + 1]; ++n) {
      const Quad mass = quad(mass_[n]);
      const NodalPair &v = velocity[column_[n]];
      sum.solid += mass * v.solid, sum.apart += mass * v.apart;
    }
    momentum[i] = sum;
  }
}

template <int dim>
void PressureMatrices<dim>::divergence(const Quad *velocity, double *divergence) const {
  std::fill_n(divergence, nodes_, 0.);
  for (int i = 0; i < nodes_; ++i) {
    const Quad v = velocity[i];
    for (int n = first_[i]; n < first_[i + 1]; n += 4) {
      const int count = std::min(4, first_[i + 1] - n);
      Quad part[4]{};
      for (int k = 0; k < count; ++k) part[k] = v * gradient_[n + k];
      const Quad sum = sums(part);
      for (int k = 0; k < count; ++k) divergence[column_[n + k]] += sum[k];
    }
  }
}

template <int dim>
void PressureMatrices<dim>::diagonal(const double *mobility, double *diagonal) const {
  std::fill_n(diagonal, nodes_, 0.);
  for (int i = 0; i < nodes_; ++i)
    for (int n = first_[i]; n < first_[i + 1]; ++n) {
      const Quad square = gradient_[n] * gradient_[n];
      diagonal[column_[n]] += mobility[i] * (square[0] + square[1] + square[2]);
    }
}

template class PressureMatrices<2>;
template class PressureMatrices<3>;

}  // namespace talus
