#pragma once
#include <numbers>
#include <string>

#include "base/units.h"
#include "earthquake/sources/sampled.h"
#include "scene/required.h"

namespace talus {

/// A sine whose frequency grows or falls linearly, or stays, with an amplitude that rises over the first and falls over
/// the last `taper` by half a wave of a cosine.
struct SineSource {
  static constexpr const char *name = "sine";
  double amplitude = required;  ///< of the acceleration [m/s2]
  double frequency = required;  ///< at the begin [Hz]
  double last_frequency = 0;    ///< at the end; 0: as at the begin [Hz]
  double duration = required;   ///< [s]
  double taper = 0;             ///< [s]
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("amplitude", amplitude, metre_per_second_squared, Range{1e-9, 50}, "largest acceleration");
    v.number("frequency", frequency, hertz, Range{1e-3, 100}, "frequency, of a sweep at its begin");
    v.number("last_frequency", last_frequency, hertz, Range{0, 100}, "sweep: frequency at its end; 0: no sweep");
    v.number("duration", duration, second, Range{1e-3, 1e4}, "duration");
    v.number("taper", taper, second, Range{0, 1e4},
             "time in which the amplitude rises at the begin, and falls at the end, by half a wave of a cosine");
  }
  std::string problem() const { return 2 * taper > duration ? "taper must not exceed half of duration" : ""; }
  GroundMotion make() const {
    const double rate = last_frequency > 0 ? (last_frequency - frequency) / duration : 0;
    return sampled(duration, std::max(frequency, last_frequency), [&](double t) {
      const double edge = std::min(t, duration - t);
      const double envelope = edge < taper ? (1 - std::cos(std::numbers::pi * edge / taper)) / 2 : 1;
      return amplitude * envelope * std::sin(2 * std::numbers::pi * (frequency + rate * t / 2) * t);
    });
  }
};

}  // namespace talus
