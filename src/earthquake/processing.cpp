#include "earthquake/processing.h"

#include <Eigen/Dense>
#include <numbers>
#include <ranges>

namespace talus {

GroundMotion part_of(const GroundMotion &motion, double begin, double end) {
  const auto last = static_cast<long>(motion.acceleration.size()) - 1;
  const long from = std::clamp(std::lround(begin / motion.step), 0L, last),
             to = std::clamp(std::lround(end / motion.step), from, last);
  return {motion.step, {motion.acceleration.begin() + from, motion.acceleration.begin() + to + 1}};
}

void correct_baseline(GroundMotion &motion, int degree) {
  const std::vector<double> velocity = motion.velocity();
  const auto count = static_cast<Eigen::Index>(velocity.size());
  Eigen::MatrixXd powers(count, degree);  // of time over duration
  for (Eigen::Index k = 0; k < count; ++k)
    for (int i = 0; i < degree; ++i)
      powers(k, i) = std::pow(static_cast<double>(k) / static_cast<double>(count - 1), i + 1);
  const Eigen::VectorXd fit =
      powers.colPivHouseholderQr().solve(Eigen::Map<const Eigen::VectorXd>(velocity.data(), count));
  for (Eigen::Index k = 0; k < count; ++k)
    for (int i = 0; i < degree; ++i)
      motion.acceleration[k] -=
          fit[i] * (i + 1) / motion.duration() * std::pow(static_cast<double>(k) / static_cast<double>(count - 1), i);
}

namespace {

/// A section of the second order by the bilinear transform, applied along the values.
template <class Values>
void filter(Values &&values, double tangent) {
  const double norm = 1 / (1 + std::numbers::sqrt2 * tangent + tangent * tangent),
               a1 = 2 * (tangent * tangent - 1) * norm,
               a2 = (1 - std::numbers::sqrt2 * tangent + tangent * tangent) * norm;
  double first = 0, second = 0;  // transposed direct form
  for (double &x : values) {
    const double y = norm * x + first;
    first = -2 * norm * x - a1 * y + second, second = norm * x - a2 * y;
    x = y;
  }
}

}  // namespace

void high_pass(GroundMotion &motion, double corner) {
  constexpr double periods = 6;  // of zeros on each side: 1.5 times the order
  const auto pad = static_cast<std::size_t>(std::ceil(periods / corner / motion.step));
  std::vector<double> padded(motion.acceleration.size() + 2 * pad);
  std::ranges::copy(motion.acceleration, padded.begin() + static_cast<std::ptrdiff_t>(pad));
  // two passes have half of the power at a corner that is shifted by this factor
  const double shift = std::pow(std::numbers::sqrt2 - 1, -0.25);
  const double tangent = std::tan(std::numbers::pi * corner / shift * motion.step);
  filter(padded, tangent);
  filter(std::views::reverse(padded), tangent);
  std::copy_n(padded.begin() + static_cast<std::ptrdiff_t>(pad), motion.acceleration.size(),
              motion.acceleration.begin());
}

}  // namespace talus
