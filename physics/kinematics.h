#pragma once
/// Deformation of a cell between two accepted states: dF = I + grad u = R U, docs/theory (3.1)-(3.4).
#include <cmath>

#include "base/vec.h"
#include "physics/laws/stress.h"

namespace talus {

/// Below this size of grad u the midpoint rule replaces the polar decomposition in 3D: its strain errs by less than
/// 1e-4 of itself.
inline constexpr double small_increment = 1e-2;

/// Rotation and logarithmic strain of dF = I + g. The midpoint rule (Hughes & Winget 1980), its strain turned back by
/// half the rotation, is exact for rigid rotation and errs by third order in g; larger increments are decomposed
/// exactly. Returns false for an inverted cell (det dF <= 0).
template <int dim>
bool decompose(const Square<dim> &g, Increment<dim> &increment);

/// The same in 3D by the polar decomposition, for increments of any size.
bool decompose_exactly(const Square<3> &g, Increment<3> &increment);

/// ln(1 + x), by its series where the library's function would cost more than the rest of a cell.
inline double log1p_small(double x) {
  return std::abs(x) < 1e-3 ? x * (1 - x * (1. / 2 - x * (1. / 3 - x * (1. / 4 - x / 5)))) : std::log1p(x);
}
/// exp(x), likewise.
inline double exp_small(double x) {
  return std::abs(x) < 1e-3 ? 1 + x * (1 + x * (1. / 2 + x * (1. / 6 + x * (1. / 24 + x / 120)))) : std::exp(x);
}

template <>
inline bool decompose<2>(const Square<2> &g, Increment<2> &out) {
  // In the plane the rotation of F is the angle of (F00 + F11, F10 - F01), and U = R^T F is symmetric. Differences are
  // taken of g, not of F, so that small increments lose no digits.
  const double volume = g(0, 0) + g(1, 1) + (g(0, 0) * g(1, 1) - g(0, 1) * g(1, 0));  // det F - 1
  if (!(volume > -1)) return false;
  const double a = 2 + g(0, 0) + g(1, 1), b = g(1, 0) - g(0, 1), r = std::sqrt(a * a + b * b), c = a / r, s = b / r;
  const double m = r / 2, d = (c * (g(0, 0) - g(1, 1)) + s * (g(1, 0) + g(0, 1))) / 2;
  const double o = (c * (g(0, 1) + g(1, 0)) + s * (g(1, 1) - g(0, 0))) / 2, q = std::sqrt(d * d + o * o), ratio = q / m;
  // ln U = ln sqrt(det F) I + slope (U - m I): the stretches are m + q and m - q
  const double mean = log1p_small(volume) / 2;
  const double slope = ratio < 1e-3 ? (1 + ratio * ratio / 3) / m : std::atanh(ratio) / q;  // series where q vanishes
  out.strain = {mean + slope * d, mean - slope * d, 0, slope * o};
  out.rotation = {c, s};
  return true;
}

template <>
inline bool decompose<3>(const Square<3> &g, Increment<3> &out) {
  double size = 0;
  for (int i = 0; i < 9; ++i) size = std::max(size, std::abs(g.data()[i]));
  if (size < small_increment) {
    // midpoint gradient h = g (I + g/2)^-1, strain sym h, rotation (I - w/2)^-1 (I + w/2) with w = skew h
    Square<3> half = g / 2, inverse;
    half.diagonal().array() += 1;
    const auto minor = [&](int a, int b, int c, int d) { return half(a, b) * half(c, d) - half(a, d) * half(c, b); };
    inverse << minor(1, 1, 2, 2), -minor(0, 1, 2, 2), minor(0, 1, 1, 2),  //
        -minor(1, 0, 2, 2), minor(0, 0, 2, 2), -minor(0, 0, 1, 2),        //
        minor(1, 0, 2, 1), -minor(0, 0, 2, 1), minor(0, 0, 1, 1);
    const double det = half(0, 0) * inverse(0, 0) + half(0, 1) * inverse(1, 0) + half(0, 2) * inverse(2, 0);
    const Square<3> h = g.lazyProduct(inverse) / det;
    const double wx = (h(2, 1) - h(1, 2)) / 2, wy = (h(0, 2) - h(2, 0)) / 2, wz = (h(1, 0) - h(0, 1)) / 2;
    const double xx = h(0, 0), yy = h(1, 1), zz = h(2, 2), xy = (h(0, 1) + h(1, 0)) / 2, yz = (h(1, 2) + h(2, 1)) / 2,
                 xz = (h(0, 2) + h(2, 0)) / 2;
    // sym h = e is the strain half way through the rotation; e - (w e - e w) / 2 is that at its start, to which R
    // applies
    out.strain = {xx + wz * xy - wy * xz,
                  yy - wz * xy + wx * yz,
                  zz + wy * xz - wx * yz,
                  xy + (wz * (yy - xx) - wy * yz + wx * xz) / 2,
                  yz + (wx * (zz - yy) - wz * xz + wy * xy) / 2,
                  xz + (wy * (xx - zz) + wz * yz - wx * xy) / 2};
    const double ww = (wx * wx + wy * wy + wz * wz) / 4, k = 1 / (1 + ww), e = 1 - 2 * ww * k;  // Cayley transform
    out.rotation = {e + k * wx * wx / 2,    k * (wx * wy / 2 - wz), k * (wx * wz / 2 + wy),
                    k * (wx * wy / 2 + wz), e + k * wy * wy / 2,    k * (wy * wz / 2 - wx),
                    k * (wx * wz / 2 - wy), k * (wy * wz / 2 + wx), e + k * wz * wz / 2};
    return true;
  }
  return decompose_exactly(g, out);
}

template <int dim>
inline double trace(const Increment<dim> &increment) {
  return increment.strain[0] + increment.strain[1] + increment.strain[2];
}

}  // namespace talus
