#pragma once
/// Rayleigh damping: forces alpha M v + beta K v, docs/theory/earthquakes.md section 9.
#include <array>

namespace talus {

struct Rayleigh {
  double mass = 0;       ///< alpha [1/s]
  double stiffness = 0;  ///< beta [s]
};

/// The two factors that give motion at both frequencies [Hz] this ratio of critical damping [-]; none where the upper
/// frequency is 0. Source: Chopra (2017), eq. (11.4.10).
inline Rayleigh rayleigh(double ratio, const std::array<double, 2> &frequencies) {
  constexpr double two_pi = 6.283185307179586;
  const double sum = frequencies[0] + frequencies[1];
  if (!(frequencies[1] > 0)) return {};
  return {2 * ratio * two_pi * frequencies[0] * frequencies[1] / sum, 2 * ratio / (two_pi * sum)};
}

}  // namespace talus
