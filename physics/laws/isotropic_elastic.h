#pragma once
/// Linear isotropic elasticity, which every law has within its yield surface unless it brings its own.
#include "physics/laws/stress.h"
#include "scene/required.h"

namespace talus {

/// Hypoelastic in Cauchy stress and logarithmic strain of one increment, docs/theory section 2.
struct IsotropicElastic {
  double young_modulus = required;  ///< E [Pa]
  double poisson_ratio = required;  ///< nu [-]

  double bulk_modulus() const { return young_modulus / (3 * (1 - 2 * poisson_ratio)); }  ///< K [Pa]
  double shear_modulus() const { return young_modulus / (2 * (1 + poisson_ratio)); }     ///< G [Pa]

  template <class Visitor>
  void fields(Visitor &&v) {
    v.elasticity(young_modulus, poisson_ratio);
  }

  // A law that differs hides these.
  static constexpr bool by_place = false, rate_dependent = false;
  bool reads_suction() const { return false; }
  bool strength_varies() const { return false; }

  double K = 0, G = 0, lambda = 0;  ///< [Pa], set by prepare()
  void prepare() { K = bulk_modulus(), G = shear_modulus(), lambda = K - 2 * G / 3; }

  /// Adds the stress of an elastic strain increment. A law with an elasticity of its own hides this function.
  template <int dim, class Number>
  [[gnu::always_inline]] void trial(Stress<dim, Number> &s, const Strain<dim, Number> &e, const Surroundings &) const {
    const Number spherical = lambda * (e.xx + e.yy + e.zz);
    const double twice_G = 2 * G;
    s.xx += spherical + twice_G * e.xx;
    s.yy += spherical + twice_G * e.yy;
    s.zz += spherical + twice_G * e.zz;
    s.xy += twice_G * e.xy;
    if constexpr (dim == 3) s.yz += twice_G * e.yz, s.xz += twice_G * e.xz;
  }

  /// Elastic energy per volume [J/m3].
  template <int dim>
  double elastic_energy(const Stress<dim> &s) const {
    const Invariants<dim> stress(s);
    return stress.p * stress.p / (2 * bulk_modulus()) + stress.q * stress.q / (2 * shear_modulus());
  }
};

}  // namespace talus
