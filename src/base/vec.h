#pragma once
/// Small fixed-size vectors and matrices of the kernel; Eigen does their algebra.
#include <Eigen/Dense>
#include <array>

namespace talus {

template <int dim>
using Vec = std::array<double, dim>;  ///< a point or vector as stored: plain, no alignment beyond double
template <int dim>
using Map = Eigen::Map<Eigen::Matrix<double, dim, 1>>;
template <int dim>
using ConstMap = Eigen::Map<const Eigen::Matrix<double, dim, 1>>;
template <int dim>
using ColumnVector = Eigen::Matrix<double, dim, 1>;
template <int dim>
using Square = Eigen::Matrix<double, dim, dim>;

template <int dim>
Map<dim> map(Vec<dim> &v) {
  return Map<dim>(v.data());
}
template <int dim>
ConstMap<dim> map(const Vec<dim> &v) {
  return ConstMap<dim>(v.data());
}

template <int dim>
double dot(const Vec<dim> &a, const Vec<dim> &b) {
  double sum = 0;
  for (int d = 0; d < dim; ++d) sum += a[d] * b[d];
  return sum;
}
/// a += scale * b
template <int dim>
void add_scaled(Vec<dim> &a, double scale, const Vec<dim> &b) {
  for (int d = 0; d < dim; ++d) a[d] += scale * b[d];
}

}  // namespace talus
