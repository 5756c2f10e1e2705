#include "solvers/critical_step.h"

#include <Eigen/Dense>

namespace talus {

template <int dim>
double cell_frequency_squared(const Cell<dim> &cell, const Law &law, double density, const PoreStiffness &pores) {
  constexpr int size = dim == 2 ? 3 : 6;
  // K = V B^T D B and lumped masses rho V / (dim + 1): omega^2 = (dim + 1) / rho times the largest eigenvalue of L^T (B
  // B^T) L, D = L L^T
  Eigen::Matrix<double, size, dim *(dim + 1)> b;
  b.setZero();
  for (int k = 0; k <= dim; ++k) {
    Vec<dim> g{};
    if (k)
      g = cell.gradient[k - 1];
    else
      for (const auto &other : cell.gradient)
        for (int d = 0; d < dim; ++d) g[d] -= other[d];
    for (int d = 0; d < dim; ++d) b(d, k * dim + d) = g[d];
    b(dim, k * dim) = g[1], b(dim, k * dim + 1) = g[0];
    if constexpr (dim == 3) {
      b(4, k * 3 + 1) = g[2], b(4, k * 3 + 2) = g[1];
      b(5, k * 3) = g[2], b(5, k * 3 + 2) = g[0];
    }
  }
  const double shear = shear_modulus(law), lame = bulk_modulus(law) - 2 * shear / 3;
  Eigen::Matrix<double, size, size> stiffness = Eigen::Matrix<double, size, size>::Zero();
  for (int i = 0; i < size; ++i) stiffness(i, i) = i < dim ? 2 * shear : shear;
  stiffness.template topLeftCorner<dim, dim>().array() += lame;
  if (pores.fluids.empty()) {
    const Eigen::Matrix<double, size, size> l = stiffness.llt().matrixL();
    const Eigen::Matrix<double, size, size> product = l.transpose() * (b * b.transpose()) * l;
    return (dim + 1) / density *
           Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, size, size>>(product, Eigen::EigenvaluesOnly)
               .eigenvalues()[size - 1];
  }
  // one more strain per fluid, (1 - n) div v_s + n div v_a, of stiffness K_a / n; docs/theory/pores.md (6.1)
  const int count = static_cast<int>(pores.fluids.size());
  const double n = pores.porosity, gradients = b.template topRows<dim>().squaredNorm();
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, size + 2,
                             dim *(dim + 1)>;  // no memory from the heap: cells come as the soil moves
  using Strains = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, size + 2, size + 2>;
  Rows rows(size + count, b.cols());
  Strains all = Strains::Zero(size + count, size + count);
  rows.topRows(size) = b;
  all.topLeftCorner(size, size) = stiffness;
  for (int a = 0; a < count; ++a)
    rows.row(size + a) = (1 - n) * b.template topRows<dim>().colwise().sum(),
                    all(size + a, size + a) = pores.fluids[a].bulk_modulus / n;
  Strains flexible = rows * rows.transpose() / density;
  for (int a = 0; a < count; ++a) flexible(size + a, size + a) += n * gradients / pores.fluids[a].density;
  const Strains l = all.llt().matrixL(), product = l.transpose() * flexible * l;
  return (dim + 1) * Eigen::SelfAdjointEigenSolver<Strains>(product, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

template double cell_frequency_squared(const Cell<2> &, const Law &, double, const PoreStiffness &);
template double cell_frequency_squared(const Cell<3> &, const Law &, double, const PoreStiffness &);

}  // namespace talus
