#pragma once
/// Measures of the strength of a motion.
#include <vector>

#include "earthquake/ground_motion.h"

namespace talus {

struct Intensity {
  double peak_acceleration = 0, peak_velocity = 0, peak_displacement = 0;  ///< [m/s2], [m/s], [m]
  double arias = 0;                                   ///< pi / 2g times the integral of a^2 (Arias 1970) [m/s]
  double significant_begin = 0, significant_end = 0;  ///< times of 5 and 95 % of it, whose difference is D5-95 [s]
  double cumulative_velocity = 0;                     ///< integral of |a| [m/s]
};

Intensity intensity_of(const GroundMotion &motion);
/// Arias intensity up to each value [m/s].
std::vector<double> arias_over_time(const GroundMotion &motion);

/// Pseudo-acceleration of an oscillator of this period and damping ratio: the square of its angular frequency times its
/// largest displacement relative to the ground [m/s2]; exact for acceleration that is linear between its values (Nigam
/// & Jennings 1969, BSSA 59, 909-922).
double spectral_acceleration(const GroundMotion &motion, double period, double damping = 0.05);
/// Periods at which spectra are given, evenly on a logarithmic scale from 0.02 to 10 s.
std::vector<double> spectral_periods();

}  // namespace talus
