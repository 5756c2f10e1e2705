#pragma once
#include <numbers>

#include "base/units.h"
#include "earthquake/sources/sampled.h"
#include "scene/required.h"

namespace talus {

/// The wavelet of Ricker (1943), Geophysics 8, 341-369, eq. 11: (1 - 2 b) exp(-b), b = (pi f (t - t_0))^2.
struct RickerSource {
  static constexpr const char *name = "ricker";
  double amplitude = required;  ///< of the acceleration [m/s2]
  double frequency = required;  ///< at which its spectrum is largest [Hz]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("amplitude", amplitude, metre_per_second_squared, Range{1e-9, 50}, "largest acceleration");
    v.number("frequency", frequency, hertz, Range{1e-3, 100}, "frequency at which its spectrum is largest");
  }
  GroundMotion make() const {
    const double half = 1.5 / frequency;  // the rest is below 1e-8 of the amplitude
    return sampled(2 * half, frequency, [&](double t) {
      const double b = std::pow(std::numbers::pi * frequency * (t - half), 2);
      return amplitude * (1 - 2 * b) * std::exp(-b);
    });
  }
};

}  // namespace talus
