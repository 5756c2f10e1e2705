#include "earthquake/sources/kanai_tajimi.h"

#include <numbers>
#include <random>

#include "earthquake/oscillator.h"

namespace talus {
namespace {

/// Normal noise of variance 1 by Box & Muller (1958): libraries differ in theirs, and not in the numbers under it.
class Noise {
 public:
  explicit Noise(int seed) : bits_(static_cast<std::uint64_t>(seed)) {}
  double operator()() {
    const double r = std::sqrt(-2 * std::log(uniform())), angle = 2 * std::numbers::pi * uniform();
    return r * std::cos(angle);
  }

 private:
  double uniform() { return (static_cast<double>(bits_() >> 11) + 0.5) * 0x1p-53; }
  std::mt19937_64 bits_;
};

}  // namespace

GroundMotion KanaiTajimiSource::make() const {
  constexpr double step = 0.01, decay_end = 0.05;  // [s]; strength at the end
  const double high_pass = 0.1 * ground_frequency;
  const auto steps = static_cast<std::size_t>(std::lround(duration / step));
  GroundMotion motion{step, std::vector<double>(steps + 1)};
  Noise noise(seed);
  Oscillator ground(1 / ground_frequency, ground_damping, step), second(1 / high_pass, 0.6, step);
  const auto strength = [&](double t) {
    if (t < rise_ends()) return std::pow(t / rise_ends(), 2);
    if (t < strong_ends()) return 1.;
    return std::pow(decay_end, (t - strong_ends()) / (duration - strong_ends()));
  };
  double before = 0, shaken = 0;
  for (std::size_t k = 1; k <= steps; ++k) {
    const double now = strength(static_cast<double>(k) * step) * noise();
    ground.go_on(before, now), before = now;
    const double filtered = ground.acceleration();
    second.go_on(shaken, filtered), shaken = filtered;
    // relative to the second oscillator, which follows slow motion
    motion.acceleration[k] = filtered - second.acceleration();
  }
  const double factor = amplitude / motion.peak();
  for (double &a : motion.acceleration) a *= factor;
  return motion;
}

}  // namespace talus
