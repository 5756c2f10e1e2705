#include "solvers/critical_step.h"

#include <petscblaslapack.h>
#include <petscsys.h>

#include <algorithm>

namespace talus {

template <int dim>
double cell_frequency_squared(const Cell<dim> &cell, const Law &law, double density, const PoreStiffness &pores) {
  constexpr int size = dim == 2 ? 3 : 6, most = size + 2;  // strains of the skeleton, and one per fluid
  constexpr int columns = dim * (dim + 1);
  const int fluids = static_cast<int>(
      std::ranges::count_if(pores.fluids, [](const PoreStiffness::Fluid &one) { return one.bulk_modulus > 0; }));
  const PetscBLASInt rows = size + fluids;
  double b[most][columns]{};
  double gradients = 0;
  for (int k = 0; k <= dim; ++k) {
    Vec<dim> g{};
    if (k)
      g = cell.gradient[k - 1];
    else
      for (const auto &other : cell.gradient)
        for (int d = 0; d < dim; ++d) g[d] -= other[d];
    for (int d = 0; d < dim; ++d) b[d][k * dim + d] = g[d], gradients += g[d] * g[d];
    b[dim][k * dim] = g[1], b[dim][k * dim + 1] = g[0];
    if constexpr (dim == 3) {
      b[4][k * 3 + 1] = g[2], b[4][k * 3 + 2] = g[1];
      b[5][k * 3] = g[2], b[5][k * 3 + 2] = g[0];
    }
  }
  const double shear = shear_modulus(law), lame = bulk_modulus(law) - 2 * shear / 3, n = pores.porosity;
  double stiffness[most * most]{}, compliance[most * most]{};  // [rows][rows]
  for (int i = 0; i < size; ++i) stiffness[i * rows + i] = i < dim ? 2 * shear : shear;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) stiffness[i * rows + j] += lame;
  // A fluid adds the strain (1 - n) div v_s + n div v_a of stiffness K_a / n; docs/theory/pores.md (6.1).
  for (int a = 0; a < fluids; ++a) {
    for (int j = 0; j < columns; ++j)
      for (int d = 0; d < dim; ++d) b[size + a][j] += (1 - n) * b[d][j];
    stiffness[(size + a) * rows + size + a] = pores.fluids[a].bulk_modulus / n;
  }
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j)
      for (int k = 0; k < columns; ++k) compliance[i * rows + j] += b[i][k] * b[j][k] / density;
  for (int a = 0; a < fluids; ++a) compliance[(size + a) * rows + size + a] += n * gradients / pores.fluids[a].density;
  // K = V B^T D B and lumped masses rho V / (dim + 1): omega^2 = (dim + 1) times the largest x of (B B^T / rho) D y = x
  // y
  const PetscBLASInt product = 2, room = 4 * most;
  PetscBLASInt info = 0;
  double value[most], work[4 * most];
  LAPACKsygv_(&product, "N", "U", &rows, compliance, &rows, stiffness, &rows, value, work, &room, &info);
  if (info != 0) return std::numeric_limits<double>::quiet_NaN();  // moduli that are not positive
  return (dim + 1) * value[rows - 1];
}

template double cell_frequency_squared(const Cell<2> &, const Law &, double, const PoreStiffness &);
template double cell_frequency_squared(const Cell<3> &, const Law &, double, const PoreStiffness &);

}  // namespace talus
