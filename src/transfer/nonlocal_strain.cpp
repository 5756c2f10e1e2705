#include "transfer/nonlocal_strain.h"

#include <algorithm>
#include <cmath>

#include "base/room.h"

namespace talus {
namespace {

/// Gradients of all shape functions; the first is minus the sum of the others.
template <int dim>
std::array<Vec<dim>, dim + 1> gradients(const std::array<Vec<dim>, dim> &given) {
  std::array<Vec<dim>, dim + 1> all{};
  for (int k = 0; k < dim; ++k)
    for (int d = 0; d < dim; ++d) all[k + 1][d] = given[k][d], all[0][d] -= given[k][d];
  return all;
}

}  // namespace

/// Eigenvalues of D^-1 A lie between the extremes of those of its cells (Irons & Treharne 1971), which Gershgorin's
/// circles bound.
template <int dim>
NonlocalStrain<dim>::NonlocalStrain(const BackgroundMesh<dim> &mesh, double length, int field, int history_count)
    : area_(length * length), field_(field), history_count_(history_count) {
  double bounds[2] = {-1, 1};
  for (const Cell<dim> &cell : mesh.cells) {
    const auto g = gradients<dim>(cell.gradient);
    for (int i = 0; i <= dim; ++i) {
      const double mass = 1. / (dim + 1), diagonal = mass + area_ * dot<dim>(g[i], g[i]);
      double row = diagonal;
      for (int j = 0; j <= dim; ++j)
        if (j != i) row += area_ * std::abs(dot<dim>(g[i], g[j]));
      bounds[0] = std::max(bounds[0], -mass / diagonal), bounds[1] = std::max(bounds[1], row / diagonal);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, bounds, 2, MPI_DOUBLE, MPI_MAX, mesh.comm());
  least_ = -bounds[0], largest_ = std::min(bounds[1], dim + 1.);
  const std::size_t nodes = mesh.node_count(), cells = mesh.cell_count();
  size_.assign(cells, 2 * length), make_room(part_, cells), make_room(cell_, cells), make_room(sums_, nodes);
  for (auto *nodal : {&mass_, &over_diagonal_, &load_, &average_, &residual_, &direction_, &product_})
    make_room(*nodal, nodes);
  make_room(excess_, cells);
}

template <int dim>
int NonlocalStrain<dim>::iterations_to(double factor) const {
  return static_cast<int>(std::ceil(std::acosh(1 / factor) / std::acosh((largest_ + least_) / (largest_ - least_))));
}

/// Cells that hold soil of the body, with their couplings.
template <int dim>
void NonlocalStrain<dim>::find_parts(const FilledGrid<dim> &grid, const PointSet &points) {
  std::fill_n(cell_.begin(), grid.cell_count(), std::array<double, 2>{});
  for (int q = 0; q < points.count; ++q) cell_[points.cell[q]][0] += points.volume[q];
  parts_ = 0;
  for (int c = 0; c < grid.cell_count(); ++c) {
    if (!(cell_[c][0] > 0)) continue;
    Part &part = part_[parts_++];
    part.cell = c, part.node = grid.shape[c].node, part.volume = cell_[c][0];
    const auto g = gradients<dim>(grid.shape[c].gradient);
    for (int k = 0, pair = 0; k <= dim; ++k)
      for (int l = k + 1; l <= dim; ++l) part.coupling[pair++] = area_ * part.volume * dot<dim>(g[k], g[l]);
  }
}

/// Nodal load of the points' own strain, with the volumes of the remap. Collective.
template <int dim>
PetscErrorCode NonlocalStrain<dim>::load(FilledGrid<dim> &grid, const PointSet &points) {
  PetscFunctionBeginUser;
  for (int k = 0; k < parts_; ++k) cell_[part_[k].cell] = {};
  for (int q = 0; q < points.count; ++q) {
    auto &[volume, sum] = cell_[points.cell[q]];
    volume += points.volume[q], sum += points.volume[q] * points.history[q * history_count_ + field_];
  }
  std::fill_n(load_.begin(), grid.node_count(), 0.);
  for (int k = 0; k < parts_; ++k) {
    const Part &part = part_[k];
    const auto &[volume, sum] = cell_[part.cell];
    const double share = part.volume * (sum / volume) * (1. / (dim + 1));
    for (int i : part.node) load_[i] += share;
  }
  PetscCall(grid.sum(load_.data(), 1));
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode NonlocalStrain<dim>::begin(FilledGrid<dim> &grid, const PointSet &points) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  find_parts(grid, points);
  std::fill_n(sums_.begin(), nodes, std::array<double, 2>{});
  for (int p = 0; p < parts_; ++p) {
    const Part &part = part_[p];
    const auto g = gradients<dim>(grid.shape[part.cell].gradient);
    for (int k = 0; k <= dim; ++k) {
      auto &[mass, diagonal] = sums_[part.node[k]];
      mass += part.volume / (dim + 1), diagonal += part.volume * (1. / (dim + 1) + area_ * dot<dim>(g[k], g[k]));
    }
  }
  PetscCall(grid.sum(sums_[0].data(), 2));
  PetscCall(load(grid, points));
  for (int i = 0; i < nodes; ++i) {
    const auto &[mass, diagonal] = sums_[i];
    mass_[i] = mass, over_diagonal_[i] = diagonal > 0 ? 1 / diagonal : 0;
    average_[i] = mass > 0 ? load_[i] / mass : 0;
  }
  PetscCall(iterate(grid, iterations_to(1e-8)));
  if (static_cast<int>(excess_.size()) < points.count) excess_.resize(points.count);  // particles as stress points
  spread(grid, points);
  PetscFunctionReturn(0);
}

template <int dim>
PetscErrorCode NonlocalStrain<dim>::update(FilledGrid<dim> &grid, const PointSet &points) {
  PetscFunctionBeginUser;
  PetscCall(load(grid, points));
  PetscCall(iterate(grid, iterations_to(0.5)));
  spread(grid, points);
  PetscFunctionReturn(0);
}

/// y = A x, summed over ranks. Where soil of this rank has not yielded, x is zero.
template <int dim>
PetscErrorCode NonlocalStrain<dim>::apply(FilledGrid<dim> &grid, const double *x, double *y) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  std::fill_n(y, nodes, 0.);
  const bool zero = std::all_of(x, x + nodes, [](double value) { return value == 0; });
  for (int p = 0; !zero && p < parts_; ++p) {
    const auto &[cell, node, volume, coupling] = part_[p];
    std::array<double, dim + 1> sum{};
    for (int k = 0, pair = 0; k <= dim; ++k)
      for (int l = k + 1; l <= dim; ++l, ++pair) {
        const double flow = coupling[pair] * (x[node[l]] - x[node[k]]);
        sum[k] += flow, sum[l] -= flow;
      }
    for (int k = 0; k <= dim; ++k) y[node[k]] += sum[k];
  }
  PetscCall(grid.sum(y, 1));
  for (int i = 0; i < nodes; ++i) y[i] += mass_[i] * x[i];
  PetscFunctionReturn(0);
}

/// Chebyshev's iteration (Saad 2003, algorithm 12.1) from the present average: no sums over all nodes, so that the
/// result is a smooth function of the strain, the same on any number of ranks.
template <int dim>
PetscErrorCode NonlocalStrain<dim>::iterate(FilledGrid<dim> &grid, int iterations) {
  PetscFunctionBeginUser;
  const int nodes = grid.node_count();
  const double centre = (largest_ + least_) / 2, radius = (largest_ - least_) / 2, sigma = centre / radius;
  double rho = 1 / sigma;
  PetscCall(apply(grid, average_.data(), product_.data()));
  for (int i = 0; i < nodes; ++i) {
    residual_[i] = over_diagonal_[i] * (load_[i] - product_[i]);
    direction_[i] = residual_[i] / centre;
  }
  for (int k = 0; k < iterations; ++k) {
    for (int i = 0; i < nodes; ++i) average_[i] += direction_[i];
    if (k + 1 == iterations) break;
    PetscCall(apply(grid, direction_.data(), product_.data()));
    const double next = 1 / (2 * sigma - rho);
    for (int i = 0; i < nodes; ++i) {
      residual_[i] -= over_diagonal_[i] * product_[i];
      direction_[i] = next * rho * direction_[i] + 2 * next / radius * residual_[i];
    }
    rho = next;
  }
  PetscFunctionReturn(0);
}

/// To the points: the mean over the nodes of their cell.
template <int dim>
void NonlocalStrain<dim>::spread(const FilledGrid<dim> &grid, const PointSet &points) {
  for (int q = 0; q < points.count; ++q) {
    double sum = 0;
    for (int i : grid.shape[points.cell[q]].node) sum += average_[i];
    excess_[q] = sum * (1. / (dim + 1)) - points.history[q * history_count_ + field_];
  }
}

template <int dim>
void NonlocalStrain<dim>::serialize(Archive &archive, const FilledGrid<dim> &grid,
                                    const typename FilledGrid<dim>::Rows &rows, const Archive::Rows &points) {
  struct Kept {
    double volume;
    Couplings coupling;
  };
  std::vector<Kept> kept(grid.cell_count());  // no volume: no part
  for (int p = 0; p < parts_ && !archive.reading(); ++p) kept[part_[p].cell] = {part_[p].volume, part_[p].coupling};
  archive.column(rows.cells, "cells of nonlocal strain", kept);
  parts_ = 0;
  for (int c = 0; c < grid.cell_count(); ++c)
    if (kept[c].volume > 0) part_[parts_++] = {c, grid.shape[c].node, kept[c].volume, kept[c].coupling};
  archive.column(rows.nodes, "mass of nonlocal strain", mass_);
  archive.column(rows.nodes, "diagonal of nonlocal strain", over_diagonal_);
  archive.column(rows.nodes, "nonlocal strain", average_);
  archive.column(points, "excess of nonlocal strain", excess_);
}

template class NonlocalStrain<2>;
template class NonlocalStrain<3>;

}  // namespace talus
