#pragma once
#include <algorithm>
#include <string>

#include "base/units.h"
#include "earthquake/ground_motion.h"
#include "scene/required.h"

namespace talus {

/// A synthetic earthquake: white noise through the ground filter of Kanai (1957) and Tajimi (1960), and through the
/// second filter of Clough & Penzien (1975, sec. 28-2) that takes out what would drift; its strength over time is that
/// of Jennings, Housner & Tsai (1968): t^2 in the rise, 1, and an exponential decay.
struct KanaiTajimiSource {
  static constexpr const char *name = "kanai_tajimi";
  double amplitude = required;    ///< to which the motion is scaled [m/s2]
  double duration = required;     ///< [s]
  double ground_frequency = 2.5;  ///< [Hz]
  double ground_damping = 0.6;    ///< [-]
  double rise = 0, strong = 0;    ///< durations of the rise and of the strong part; 0: they follow `duration` [s]
  int seed = 1;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("amplitude", amplitude, metre_per_second_squared, Range{1e-9, 50}, "largest acceleration");
    v.number("duration", duration, second, Range{1, 1e3}, "duration");
    v.number("ground_frequency", ground_frequency, hertz, Range{0.05, 25, {0.5, 10}}, "frequency of the ground");
    v.number("ground_damping", ground_damping, one, Range{0.05, 1, {0.2, 0.9}}, "damping ratio of the ground");
    v.number("rise", rise, second, Range{0, 1e3},
             "duration of the rise, in which the strength grows as t^2; 0: 2/15 of duration, at most 2 s");
    v.number("strong", strong, second, Range{0, 1e3},
             "duration of the strong part; then the strength decays; 0: 2/3 of duration, at most 10 s");
    v.integer("seed", seed, Range{0, 2147483647},
              "seed of the noise: the same one gives the same motion on any machine");
  }
  std::string problem() const { return strong_ends() > duration ? "rise and strong must not exceed duration" : ""; }
  double rise_ends() const { return rise > 0 ? rise : std::min(2., duration * 2 / 15); }
  double strong_ends() const { return rise_ends() + (strong > 0 ? strong : std::min(10., duration * 2 / 3)); }
  GroundMotion make() const;
};

}  // namespace talus
