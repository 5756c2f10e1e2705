#pragma once
/// Geometry of one simplex from its corners: volume, gradients of the barycentric coordinates, shape. No mesh, no
/// PETSc.
#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace talus {

/// `gradient[k]` belongs to corner k + 1; that of corner 0 is minus their sum [1/m]. `volume` is signed [m3], in 2D an
/// area [m2].
template <int dim>
struct Simplex {
  double volume;
  std::array<Vec<dim>, dim> gradient;

  explicit Simplex(const std::array<Vec<dim>, dim + 1> &corner) {
    Square<dim> edges;
    for (int k = 0; k < dim; ++k) edges.col(k) = map<dim>(corner[k + 1]) - map<dim>(corner[0]);
    volume = edges.determinant() / (dim == 2 ? 2 : 6);
    const Square<dim> inverse = edges.inverse();
    for (int k = 0; k < dim; ++k) map<dim>(gradient[k]) = inverse.row(k).transpose();
  }
};

template <int dim>
double longest_edge(const std::array<Vec<dim>, dim + 1> &corner) {
  double square = 0;
  for (int a = 0; a <= dim; ++a)
    for (int b = 0; b < a; ++b) square = std::max(square, (map<dim>(corner[a]) - map<dim>(corner[b])).squaredNorm());
  return std::sqrt(square);
}

/// Too flat to compute with: its volume is lost in the round-off of its edges.
template <int dim>
bool has_no_volume(const std::array<Vec<dim>, dim + 1> &corner, double volume) {
  return !(std::abs(volume) > 1e-10 * std::pow(longest_edge<dim>(corner), dim));
}

/// Smallest altitude [m], and inscribed over circumscribed radius times dim: 1 for a regular simplex, 0 for a flat one.
struct Shape {
  double altitude, quality;
};

/// Altitudes are 1 / |grad N|, the inscribed radius is 1 / sum |grad N|, and the circumscribed centre is
/// sum |edge_k|^2 grad N_k / 2 from corner 0.
template <int dim>
Shape shape(const std::array<Vec<dim>, dim + 1> &corner, const std::array<Vec<dim>, dim> &gradient) {
  ColumnVector<dim> first = ColumnVector<dim>::Zero(), centre = ColumnVector<dim>::Zero();
  double steepest = 0, sum = 0;
  const auto count = [&](double norm) { steepest = std::max(steepest, norm), sum += norm; };
  for (int k = 0; k < dim; ++k) {
    first -= map<dim>(gradient[k]);
    centre += (map<dim>(corner[k + 1]) - map<dim>(corner[0])).squaredNorm() / 2 * map<dim>(gradient[k]);
    count(map<dim>(gradient[k]).norm());
  }
  count(first.norm());
  return {1 / steepest, dim / (sum * centre.norm())};
}

}  // namespace talus
