#pragma once
/// Eigenvalues of a real matrix that need not be symmetric, by LAPACK. The solver of Eigen does the same, and takes the
/// compiler ten seconds wherever it is used.
#include <petscsys.h>  // which the next header needs
// clang-format off
#include <petscblaslapack.h>
// clang-format on

#include <Eigen/Core>
#include <stdexcept>

namespace talus {

/// Throws if there are none; a matrix that is not finite would otherwise make LAPACK end the program, with status 0.
inline Eigen::VectorXcd eigenvalues(Eigen::MatrixXd matrix) {
  if (!matrix.allFinite()) throw std::runtime_error("a matrix that is not finite has no eigenvalues");
  PetscBLASInt size = static_cast<PetscBLASInt>(matrix.rows()), work_size = 4 * size, one = 1, info = 0;
  Eigen::VectorXd real(size), imaginary(size), work(work_size);
  LAPACKgeev_("N", "N", &size, matrix.data(), &size, real.data(), imaginary.data(), nullptr, &one, nullptr, &one,
              work.data(), &work_size, &info);
  if (info) throw std::runtime_error("LAPACK finds no eigenvalues");
  Eigen::VectorXcd values(size);
  values.real() = real, values.imag() = imaginary;
  return values;
}

}  // namespace talus
