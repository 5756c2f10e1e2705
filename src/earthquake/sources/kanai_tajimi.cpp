#include "earthquake/sources/kanai_tajimi.h"

#include <numbers>
#include <random>

namespace talus {
namespace {

/// The oscillator x'' + 2 h w x' + w^2 x = input, by the implicit midpoint rule in parts of a step.
class Oscillator {
 public:
  Oscillator(double frequency, double damping, double step)
      : w_(2 * std::numbers::pi * frequency), h_(damping), step_(step) {}
  /// Takes a step from the input before to the input now.
  void go_on(double before, double now) {
    constexpr int parts = 8;
    const double dt = step_ / parts;
    for (int k = 0; k < parts; ++k) {
      const double middle = before + (now - before) * (k + 0.5) / parts;
      const double a = middle - 2 * h_ * w_ * v - w_ * w_ * x;
      const double dv = dt * (a - w_ * w_ * dt * v / 2) / (1 + h_ * w_ * dt + w_ * w_ * dt * dt / 4);
      x += dt * (v + dv / 2), v += dv;
    }
  }
  double x = 0, v = 0;

 private:
  double w_, h_, step_;
};

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
  Oscillator ground(ground_frequency, ground_damping, step), second(high_pass, 0.6, step);
  const double w = 2 * std::numbers::pi * ground_frequency;
  const auto strength = [&](double t) {
    if (t < rise) return std::pow(t / rise, 2);
    if (t < rise + strong) return 1.;
    return std::pow(decay_end, (t - rise - strong) / (duration - rise - strong));
  };
  double before = 0, shaken = 0;
  for (std::size_t k = 1; k <= steps; ++k) {
    const double now = strength(static_cast<double>(k) * step) * noise();
    ground.go_on(before, now), before = now;
    const double filtered = 2 * ground_damping * w * ground.v + w * w * ground.x;  // acceleration of the ground
    second.go_on(shaken, filtered), shaken = filtered;
    const double of_second = 2 * std::numbers::pi * high_pass;
    motion.acceleration[k] = filtered - 2 * 0.6 * of_second * second.v - of_second * of_second * second.x;
  }
  const double factor = amplitude / motion.peak();
  for (double &a : motion.acceleration) a *= factor;
  return motion;
}

}  // namespace talus
