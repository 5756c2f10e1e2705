#pragma once
/// Stress as laws see it, and the increment of deformation of one cell. Stress is Cauchy, effective, positive in
/// tension [Pa]. Stored order of components: xx, yy, zz, xy in plane strain (dim = 2); xx, yy, zz, xy, yz, xz in 3D.
#include <array>
#include <cmath>

namespace talus {

template <int dim>
inline constexpr int stress_size = dim == 2 ? 4 : 6;

/// `Number` is double, or a Dual where derivatives are wanted.
template <int dim, class Number = double>
struct Stress;
template <class Number>
struct Stress<2, Number> {
  Number xx, yy, zz, xy;
};
template <class Number>
struct Stress<3, Number> {
  Number xx, yy, zz, xy, yz, xz;
};

template <int dim, class Number = double>
using Strain = Stress<dim, Number>;  ///< the same shape; tensor components, not engineering shear [-]

using std::sqrt;  // of doubles; a Dual brings its own

/// The value of a number, which is what history stores.
inline double value_of(double x) { return x; }

/// Mean stress and deviator s - p I, with q = sqrt(J2) its norm over sqrt(2) [Pa].
template <int dim, class Number = double>
struct Invariants {
  [[gnu::always_inline]] explicit Invariants(const Stress<dim, Number> &s)
      : p((s.xx + s.yy + s.zz) * (1. / 3)), deviator(s) {
    deviator.xx -= p, deviator.yy -= p, deviator.zz -= p;
    Number shear = deviator.xy * deviator.xy;
    if constexpr (dim == 3) shear += deviator.yz * deviator.yz + deviator.xz * deviator.xz;
    q = sqrt((deviator.xx * deviator.xx + deviator.yy * deviator.yy + deviator.zz * deviator.zz) / 2 + shear);
  }
  /// Takes a share of the deviator and `tension` of the mean stress off `s`, whose invariants these are.
  [[gnu::always_inline]] void take_off(Stress<dim, Number> &s, const Number &share, const Number &tension) const {
    s.xx -= share * deviator.xx + tension;
    s.yy -= share * deviator.yy + tension;
    s.zz -= share * deviator.zz + tension;
    s.xy -= share * deviator.xy;
    if constexpr (dim == 3) s.yz -= share * deviator.yz, s.xz -= share * deviator.xz;
  }

  Number p;
  Stress<dim, Number> deviator;
  Number q;
};

/// Deformation since the accepted state, one per cell that holds particles: dF = R U.
/// `strain` is ln U (tensor components, not engineering shear), its trace already replaced by the patch mean against
/// locking; it includes zz in plane strain. It acts before the rotation R: s = R (s_0 + C : ln U) R^T. `rotation` is
/// R: in 2D {cos, sin} of [cos -sin; sin cos], in 3D row-major.
template <int dim>
struct Increment {
  std::array<double, stress_size<dim>> strain;
  std::array<double, dim == 2 ? 2 : 9> rotation;
};

/// What a law may read at a point beside stress and history.
struct Surroundings {
  double size;           ///< element size h: sqrt(4 A / sqrt 3) of a triangle, (6 sqrt 2 V)^(1/3) of a tetrahedron [m],
                         ///< docs/theory (2.7)
  double suction = 0;    ///< s = P_g - P_l where positive, else 0 [Pa]
  double time_step = 0;  ///< over which the strain came about [s]; 0: at once, or no strain
  double cohesion = 1, friction = 1;  ///< share of the law's c and phi that the place has [-]
};

}  // namespace talus
