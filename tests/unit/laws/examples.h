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
  for (const Cone cone : {Cone::outer, Cone::plane_strain}) {
    DruckerPrager softening = laws[1];
    softening.cone = cone, softening.residual_cohesion = 0, softening.residual_friction_angle = 20 * degree.si;
    softening.residual_dilation_angle = 0, softening.shape_factor = 200, softening.reference_size = 0.5;
    laws.push_back(softening);
  }
  return laws;
}

/// The weak rock of Hammah et al. (2005), without and with associated flow, with a cut-off, and a stronger rock.
template <>
inline std::vector<HoekBrown> examples() {
  HoekBrown weak;
  weak.young_modulus = 20e6, weak.poisson_ratio = 0.3;
  weak.intact_strength = 30e6, weak.geological_strength_index = 5, weak.intact_constant = 2;
  HoekBrown associated = weak, cut = weak, blasted = weak, divided = associated;
  associated.dilation_angle = 90 * degree.si;
  cut.dilation_angle = 20 * degree.si, cut.tension_cutoff = 0;
  blasted.intact_strength = 2e6, blasted.geological_strength_index = 40, blasted.intact_constant = 10;
  blasted.disturbance_factor = 1, blasted.dilation_angle = 5 * degree.si;
  divided.dilation_angle = 90 * degree.si, divided.reduce_strength(1.4);
  return {weak, associated, cut, blasted, divided};
}

/// The linear elasticity of docs/guide/umat, in C++.
template <>
inline std::vector<Umat> examples() {
  return {umat("linear_elastic", {20e6, 0.3})};
}

template <>
inline std::vector<CamClay> examples() {
  CamClay clay;
  clay.compression_slope = 0.2, clay.swelling_slope = 0.04, clay.critical_stress_ratio = 1, clay.poisson_ratio = 0.3;
  clay.void_ratio = 1, clay.preconsolidation_pressure = 100e3;
  CamClay stiff = clay;
  stiff.compression_slope = 0.1, stiff.swelling_slope = 0.01, stiff.critical_stress_ratio = 1.4,
  stiff.poisson_ratio = 0;
  stiff.preconsolidation_pressure = 400e3, stiff.void_ratio = 0.6, stiff.attraction = 10e3;
  return {clay, stiff};
}

template <>
inline std::vector<MuI> examples() {
  MuI sand;
  sand.young_modulus = 20e6, sand.poisson_ratio = 0.3;
  sand.static_friction = 0.38, sand.limiting_friction = 0.64, sand.grain_size = 1e-3;
  MuI coulomb = sand;
  coulomb.limiting_friction = coulomb.static_friction;
  return {sand, coulomb};
}

template <>
inline std::vector<Newtonian> examples() {
  Newtonian water, mud;
  water.young_modulus = 3e4, water.poisson_ratio = 0.49, water.viscosity = 1e-3;
  mud.young_modulus = 1e6, mud.poisson_ratio = 0.4, mud.viscosity = 1e3;
  return {water, mud};
}

template <>
inline std::vector<Bingham> examples() {
  Bingham mud;
  mud.young_modulus = 1e6, mud.poisson_ratio = 0.4, mud.viscosity = 50, mud.yield_stress = 200;
  Bingham stiff = mud;
  stiff.yield_stress = 50e3;
  return {mud, stiff};
}

template <class Large, class Small>
std::vector<Large> large(const std::vector<Small> &small) {
  std::vector<Large> laws;
  for (const Small &one : small) laws.push_back(Large{{{one}}});
  return laws;
}
template <>
inline std::vector<HenckyElastic> examples() {
  return large<HenckyElastic>(examples<LinearElastic>());
}
template <>
inline std::vector<HenckyMohrCoulomb> examples() {
  return large<HenckyMohrCoulomb>(examples<MohrCoulomb>());
}
template <>
inline std::vector<HenckyDruckerPrager> examples() {
  return large<HenckyDruckerPrager>(examples<DruckerPrager>());
}

template <>
inline std::vector<HystereticMohrCoulomb> examples() {
  std::vector<HystereticMohrCoulomb> laws;
  for (const MohrCoulomb &one : examples<MohrCoulomb>()) {
    HystereticMohrCoulomb law{{{one}, {}}};
    law.reference_strain = 1e-3;
    laws.push_back(law);
  }
  laws[0].curvature = 1;
  laws[1].reference_strain = 0, laws[1].plasticity_index = 30;
  return laws;
}

/// Is its stress linear in strain? Then compliance is a constant, and claims about energy have closed forms. Laws that
/// keep a volume are not.
template <class OneLaw>
constexpr bool linear_inside = [] {
  if constexpr (!std::is_same_v<OneLaw, Umat>)  // whose history is the user's
    for (const HistoryField &field : OneLaw::history)
      if (field.kept) return false;
  return true;
}();

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
