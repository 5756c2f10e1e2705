#pragma once
/// Lagrange elements of order 1 and 2 on simplices, in barycentric coordinates l_0 .. l_dim, and quadrature on them.
/// Nodes of an element: its vertices, then (order 2) the middles of its edges 01, 02, (03,) 12, (13, 23).
#include <array>
#include <cmath>
#include <vector>

#include "base/vec.h"
#include "meshes/simplex_edges.h"

namespace talus {

template <int dim>
using Barycentric = std::array<double, dim + 1>;

template <int dim>
constexpr int element_nodes(int order) {
  return order == 1 ? dim + 1 : (dim + 1) * (dim + 2) / 2;
}

/// Values of the shape functions at a place.
template <int dim>
void shape_functions(int order, const Barycentric<dim> &l, double *value) {
  for (int a = 0; a <= dim; ++a) value[a] = order == 1 ? l[a] : l[a] * (2 * l[a] - 1);
  if (order == 2)
    for (std::size_t e = 0; e < simplex_edges<dim>.size(); ++e) {
      const auto [a, b] = simplex_edges<dim>[e];
      value[dim + 1 + e] = 4 * l[a] * l[b];
    }
}

/// Their gradients, from those of the barycentric coordinates [1/m].
template <int dim>
void shape_gradients(int order, const Barycentric<dim> &l, const std::array<Vec<dim>, dim + 1> &of_l, Vec<dim> *value) {
  for (int d = 0; d < dim; ++d) {
    for (int a = 0; a <= dim; ++a) value[a][d] = (order == 1 ? 1 : 4 * l[a] - 1) * of_l[a][d];
    if (order == 2)
      for (std::size_t e = 0; e < simplex_edges<dim>.size(); ++e) {
        const auto [a, b] = simplex_edges<dim>[e];
        value[dim + 1 + e][d] = 4 * (l[a] * of_l[b][d] + l[b] * of_l[a][d]);
      }
  }
}

/// Points and weights; the weights add up to 1.
template <int dim>
struct Quadrature {
  std::vector<Barycentric<dim>> point;
  std::vector<double> weight;
};

/// Where stress and history live: one point in an element of order 1, the 3 (triangle) or 4 (tetrahedron) points of
/// degree 2 in one of order 2, at which its stiffness is exact on straight sides.
template <int dim>
Quadrature<dim> stress_quadrature(int order) {
  Quadrature<dim> rule;
  Barycentric<dim> l;
  if (order == 1) {
    l.fill(1. / (dim + 1));
    return {{l}, {1.}};
  }
  const double far = (1 - 1 / std::sqrt(dim + 2.)) / (dim + 1);  // 1/6, or (5 - sqrt 5) / 20
  for (int a = 0; a <= dim; ++a) {
    l.fill(far), l[a] = 1 - dim * far;
    rule.point.push_back(l), rule.weight.push_back(1. / (dim + 1));
  }
  return rule;
}

/// For loads that vary: the conical product of Gauss-Legendre rules with 4 points, of degree 8 - dim (Stroud 1971,
/// Approximate Calculation of Multiple Integrals, sec. 2.4).
template <int dim>
Quadrature<dim> load_quadrature() {
  constexpr double x[4]{-0.86113631159405258, -0.33998104358485626, 0.33998104358485626, 0.86113631159405258};
  constexpr double w[4]{0.34785484513745386, 0.65214515486254614, 0.65214515486254614, 0.34785484513745386};
  Quadrature<dim> rule;
  double volume = 1;
  for (int k = 2; k <= dim; ++k) volume *= k;
  int total = 1;
  for (int k = 0; k < dim; ++k) total *= 4;
  for (int i = 0; i < total; ++i) {
    Barycentric<dim> l;
    double left = 1, weight = volume;
    for (int k = 0, rest = i; k < dim; ++k, rest /= 4) {
      const double r = (1 + x[rest % 4]) / 2;
      weight *= w[rest % 4] / 2 * std::pow(1 - r, dim - 1 - k);
      l[k] = left * r, left *= 1 - r;
    }
    l[dim] = left;
    rule.point.push_back(l), rule.weight.push_back(weight);
  }
  return rule;
}

}  // namespace talus
