#pragma once
/// Deformation of a cell between two accepted states: dF = I + grad u = R U, docs/theory (3.1)-(3.4).
#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "physics/laws/stress.h"

namespace talus {

/// Gradient of a displacement, row-major.
template <int dim>
using Gradient = std::array<double, dim * dim>;

/// Below this size of grad u the midpoint rule replaces the polar decomposition in 3D: its strain errs by less than
/// 1e-4 of itself. In the plane series replace the logarithms below a tenth of it.
inline constexpr double small_increment = 1e-2;

/// Rotation and logarithmic strain of dF = I + g for small increments, in straight-line code, so that a loop over cells
/// becomes vector code. Returns false where g is too large for it (or no number): then `increment` is not to be used.
template <int dim>
bool decompose_small(const Gradient<dim> &g, Increment<dim> &increment);

/// The same for increments of any size. Returns false for an inverted cell (det dF <= 0).
bool decompose_exactly(const Gradient<2> &g, Increment<2> &increment);
bool decompose_exactly(const Gradient<3> &g, Increment<3> &increment);

/// Exactly where the increment is not small.
template <int dim>
bool decompose(const Gradient<dim> &g, Increment<dim> &increment) {
  return decompose_small<dim>(g, increment) || decompose_exactly(g, increment);
}

/// ln(1 + x) by its series, for |x| < 1e-3.
[[gnu::always_inline]] inline double log1p_series(double x) {
  return x * (1 - x * (1. / 2 - x * (1. / 3 - x * (1. / 4 - x * (1. / 5)))));
}
/// exp(x), by its series where the library's function would cost more than the rest of a cell.
inline double exp_small(double x) {
  return std::abs(x) < 1e-3 ? 1 + x * (1 + x * (1. / 2 + x * (1. / 6 + x * (1. / 24 + x * (1. / 120))))) : std::exp(x);
}

/// In the plane the rotation of F is the angle of (F00 + F11, F10 - F01), and U = R^T F is symmetric. Differences are
/// taken of g, not of F, so that small increments lose no digits.
struct PlaneStretch {
  double volume;      ///< det F - 1
  double c, s;        ///< cos and sin of the rotation
  double m, d, o;     ///< U = m I + [d o; o -d], whose stretches are m + q and m - q
  double over_m, q2;  ///< 1 / m and q^2

  [[gnu::always_inline]] explicit PlaneStretch(const Gradient<2> &g) {
    const auto &[xx, xy, yx, yy] = g;
    volume = xx + yy + (xx * yy - xy * yx);
    const double a = 2 + xx + yy, b = yx - xy, r = std::sqrt(a * a + b * b);
    const double over_r = 1 / r;
    c = a * over_r, s = b * over_r, m = r / 2, over_m = 2 * over_r;
    d = (c * (xx - yy) + s * (yx + xy)) / 2, o = (c * (xy + yx) + s * (yy - xx)) / 2;
    q2 = d * d + o * o;
  }
  /// ln U = ln sqrt(det F) I + slope (U - m I), where `mean` is the first of these factors.
  [[gnu::always_inline]] Increment<2> increment(double mean, double slope) const {
    return {{mean + slope * d, mean - slope * d, 0, slope * o}, {c, s}};
  }
};

template <>
[[gnu::always_inline]] inline bool decompose_small<2>(const Gradient<2> &g, Increment<2> &out) {
  constexpr double small = small_increment / 10;
  const PlaneStretch stretch(g);
  const double ratio2 = stretch.q2 * stretch.over_m * stretch.over_m;
  out = stretch.increment(log1p_series(stretch.volume) / 2, (1 + ratio2 * (1. / 3)) * stretch.over_m);
  return (std::abs(stretch.volume) < small) & (ratio2 < small * small);
}

/// Midpoint rule (Hughes & Winget 1980), its strain turned back by half the rotation: exact for rigid rotation, errs by
/// third order in g.
template <>
[[gnu::always_inline]] inline bool decompose_small<3>(const Gradient<3> &g, Increment<3> &out) {
  // midpoint gradient h = g (I + g/2)^-1, strain sym h, rotation (I - w/2)^-1 (I + w/2) with w = skew h
  const double a = 1 + g[0] / 2, b = g[1] / 2, c = g[2] / 2, d = g[3] / 2, e = 1 + g[4] / 2, f = g[5] / 2, p = g[6] / 2,
               q = g[7] / 2, r = 1 + g[8] / 2;
  const double i00 = e * r - f * q, i01 = c * q - b * r, i02 = b * f - c * e;
  const double i10 = f * p - d * r, i11 = a * r - c * p, i12 = c * d - a * f;
  const double i20 = d * q - e * p, i21 = b * p - a * q, i22 = a * e - b * d;
  const double over_det = 1 / (a * i00 + b * i10 + c * i20);
  const double xx = (g[0] * i00 + g[1] * i10 + g[2] * i20) * over_det;
  const double hxy = (g[0] * i01 + g[1] * i11 + g[2] * i21) * over_det;
  const double hxz = (g[0] * i02 + g[1] * i12 + g[2] * i22) * over_det;
  const double hyx = (g[3] * i00 + g[4] * i10 + g[5] * i20) * over_det;
  const double yy = (g[3] * i01 + g[4] * i11 + g[5] * i21) * over_det;
  const double hyz = (g[3] * i02 + g[4] * i12 + g[5] * i22) * over_det;
  const double hzx = (g[6] * i00 + g[7] * i10 + g[8] * i20) * over_det;
  const double hzy = (g[6] * i01 + g[7] * i11 + g[8] * i21) * over_det;
  const double zz = (g[6] * i02 + g[7] * i12 + g[8] * i22) * over_det;
  const double wx = (hzy - hyz) / 2, wy = (hxz - hzx) / 2, wz = (hyx - hxy) / 2;
  const double xy = (hxy + hyx) / 2, yz = (hyz + hzy) / 2, xz = (hxz + hzx) / 2;
  // sym h = e is the strain half way through the rotation; e - (w e - e w) / 2 is that at its start, to which R applies
  out.strain = {xx + wz * xy - wy * xz,
                yy - wz * xy + wx * yz,
                zz + wy * xz - wx * yz,
                xy + (wz * (yy - xx) - wy * yz + wx * xz) / 2,
                yz + (wx * (zz - yy) - wz * xz + wy * xy) / 2,
                xz + (wy * (xx - zz) + wz * yz - wx * xy) / 2};
  const double ww = (wx * wx + wy * wy + wz * wz) / 4, k = 1 / (1 + ww), n = 1 - 2 * ww * k;  // Cayley transform
  out.rotation = {n + k * wx * wx / 2,    k * (wx * wy / 2 - wz), k * (wx * wz / 2 + wy),
                  k * (wx * wy / 2 + wz), n + k * wy * wy / 2,    k * (wy * wz / 2 - wx),
                  k * (wx * wz / 2 - wy), k * (wy * wz / 2 + wx), n + k * wz * wz / 2};
  double size = 0;
  for (int j = 0; j < 9; ++j) size = std::max(size, std::abs(g[j]));
  return size < small_increment;
}

template <int dim>
inline double trace(const Increment<dim> &increment) {
  return increment.strain[0] + increment.strain[1] + increment.strain[2];
}

}  // namespace talus
