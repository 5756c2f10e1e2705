#include "physics/kinematics.h"

#include <Eigen/Eigenvalues>

namespace talus {

bool decompose_exactly(const Gradient<2> &g, Increment<2> &out) {
  const PlaneStretch stretch(g);
  if (!(stretch.volume > -1)) return false;
  const double q = std::sqrt(stretch.q2), ratio = q / stretch.m;
  const double slope = ratio < 1e-3 ? (1 + ratio * ratio / 3) / stretch.m : std::atanh(ratio) / q;
  out = stretch.increment(std::log1p(stretch.volume) / 2, slope);
  return true;
}

bool decompose_exactly(const Gradient<3> &g, Increment<3> &out) {
  const Square<3> f = Square<3>::Identity() + Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(g.data());
  if (!(f.determinant() > 0)) return false;
  const Eigen::SelfAdjointEigenSolver<Square<3>> eigen(f.transpose() * f);
  const ColumnVector<3> stretch = eigen.eigenvalues().cwiseSqrt();
  const Square<3> &axes = eigen.eigenvectors();
  const Square<3> log_u = axes * stretch.array().log().matrix().asDiagonal() * axes.transpose();
  const Square<3> r = f * axes * stretch.cwiseInverse().asDiagonal() * axes.transpose();
  out.strain = {log_u(0, 0), log_u(1, 1), log_u(2, 2), log_u(0, 1), log_u(1, 2), log_u(0, 2)};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.rotation[3 * i + j] = r(i, j);
  return true;
}

}  // namespace talus
