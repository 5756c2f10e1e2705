#pragma once
/// Scales of a soil layer that say what a model of it needs: SI units, heights along gravity, M = K + 4/3 G of the soil
/// skeleton.
#include <cmath>

namespace talus::scales {

/// Time for a compression wave to cross the layer [s].
inline double transit(double height, double wave_speed) { return height / wave_speed; }

/// Time to fall by the layer's own height [s], and the speed then [m/s].
inline double fall_time(double height, double gravity) { return std::sqrt(2 * height / gravity); }
inline double fall_speed(double height, double gravity) { return std::sqrt(2 * height * gravity); }

/// Strain at the foot of a layer that cannot spread, under its own weight [-].
inline double own_weight_strain(double density, double gravity, double height, double modulus) {
  return density * gravity * height / modulus;
}
/// By how much such a layer sinks at its top [m].
inline double settlement(double density, double gravity, double height, double modulus) {
  return own_weight_strain(density, gravity, height, modulus) * height / 2;
}

/// The hydraulic conductivity [m/s] at which Terzaghi's T = c_v t / L^2, with c_v = k_h M / gamma_w, has this value:
/// pore pressure of a layer that drains over L is gone at T of about 1 and has not begun to go at 0.01. Terzaghi
/// (1943), Theoretical soil mechanics, ch. 13.
inline double conductivity_at(double factor, double modulus, double water_weight, double time, double length) {
  return factor * water_weight * length * length / (modulus * time);
}
inline constexpr double drained_factor = 10, undrained_factor = 0.01;

/// Time in which drag brings the pore water to the speed of Darcy's law, k_h / (n g) [s].
inline double drag_relaxation(double conductivity, double porosity, double gravity) {
  return conductivity / (porosity * gravity);
}

}  // namespace talus::scales
