#pragma once
/// exp(A) of a square matrix by its series, of A / 2^k that is small, and k squares. Eigen's own takes the compiler ten
/// seconds.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace talus {

template <class Matrix>
Matrix exponential(Matrix a) {
  const int squares = std::max(0, std::ilogb(a.norm()) + 2);  // the norm is below 1/2 then
  a /= std::ldexp(1., squares);
  Matrix power = Matrix::Identity(a.rows(), a.cols()), sum = power;
  for (int k = 1; k < 18; ++k) power = power * a / k, sum += power;
  for (int k = 0; k < squares; ++k) sum = sum * sum;
  return sum;
}

}  // namespace talus
