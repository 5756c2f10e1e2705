#pragma once
/// Examples of every law, and claims that run on all of them.
#include <gtest/gtest.h>

#include <string>

#include "fixtures.h"

namespace talus {

/// Typical and extreme parameters of a law.
template <class OneLaw>
std::vector<OneLaw> examples();

template <>
inline std::vector<LinearElastic> examples() {
  LinearElastic sand, clay;
  sand.young_modulus = 20e6, sand.poisson_ratio = 0.3;
  clay.young_modulus = 5e6, clay.poisson_ratio = 0.49;
  return {sand, clay};
}

template <>
inline std::vector<MohrCoulomb> examples() {
  MohrCoulomb tension = mohr_coulomb(10e3, 25, 5), softening = mohr_coulomb(20e3, 30, 10);
  tension.tension_cutoff = 2e3;
  softening.residual_cohesion = 1e3, softening.residual_friction_angle = 20 * degree.si;
  softening.shape_factor = 300, softening.reference_size = 0.5;
  MohrCoulomb wet = mohr_coulomb(2e3, 25, 5), wet_softening = softening;
  wet.suction_cohesion = 20e3, wet.suction_cohesion_rate = 1e-5, wet.suction_friction_rate = 1e-4 * degree.si;
  wet_softening.suction_cohesion = 20e3, wet_softening.suction_cohesion_rate = 1e-5;
  wet_softening.residual_dilation_angle = 0;
  MohrCoulomb both = softening;
  both.tension_cutoff = 5e3, both.residual_cohesion = 0;
  return {mohr_coulomb(0, 35),
          mohr_coulomb(0, 45, 45),
          mohr_coulomb(15e3, 0),
          mohr_coulomb(0, 0),
          tension,
          softening,
          both,
          wet,
          wet_softening};
}

template <>
inline std::vector<DruckerPrager> examples() {
  std::vector<DruckerPrager> laws;
  for (const Cone cone : {Cone::outer, Cone::inner, Cone::compromise, Cone::plane_strain})
    for (const double psi : {0., 15., 35.}) {
      DruckerPrager law;
      law.young_modulus = 20e6, law.poisson_ratio = 0.3, law.cone = cone;
      law.cohesion = psi * 200, law.friction_angle = 35 * degree.si, law.dilation_angle = psi * degree.si;
      laws.push_back(law);
    }
  laws.push_back(laws[0]);
  laws.back().friction_angle = 0;
  return laws;
}

/// The linear elasticity of docs/guide/umat, in C++.
template <>
inline std::vector<Umat> examples() { return {umat("linear_elastic", {20e6, 0.3})}; }

template <class Variant>
struct TypesOf;
template <class... OneLaw>
struct TypesOf<std::variant<OneLaw...>> {
  using type = ::testing::Types<OneLaw...>;
};

/// Runs a claim in both dimensions on all examples of the law.
template <class OneLaw, class Claim>
void for_all(Claim claim) {
  int number = 0;
  for (const OneLaw &law : examples<OneLaw>()) {
    SCOPED_TRACE(std::string(OneLaw::name) + " example " + std::to_string(number++));
    claim(Dim<2>(), Law(law));
    claim(Dim<3>(), Law(law));
  }
}

constexpr double scale = 1e5;  // [Pa], of the stresses of the claims

}  // namespace talus
