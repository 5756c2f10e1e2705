#pragma once
/// Soils of random parameters, with what is extreme among them: phi from 0 to 45 degrees, c from 0, residual c from 0.
#include "examples.h"

namespace talus {

inline void draw_elasticity(IsotropicElastic &law, Random &random) {
  law.young_modulus = std::pow(10, random.between(5, 9)), law.poisson_ratio = random.between(0, 0.49);
}

/// Every sixth soil is without friction, every fifth without cohesion; half of them soften, every third of these to
/// none.
inline void draw_strength(FrictionalStrength &law, Random &random, int number) {
  const double phi = number % 6 == 0 ? 0 : random.between(0, 45);
  law.cohesion = number % 5 == 0 ? 0 : std::pow(10, random.between(0, 5));
  law.friction_angle = phi * degree.si,
  law.dilation_angle = (number % 4 == 0 ? phi : random.between(0, phi)) * degree.si;
  if (number % 2 == 0) return;
  if (number % 8 == 3) {
    law.residual_ratio = random.between(0, 1);
  } else {
    law.residual_cohesion = number % 3 == 0 ? 0 : random.between(0, 1) * law.cohesion;
    law.residual_friction_angle = (number % 7 == 0 ? 0 : random.between(0, 1)) * law.friction_angle;
  }
  law.residual_dilation_angle = random.between(0, 1) * law.dilation_angle;
  law.shape_factor = std::pow(10, random.between(0, 3));
  if (number % 9 == 0) law.reference_size = 0.2;
}

/// The soil with this number.
template <class OneLaw>
OneLaw drawn(Random &random, int number) {
  OneLaw law;
  draw_elasticity(law, random);
  if constexpr (requires { law.cohesion; }) draw_strength(law, random, number);
  if constexpr (requires { law.suction_cohesion; }) {
    if (number % 4 == 1) law.tension_cutoff = number % 8 == 1 ? 0 : std::pow(10, random.between(0, 4));
    if (number % 5 < 2) law.suction_cohesion = 20e3, law.suction_cohesion_rate = 1e-5;
    if (number % 5 == 1) law.suction_friction_rate = 1e-4 * degree.si;
  }
  if constexpr (requires { law.reference_strain; })
    law.reference_strain = std::pow(10, random.between(-4, -2)), law.curvature = random.between(0.8, 1);
  if constexpr (requires { law.cone; }) law.cone = static_cast<Cone>(random.between(0, 4));
  if constexpr (requires { law.viscosity; }) law.viscosity = std::pow(10, random.between(-3, 5));
  if constexpr (requires { law.yield_stress; })
    law.yield_stress = number % 5 == 0 ? 0 : std::pow(10, random.between(0, 5));
  if constexpr (requires { law.static_friction; }) {
    law.static_friction = number % 6 == 0 ? 0 : random.between(0, 1);
    law.limiting_friction = law.static_friction + (number % 4 == 0 ? 0 : random.between(0, 1));
    law.grain_size = std::pow(10, random.between(-4, -1));
  }
  return law;
}

template <>
inline HoekBrown drawn(Random &random, int number) {
  HoekBrown law;
  draw_elasticity(law, random);
  law.intact_strength = std::pow(10, random.between(5, 8)), law.geological_strength_index = random.between(5, 100);
  law.intact_constant = random.between(2, 35), law.disturbance_factor = number % 3 ? 0 : random.between(0, 1);
  law.dilation_angle = (number % 4 == 0 ? 90 : random.between(0, 40)) * degree.si;
  if (number % 5 == 0) law.tension_cutoff = number % 2 ? 0 : std::pow(10, random.between(2, 5));
  if (number % 2) law.reduce_strength(random.between(0.5, 3));
  return law;
}

template <>
inline CamClay drawn(Random &random, int number) {
  CamClay law;
  law.compression_slope = std::pow(10, random.between(-1.5, -0.3));
  law.swelling_slope = law.compression_slope * random.between(0.02, 0.6);
  law.critical_stress_ratio = random.between(0.4, 1.8),
  law.poisson_ratio = number % 5 == 0 ? 0 : random.between(0, 0.45);
  law.void_ratio = random.between(0.3, 3), law.preconsolidation_pressure = std::pow(10, random.between(4, 6));
  law.attraction = std::pow(10, random.between(1, 4));
  return law;
}

/// The library is what it is; its elasticity comes by its props.
template <>
inline Umat drawn(Random &random, int) {
  return umat("linear_elastic", {std::pow(10, random.between(5, 9)), random.between(0, 0.49)});
}

}  // namespace talus
