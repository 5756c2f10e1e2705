#pragma once
/// Principal stresses of a stress of Duals, and the derivative of what becomes of it: that of an isotropic tensor
/// function (de Souza Neto, Peric & Owen 2008, app. A.3), by eigenvectors. Exact also where principal values are equal.
#include <utility>

#include "physics/laws/dual.h"
#include "physics/laws/principal.h"

namespace talus {

template <int dim, int n>
class PrincipalAxes<dim, Dual<n>> {
 public:
  using Value = Dual<3>;  ///< with its derivatives along the three principal values

  explicit PrincipalAxes(const Stress<dim, Dual<n>> &s) {
    Tensor m = tensor(s, [](const Dual<n> &x) { return x.value; });
    diagonalise(m);
    for (int i = 0; i < 3; ++i) value_[i] = m[i][i];
    for (const auto &[i, j] : {std::pair{0, 1}, {1, 2}, {0, 1}})  // greatest first
      if (value_[i] < value_[j]) std::swap(value_[i], value_[j]), std::swap(axis_[i], axis_[j]);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) transposed_[i][j] = axis_[j][i];
    for (int k = 0; k < n; ++k)
      along_[k] = product(product(axis_, tensor(s, [k](const Dual<n> &x) { return x.slope[k]; })), transposed_);
  }
  Principal<Value> values() const {
    Principal<Value> s{value_[0], value_[1], value_[2]};
    s.s1.slope[0] = s.s2.slope[1] = s.s3.slope[2] = 1;
    return s;
  }

  /// Takes `change`, given per principal value, off the stress. In the axes the derivative is diagonal in the principal
  /// values, and off the diagonal the divided difference of the change: of its slopes where two values are closer than
  /// 1e-6 of their size, where digits would cancel; there it errs by that gap times the curvature of the change.
  void subtract(const Principal<Value> &change, Stress<dim, Dual<n>> &s) const {
    const Value *const c[3] = {&change.s1, &change.s2, &change.s3};
    const double near = 1e-6 * (std::abs(value_[0]) + std::abs(value_[1]) + std::abs(value_[2]));
    Tensor taken{}, shear{};
    for (int i = 0; i < 3; ++i) {
      taken[i][i] = c[i]->value;
      for (int j = i + 1; j < 3; ++j) {
        const double gap = value_[i] - value_[j];
        shear[i][j] = shear[j][i] = gap > near
                                        ? (c[i]->value - c[j]->value) / gap
                                        : (c[i]->slope[i] - c[i]->slope[j] + c[j]->slope[j] - c[j]->slope[i]) / 2;
      }
    }
    take_off(taken, s, [](Dual<n> &x, double t) { x.value -= t; });
    for (int k = 0; k < n; ++k) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) taken[i][j] = shear[i][j] * along_[k][i][j];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) taken[i][i] += c[i]->slope[j] * along_[k][j][j];
      take_off(taken, s, [k](Dual<n> &x, double t) { x.slope[k] -= t; });
    }
  }

 private:
  using Tensor = std::array<std::array<double, 3>, 3>;

  template <class Of>
  static Tensor tensor(const Stress<dim, Dual<n>> &s, Of of) {
    if constexpr (dim == 2)
      return {{{of(s.xx), of(s.xy), 0}, {of(s.xy), of(s.yy), 0}, {0, 0, of(s.zz)}}};
    else
      return {{{of(s.xx), of(s.xy), of(s.xz)}, {of(s.xy), of(s.yy), of(s.yz)}, {of(s.xz), of(s.yz), of(s.zz)}}};
  }

  static Tensor product(const Tensor &a, const Tensor &b) {
    Tensor c{};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) c[i][j] += a[i][k] * b[k][j];
    return c;
  }

  /// Cyclic Jacobi rotations (Golub & Van Loan 2013, Matrix Computations, sec. 8.5), which converge with the cube of
  /// what is off the diagonal; rows of `axis_` become the axes.
  void diagonalise(Tensor &m) {
    const double nothing = 1e-20 * (std::abs(m[0][0]) + std::abs(m[1][1]) + std::abs(m[2][2]));
    for (int i = 0; i < 3; ++i) axis_[i][i] = 1;
    for (int sweep = 0; sweep < 12; ++sweep)
      for (const auto &[i, j] : {std::pair{0, 1}, {1, 2}, {0, 2}}) {
        if (std::abs(m[i][j]) <= nothing) continue;
        const double half = (m[j][j] - m[i][i]) / (2 * m[i][j]);
        const double t = (half < 0 ? -1 : 1) / (std::abs(half) + std::sqrt(half * half + 1));
        const double cosine = 1 / std::sqrt(t * t + 1), sine = t * cosine;
        const auto turn = [&](double &a, double &b) {
          const double old = a;
          a = cosine * a - sine * b, b = sine * old + cosine * b;
        };
        for (int k = 0; k < 3; ++k) turn(m[k][i], m[k][j]);
        for (int k = 0; k < 3; ++k) turn(m[i][k], m[j][k]), turn(axis_[i][k], axis_[j][k]);
        m[i][j] = m[j][i] = 0;
      }
  }

  /// `in_axes` as a tensor of space, taken off component by component.
  template <class Take>
  void take_off(const Tensor &in_axes, Stress<dim, Dual<n>> &s, Take take) const {
    const Tensor t = product(product(transposed_, in_axes), axis_);
    take(s.xx, t[0][0]), take(s.yy, t[1][1]), take(s.zz, t[2][2]), take(s.xy, t[0][1]);
    if constexpr (dim == 3) take(s.yz, t[1][2]), take(s.xz, t[0][2]);
  }

  std::array<double, 3> value_;  ///< greatest first [Pa]
  Tensor axis_{}, transposed_;   ///< row by row, and as columns
  std::array<Tensor, n> along_;  ///< derivatives of the stress, in its axes
};

/// Puts g(x) for the tensor x: `change` gives what its principal values lose, x - g(x).
template <int dim, int n, class Change>
void map_principal(Stress<dim, Dual<n>> &x, Change change) {
  const PrincipalAxes<dim, Dual<n>> axes(x);
  const auto [x1, x2, x3] = axes.values();
  axes.subtract({change(x1), change(x2), change(x3)}, x);
}

/// e^a and ln b of tensors of Duals. Around the identity, so that the differences in (T.1) keep their digits.
template <int dim, int n>
Strain<dim, Dual<n>> exponential_of(const Strain<dim, Dual<n>> &a) {
  Strain<dim, Dual<n>> x = a;
  map_principal(x, [](const Dual<3> &x) {
    const double rise = std::expm1(x.value);
    return Dual<3>::of(x, x.value - rise, -rise);
  });
  x.xx += 1, x.yy += 1, x.zz += 1;
  return x;
}
template <int dim, int n>
Strain<dim, Dual<n>> logarithm_of(const Strain<dim, Dual<n>> &b) {
  Strain<dim, Dual<n>> x = b;
  x.xx -= 1, x.yy -= 1, x.zz -= 1;
  map_principal(
      x, [](const Dual<3> &x) { return Dual<3>::of(x, x.value - std::log1p(x.value), x.value / (1 + x.value)); });
  return x;
}

}  // namespace talus
