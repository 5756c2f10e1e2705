// The decomposition of an increment into rotation and logarithmic strain.
#include "physics/kinematics.h"

#include <gtest/gtest.h>

namespace talus {
namespace {

/// R and ln U by eigenvalues.
void exact(const Square<3> &g, Square<3> &rotation, Square<3> &strain) {
  const Square<3> f = Square<3>::Identity() + g;
  const Eigen::SelfAdjointEigenSolver<Square<3>> eigen(f.transpose() * f);
  const ColumnVector<3> stretch = eigen.eigenvalues().cwiseSqrt();
  const Square<3> axes = eigen.eigenvectors();
  strain = axes * stretch.array().log().matrix().asDiagonal() * axes.transpose();
  rotation = f * axes * stretch.cwiseInverse().asDiagonal() * axes.transpose();
}

TEST(Kinematics, errs_by_third_order_in_small_increments_of_stretch_and_rotation) {
  for (const double size : {9e-3, 3e-3, 1e-3})
    for (int sample = 0; sample < 20; ++sample) {
      Gradient<3> g;
      Square<3> rotation, strain;
      for (int i = 0; i < 9; ++i) g[i] = size * std::sin(1 + 7.3 * i + 31.7 * sample);
      const Square<3> matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(g.data());
      Increment<3> increment;
      ASSERT_TRUE(decompose<3>(g, increment));
      exact(matrix, rotation, strain);
      const auto &e = increment.strain;
      const double found[] = {e[0], e[1], e[2], e[3], e[4], e[5]};
      const double wanted[] = {strain(0, 0), strain(1, 1), strain(2, 2), strain(0, 1), strain(1, 2), strain(0, 2)};
      const double cube = std::pow(matrix.norm(), 3);
      for (int k = 0; k < 6; ++k) EXPECT_NEAR(found[k], wanted[k], cube) << "component " << k << " at " << size;
      for (int i = 0; i < 9; ++i) EXPECT_NEAR(increment.rotation[i], rotation(i / 3, i % 3), cube);
    }
}

}  // namespace
}  // namespace talus
