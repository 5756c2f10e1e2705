#include "earthquake/intensity.h"

#include <numbers>

#include "earthquake/oscillator.h"

namespace talus {
namespace {

constexpr double gravity = 9.80665;  // [m/s2]

double largest(const std::vector<double> &values) {
  double most = 0;
  for (const double one : values) most = std::max(most, std::abs(one));
  return most;
}

/// Integral of |a| over a step in which it is linear.
double area(double a, double b, double step) {
  return a * b >= 0 ? step * std::abs(a + b) / 2 : step * (a * a + b * b) / (2 * std::abs(a - b));
}

}  // namespace

std::vector<double> arias_over_time(const GroundMotion &motion) {
  const std::vector<double> &a = motion.acceleration;
  std::vector<double> arias(a.size());
  for (std::size_t k = 1; k < a.size(); ++k)
    arias[k] = arias[k - 1] + std::numbers::pi / (2 * gravity) * motion.step *
                                  (a[k - 1] * a[k - 1] + a[k - 1] * a[k] + a[k] * a[k]) / 3;
  return arias;
}

Intensity intensity_of(const GroundMotion &motion) {
  Intensity found;
  found.peak_acceleration = motion.peak();
  found.peak_velocity = largest(motion.velocity()), found.peak_displacement = largest(motion.displacement());
  const std::vector<double> arias = arias_over_time(motion);
  found.arias = arias.back();
  const auto time_of = [&](double share) {
    const auto k = std::ranges::lower_bound(arias, share * arias.back()) - arias.begin();
    return k == 0
               ? 0
               : motion.step * (static_cast<double>(k) - (arias[k] - share * arias.back()) / (arias[k] - arias[k - 1]));
  };
  found.significant_begin = time_of(0.05), found.significant_end = time_of(0.95);
  for (std::size_t k = 1; k < motion.acceleration.size(); ++k)
    found.cumulative_velocity += area(motion.acceleration[k - 1], motion.acceleration[k], motion.step);
  return found;
}

double spectral_acceleration(const GroundMotion &motion, double period, double damping) {
  Oscillator oscillator(period, damping, motion.step);
  const std::size_t count = motion.acceleration.size(), after = static_cast<std::size_t>(period / motion.step) + 1;
  const auto a = [&](std::size_t k) { return k < count ? motion.acceleration[k] : 0.; };
  double most = 0;
  for (std::size_t k = 0; k + 1 < count + after; ++k) {
    oscillator.go_on(a(k), a(k + 1));
    most = std::max(most, std::abs(oscillator.displacement()));
  }
  return std::pow(2 * std::numbers::pi / period, 2) * most;
}

std::vector<double> spectral_periods() {
  constexpr int count = 109;  // 40 a decade
  std::vector<double> periods;
  for (int k = 0; k < count; ++k) periods.push_back(0.02 * std::pow(10, k / 40.));
  return periods;
}

}  // namespace talus
