#pragma once
/// Points under strain, and an independent look at their stress, for the claims of this folder.
#include <Eigen/Dense>
#include <random>
#include <vector>

#include "physics/laws/laws.h"
#include "physics/laws/update_stress.h"

namespace talus {

using Matrix = Eigen::Matrix3d;

template <int dim>
using Components = std::array<double, stress_size<dim>>;

template <int dim>
Matrix matrix(const Components<dim> &s) {
  Matrix m = Matrix::Zero();
  m.diagonal() << s[0], s[1], s[2];
  m(0, 1) = m(1, 0) = s[3];
  if constexpr (dim == 3) m(1, 2) = m(2, 1) = s[4], m(0, 2) = m(2, 0) = s[5];
  return m;
}
template <int dim>
Components<dim> components(const Matrix &m) {
  if constexpr (dim == 2)
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1)};
  else
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(0, 2)};
}

/// Principal values, greatest first.
inline std::array<double, 3> principal(const Matrix &m) {
  const Eigen::Vector3d rising = Eigen::SelfAdjointEigenSolver<Matrix>(m, Eigen::EigenvaluesOnly).eigenvalues();
  return {rising[2], rising[1], rising[0]};
}

/// C^-1 : s of isotropic elasticity.
inline Matrix elastic_strain(const Law &law, const Matrix &s) {
  const double p = s.trace() / 3;
  return (s - p * Matrix::Identity()) / (2 * shear_modulus(law)) + p / (3 * bulk_modulus(law)) * Matrix::Identity();
}

/// Points of one law, each in a cell of its own.
template <int dim>
struct Points {
  Points(const Law &l, int n, double size = 1)
      : law(l),
        stress(n),
        history(n * history_size(l)),
        increment(n),
        element_size(n, size),
        suction(n, 30e3),
        cell(n) {
    for (int i = 0; i < n; ++i) cell[i] = i, turn(i, Matrix::Identity());
  }
  void turn(int i, const Matrix &R) {
    if constexpr (dim == 2)
      increment[i].rotation = {R(0, 0), R(1, 0)};
    else
      increment[i].rotation = {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
  }
  StressPoints<dim> view() {
    return {.count = static_cast<int>(stress.size()),
            .stress_in = stress[0].data(),
            .history_in = history.data(),
            .stress_out = stress[0].data(),
            .history_out = history.data(),
            .cell = cell.data(),
            .increment = increment.data(),
            .size = element_size.data(),
            .suction = suction.data(),
            .time_step = 1e-3};
  }
  void update() { update_stress<dim>(law, view()); }
  void admit() {
    StressPoints<dim> at_rest = view();
    at_rest.time_step = 0;
    admit_stress<dim>(law, at_rest);
  }

  Law law;
  std::vector<Components<dim>> stress;
  std::vector<double> history;
  std::vector<Increment<dim>> increment;
  std::vector<double> element_size, suction;
  std::vector<int> cell;
};

class Random {
 public:
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  template <int dim>
  Components<dim> symmetric(double scale) {
    Components<dim> s;
    for (double &component : s) component = between(-scale, scale);
    return s;
  }
  /// In 2D about z.
  template <int dim>
  Matrix rotation() {
    if constexpr (dim == 2) return Eigen::AngleAxisd(between(-3, 3), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector4d q(between(-1, 1), between(-1, 1), between(-1, 1), between(-1, 1));
    return Eigen::Quaterniond(q / q.norm()).toRotationMatrix();
  }

 private:
  std::mt19937 generator_{20150518};
};

/// A number 2 or 3 as a type, for typed tests over dimensions.
template <int n>
using Dim = std::integral_constant<int, n>;
using Dims = ::testing::Types<Dim<2>, Dim<3>>;

inline MohrCoulomb mohr_coulomb(double cohesion, double phi_degrees, double psi_degrees = 0) {
  MohrCoulomb law;
  law.young_modulus = 20e6, law.poisson_ratio = 0.3;
  law.cohesion = cohesion, law.friction_angle = phi_degrees * degree.si, law.dilation_angle = psi_degrees * degree.si;
  return law;
}

/// A UMAT of tests/umat with E = PROPS(1) and nu = PROPS(2).
inline Umat umat(const std::string &library, const std::vector<double> &props,
                 const std::vector<std::string> &state = {}) {
  Umat law;
  law.young_modulus = props[0], law.poisson_ratio = props[1];
  law.library = std::string(UMATS) + "/umat_" + library + ".so", law.props = props, law.state = state;
  const std::string problem = law.problem();
  if (!problem.empty()) throw std::runtime_error(problem);
  return law;
}

}  // namespace talus
