#pragma once
/// Exponential and logarithm of symmetric tensors by products, sums and inverses alone: straight-line code for a loop
/// that vectorises. Those of tensors of Duals stand in principal_tangent.h.
#include "physics/laws/stress.h"

namespace talus {

/// a b of tensors with the same axes, which is symmetric.
template <int dim, class Number>
[[gnu::always_inline]] inline Strain<dim, Number> commuting_product(const Strain<dim, Number> &a,
                                                                    const Strain<dim, Number> &b) {
  if constexpr (dim == 2)
    return {a.xx * b.xx + a.xy * b.xy, a.xy * b.xy + a.yy * b.yy, a.zz * b.zz, a.xx * b.xy + a.xy * b.yy};
  else
    return {a.xx * b.xx + a.xy * b.xy + a.xz * b.xz, a.xy * b.xy + a.yy * b.yy + a.yz * b.yz,
            a.xz * b.xz + a.yz * b.yz + a.zz * b.zz, a.xx * b.xy + a.xy * b.yy + a.xz * b.yz,
            a.xy * b.xz + a.yy * b.yz + a.yz * b.zz, a.xx * b.xz + a.xy * b.yz + a.xz * b.zz};
}

/// share a + spherical I.
template <int dim, class Number>
[[gnu::always_inline]] inline Strain<dim, Number> affine(const Strain<dim, Number> &a, const Number &share,
                                                         const Number &spherical) {
  if constexpr (dim == 2)
    return {share * a.xx + spherical, share * a.yy + spherical, share * a.zz + spherical, share * a.xy};
  else
    return {share * a.xx + spherical,
            share * a.yy + spherical,
            share * a.zz + spherical,
            share * a.xy,
            share * a.yz,
            share * a.xz};
}

/// a + share b.
template <int dim, class Number>
[[gnu::always_inline]] inline Strain<dim, Number> sum(const Strain<dim, Number> &a, const Strain<dim, Number> &b,
                                                      double share) {
  if constexpr (dim == 2)
    return {a.xx + share * b.xx, a.yy + share * b.yy, a.zz + share * b.zz, a.xy + share * b.xy};
  else
    return {a.xx + share * b.xx, a.yy + share * b.yy, a.zz + share * b.zz,
            a.xy + share * b.xy, a.yz + share * b.yz, a.xz + share * b.xz};
}

/// u b u.
template <int dim, class Number>
[[gnu::always_inline]] inline Strain<dim, Number> sandwich(const Strain<dim, Number> &u, const Strain<dim, Number> &b) {
  if constexpr (dim == 2) {
    const Number xx = u.xx * b.xx + u.xy * b.xy, xy = u.xx * b.xy + u.xy * b.yy;
    const Number yx = u.xy * b.xx + u.yy * b.xy, yy = u.xy * b.xy + u.yy * b.yy;
    return {xx * u.xx + xy * u.xy, yx * u.xy + yy * u.yy, u.zz * b.zz * u.zz, xx * u.xy + xy * u.yy};
  } else {
    const Number xx = u.xx * b.xx + u.xy * b.xy + u.xz * b.xz, xy = u.xx * b.xy + u.xy * b.yy + u.xz * b.yz,
                 xz = u.xx * b.xz + u.xy * b.yz + u.xz * b.zz;
    const Number yx = u.xy * b.xx + u.yy * b.xy + u.yz * b.xz, yy = u.xy * b.xy + u.yy * b.yy + u.yz * b.yz,
                 yz = u.xy * b.xz + u.yy * b.yz + u.yz * b.zz;
    const Number zx = u.xz * b.xx + u.yz * b.xy + u.zz * b.xz, zy = u.xz * b.xy + u.yz * b.yy + u.zz * b.yz,
                 zz = u.xz * b.xz + u.yz * b.yz + u.zz * b.zz;
    return {xx * u.xx + xy * u.xy + xz * u.xz, yx * u.xy + yy * u.yy + yz * u.yz, zx * u.xz + zy * u.yz + zz * u.zz,
            xx * u.xy + xy * u.yy + xz * u.yz, yx * u.xz + yy * u.yz + yz * u.zz, xx * u.xz + xy * u.yz + xz * u.zz};
  }
}

template <int dim, class Number>
[[gnu::always_inline]] inline Strain<dim, Number> inverse(const Strain<dim, Number> &a) {
  if constexpr (dim == 2) {
    const Number over = 1 / (a.xx * a.yy - a.xy * a.xy);
    return {a.yy * over, a.xx * over, 1 / a.zz, -a.xy * over};
  } else {
    const Number xx = a.yy * a.zz - a.yz * a.yz, xy = a.xz * a.yz - a.xy * a.zz, xz = a.xy * a.yz - a.xz * a.yy;
    const Number over = 1 / (a.xx * xx + a.xy * xy + a.xz * xz);
    return {xx * over, (a.xx * a.zz - a.xz * a.xz) * over, (a.xx * a.yy - a.xy * a.xy) * over,
            xy * over, (a.xy * a.xz - a.xx * a.yz) * over, xz * over};
  }
}

/// e^a, to round-off for |a| < 2: (Taylor polynomial of degree 10 of a / 8)^8.
template <int dim, class Number>
[[gnu::always_inline]] inline Strain<dim, Number> exponential_of(const Strain<dim, Number> &a) {
  const Strain<dim, Number> x = affine<dim, Number>(a, 1. / 8, 0);
  Strain<dim, Number> r = affine<dim, Number>(x, 1. / 10, 1);
  const auto horner = [&](double over) __attribute__((always_inline)) {
    r = affine<dim, Number>(commuting_product<dim, Number>(x, r), over, 1);
  };
  horner(1. / 9), horner(1. / 8), horner(1. / 7), horner(1. / 6), horner(1. / 5), horner(1. / 4), horner(1. / 3),
      horner(1. / 2), horner(1);
  r = commuting_product<dim, Number>(r, r);
  r = commuting_product<dim, Number>(r, r);
  return commuting_product<dim, Number>(r, r);
}

/// ln b, to round-off where its principal values are within 1/4 and 4: Halley's method for e^x = b (cubic: Higham 2008,
/// Functions of Matrices, sec. 11.5), from 2 (b - 1) (b + 1)^-1.
template <int dim, class Number>
[[gnu::always_inline]] inline Strain<dim, Number> logarithm_of(const Strain<dim, Number> &b) {
  Strain<dim, Number> x = affine<dim, Number>(inverse<dim, Number>(affine<dim, Number>(b, 1, 1)), -4, 2);
  const auto halley = [&]() __attribute__((always_inline)) {
    const Strain<dim, Number> y = exponential_of<dim, Number>(x);
    x = sum<dim, Number>(
        x, commuting_product<dim, Number>(sum<dim, Number>(b, y, -1), inverse<dim, Number>(sum<dim, Number>(b, y, 1))),
        2);
  };
  halley(), halley(), halley();
  return x;
}

}  // namespace talus
