#pragma once
/// Principal stresses, and the stress that belongs to changed ones, without eigenvectors: a stress with the same axes
/// is a polynomial of the old stress, written with divided differences. Straight-line code that vectorises; to
/// round-off also where principal values are equal or nearly so. `correct` of an isotropic law needs no more.
#include "physics/laws/stress.h"

namespace talus {

/// s1 >= s2 >= s3 [Pa].
template <class Number = double>
struct Principal {
  Number s1, s2, s3;
};

/// Slope of the change between two principal values; isotropic returns only ever bring them closer: 0 <= slope <= 1.
/// The bounds keep the quotient of two round-off errors, at equal values, harmless.
[[gnu::always_inline]] inline double divided_difference(double change, double gap) {
  const double slope = change / (gap > 1e-200 ? gap : 1e-200), positive = slope > 0 ? slope : 0;
  return positive < 1 ? positive : 1;
}

/// Of a stress of doubles here, of Duals in principal_tangent.h.
template <int dim, class Number = double>
class PrincipalAxes;

/// In plane strain zz is principal and the other two are centre and radius of the circle in the plane.
template <>
class PrincipalAxes<2> {
 public:
  [[gnu::always_inline]] explicit PrincipalAxes(const Stress<2> &s)
      : half_((s.xx - s.yy) / 2), radius_(std::sqrt(half_ * half_ + s.xy * s.xy)), zz_(s.zz) {
    const double centre = (s.xx + s.yy) / 2, high = centre + radius_, low = centre - radius_;
    zz_first_ = zz_ > high, zz_last_ = zz_ < low;
    values_ = {zz_first_ ? zz_ : high, zz_first_ ? high : zz_last_ ? low : zz_, zz_last_ ? zz_ : low};
  }
  Principal<> values() const { return values_; }

  /// Takes `change`, given per principal value, off the stress.
  [[gnu::always_inline]] void subtract(const Principal<> &change, Stress<2> &s) const {
    const double high = zz_first_ ? change.s2 : change.s1, low = zz_last_ ? change.s2 : change.s3;
    const double mean = (high + low) / 2, slope = divided_difference((high - low) / 2, radius_);
    s.zz -= zz_first_ ? change.s1 : zz_last_ ? change.s3 : change.s2;
    s.xx -= mean + slope * half_;
    s.yy -= mean - slope * half_;
    s.xy -= slope * s.xy;
  }

 private:
  double half_, radius_, zz_;
  bool zz_first_, zz_last_;
  Principal<> values_;
};

/// The deviator over q = sqrt(J2 / 3), called x, has the principal values 2 cos(theta) and 2 cos(theta -+ 2 pi / 3)
/// with cos(3 theta) = J3 / (2 q^3). That cosine alone gives nearly equal values to half the digits only; sin(3 theta)
/// = |B| / sqrt(6) with B = x^2 - 2 I - cos(3 theta) x gives all of them: B is the part of x^2 normal to I and x, and
/// vanishes at equal values (the discriminant as a sum of squares: Harari & Albocher 2023, Int. J. Numer. Methods Eng.
/// 124).
template <>
class PrincipalAxes<3> {
 public:
  [[gnu::always_inline]] explicit PrincipalAxes(const Stress<3> &s) {
    const Invariants<3> stress(s);
    const double q = stress.q * 0.57735026918962576 + 1e-30, over_q = 1 / q;
    const double xx = stress.deviator.xx * over_q, yy = stress.deviator.yy * over_q, zz = stress.deviator.zz * over_q;
    const double xy = s.xy * over_q, yz = s.yz * over_q, xz = s.xz * over_q;
    const double half_J3 = (xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)) / 2;
    const double above = half_J3 > -1 ? half_J3 : -1, cos3 = above < 1 ? above : 1;
    const double Bxx = xx * xx + xy * xy + xz * xz - 2 - cos3 * xx, Bxy = xx * xy + xy * yy + xz * yz - cos3 * xy;
    const double Byy = xy * xy + yy * yy + yz * yz - 2 - cos3 * yy, Byz = xy * xz + yy * yz + yz * zz - cos3 * yz;
    const double Bzz = xz * xz + yz * yz + zz * zz - 2 - cos3 * zz, Bxz = xx * xz + xy * yz + xz * zz - cos3 * xz;
    const double B2 = Bxx * Bxx + Byy * Byy + Bzz * Bzz + 2 * (Bxy * Bxy + Byz * Byz + Bxz * Bxz);

    const bool mirrored =
        cos3 < 0;  // theta -> pi/3 - theta: the angle below is at most pi/6, where cos(3 theta) is well conditioned
    const double target = mirrored ? -cos3 : cos3;
    double c = -0.004035398717;  // cos(theta) to 5e-6, then one step of Halley's method to round-off
    c = c * target + 0.01751218858;
    c = c * target - 0.04592193313;
    c = c * target + 0.1664117218;
    c = c * target + 0.866030432;
    const double f = c * (4 * c * c - 3) - target, slope = 12 * c * c - 3;
    c -= f * slope / (slope * slope - 12 * c * f);
    const double sin_term =
        std::sqrt(B2 * 0.5) / (4 * c * c - 1);  // sqrt(3) sin(theta), from sin(3 theta) = sin(theta) (4 c^2 - 1)
    const double single = 2 * q * c, near = q * (sin_term - c), far = -q * (sin_term + c);
    e1_ = mirrored ? -far : single, e2_ = mirrored ? -near : near, e3_ = mirrored ? -single : far;
    deviator_ = stress.deviator;
    p_ = stress.p;
  }
  Principal<> values() const { return {p_ + e1_, p_ + e2_, p_ + e3_}; }

  /// Takes `change`, given per principal value, off the stress: change(x) = d1 + d12 (x - s1) + d123 (x - s1)(x - s2).
  [[gnu::always_inline]] void subtract(const Principal<> &change, Stress<3> &s) const {
    const double d12 = divided_difference(change.s1 - change.s2, e1_ - e2_);
    const double d23 = divided_difference(change.s2 - change.s3, e2_ - e3_);
    const double d123 = (d12 - d23) / (e1_ - e3_);
    const double xy = deviator_.xy, yz = deviator_.yz, xz = deviator_.xz;
    const double x1 = deviator_.xx - e1_, y1 = deviator_.yy - e1_, z1 = deviator_.zz - e1_;
    const double x2 = deviator_.xx - e2_, y2 = deviator_.yy - e2_, z2 = deviator_.zz - e2_;
    s.xx -= change.s1 + d12 * x1 + d123 * (x1 * x2 + xy * xy + xz * xz);
    s.yy -= change.s1 + d12 * y1 + d123 * (xy * xy + y1 * y2 + yz * yz);
    s.zz -= change.s1 + d12 * z1 + d123 * (xz * xz + yz * yz + z1 * z2);
    s.xy -= d12 * xy + d123 * (x1 * xy + xy * y2 + xz * yz);
    s.yz -= d12 * yz + d123 * (xy * xz + y1 * yz + yz * z2);
    s.xz -= d12 * xz + d123 * (x1 * xz + xy * yz + xz * z2);
  }

 private:
  double p_, e1_, e2_, e3_;
  Stress<3> deviator_;
};

}  // namespace talus
