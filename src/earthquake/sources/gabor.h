#pragma once
#include <numbers>

#include "base/units.h"
#include "earthquake/sources/sampled.h"
#include "scene/required.h"

namespace talus {

/// The wavelet of Gabor (1946), J. IEE 93, 429-457: exp(-(2 pi f (t - t_0) / gamma)^2) cos(2 pi f (t - t_0) + phase).
struct GaborSource {
  static constexpr const char *name = "gabor";
  double amplitude = required;  ///< of the acceleration [m/s2]
  double frequency = required;  ///< [Hz]
  double width = 4;             ///< gamma [-]
  double phase = 0;             ///< [rad]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("amplitude", amplitude, metre_per_second_squared, Range{1e-9, 50}, "largest acceleration");
    v.number("frequency", frequency, hertz, Range{1e-3, 100}, "frequency of the oscillation");
    v.number("width", width, one, Range{0.5, 100},
             "gamma, which widens the envelope; about 0.5 gamma cycles are large");
    v.number("phase", phase, degree, Range{-360, 360}, "phase of the oscillation in the middle of the envelope");
  }
  GroundMotion make() const {
    const double half = 0.75 * width / frequency;  // the rest is below 1e-9 of the amplitude
    return sampled(2 * half, frequency, [&](double t) {
      const double angle = 2 * std::numbers::pi * frequency * (t - half);
      return amplitude * std::exp(-std::pow(angle / width, 2)) * std::cos(angle + phase);
    });
  }
};

}  // namespace talus
