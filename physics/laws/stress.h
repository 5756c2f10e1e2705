#pragma once
/// Stress as laws see it, and the increment of deformation of one cell. Stress is Cauchy, effective, positive in
/// tension [Pa]. Stored order of components: xx, yy, zz, xy in plane strain (dim = 2); xx, yy, zz, xy, yz, xz in 3D.
#include <array>
#include <cmath>

namespace talus {

template <int dim>
inline constexpr int stress_size = dim == 2 ? 4 : 6;

template <int dim>
struct Stress;
template <>
struct Stress<2> {
  double xx, yy, zz, xy;
};
template <>
struct Stress<3> {
  double xx, yy, zz, xy, yz, xz;
};

template <int dim>
using Strain = Stress<dim>;  ///< the same shape; tensor components, not engineering shear [-]

/// Mean stress and deviator s - p I, with q = sqrt(J2) its norm over sqrt(2) [Pa].
template <int dim>
struct Invariants {
  [[gnu::always_inline]] explicit Invariants(const Stress<dim> &s) : p((s.xx + s.yy + s.zz) * (1. / 3)), deviator(s) {
    deviator.xx -= p, deviator.yy -= p, deviator.zz -= p;
    double shear = deviator.xy * deviator.xy;
    if constexpr (dim == 3) shear += deviator.yz * deviator.yz + deviator.xz * deviator.xz;
    q = std::sqrt((deviator.xx * deviator.xx + deviator.yy * deviator.yy + deviator.zz * deviator.zz) / 2 + shear);
  }
  double p;
  Stress<dim> deviator;
  double q;
};

/// Deformation since the accepted state, one per cell that holds particles: dF = R U.
/// `strain` is ln U (tensor components, not engineering shear), its trace already replaced by the patch mean against
/// locking; it includes zz in plane strain. It acts before R turns the point: s = R (s_0 + C : ln U) R^T. `rotation` is
/// R: in 2D {cos, sin} of [cos -sin; sin cos], in 3D row-major.
template <int dim>
struct Increment {
  std::array<double, stress_size<dim>> strain;
  std::array<double, dim == 2 ? 2 : 9> rotation;
};

/// What a law may know of the place beside stress and history.
struct Surroundings {
  double size;  ///< element size h: sqrt(4 A / sqrt 3) of a triangle, (6 sqrt 2 V)^(1/3) of a tetrahedron [m],
                ///< docs/theory (2.7)
};

}  // namespace talus
