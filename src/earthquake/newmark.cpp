#include "earthquake/newmark.h"

namespace talus {
namespace {

constexpr double gravity = 9.80665;  // [m/s2]
constexpr double ln10 = 2.302585092994046;

/// The first root of a + b t + c t^2 in (0, end], or -1. Roots at 0 do not count.
double first_root(double a, double b, double c, double end) {
  double root = -1;
  const auto take = [&](double t) {
    if (t > 1e-12 * end && t <= end && (root < 0 || t < root)) root = t;
  };
  if (c == 0) {
    if (b != 0) take(-a / b);
    return root;
  }
  const double d = b * b - 4 * a * c;
  if (d < 0) return -1;
  const double q = -(b + std::copysign(std::sqrt(d), b)) / 2;
  take(q / c);
  if (q != 0) take(a / q);
  return root;
}

}  // namespace

std::vector<double> sliding_block(const GroundMotion &motion, double yield, double uphill) {
  constexpr double round_off = 1e-9;  // of accelerations
  const std::vector<double> &a = motion.acceleration;
  std::vector<double> way{0};
  double v = 0, x = 0;  // of the block against the ground, positive downhill
  int slips = 0;        // 1: downhill, -1: uphill
  for (std::size_t k = 0; k + 1 < a.size() || slips != 0; ++k) {
    const bool shakes = k + 1 < a.size();
    const double first = shakes ? a[k] : 0, rate = shakes ? (a[k + 1] - a[k]) / motion.step : 0;
    double t = 0;
    while (t < motion.step) {
      const double now = first + rate * t, left = motion.step - t;
      if (slips == 0) {
        const double over = now / yield - 1, over_uphill = uphill > 0 ? -now / uphill - 1 : -1;
        if (over > round_off || (over > -round_off && rate > 0))
          slips = 1;
        else if (over_uphill > round_off || (over_uphill > -round_off && rate < 0))
          slips = -1;
      }
      if (slips == 0) {  // until the ground passes one of the accelerations
        const double up = rate > 0 ? (yield - now) / rate : -1,
                     down = uphill > 0 && rate < 0 ? (-uphill - now) / rate : -1;
        const double next = up > 0 ? up : down;
        if (!(next > 0 && next < left)) break;
        t += next, slips = up > 0 ? 1 : -1;
        continue;
      }
      const double excess = slips > 0 ? now - yield : now + uphill;  // acceleration of the block against the ground
      if (slips * excess < 0 && slips * rate <= 0 &&
          std::abs(v) <= 1e-12 * motion.step * std::abs(excess)) {  // it hardly began
        v = 0, slips = 0;
        continue;
      }
      const double stops = first_root(v, excess, rate / 2, left), dt = stops > 0 ? stops : left;
      x += dt * (v + dt * (excess / 2 + dt * rate / 6));
      v = stops > 0 ? 0 : v + dt * (excess + dt * rate / 2);
      t += dt;
      if (stops > 0) slips = 0;
      if (stops > 0 && dt <= 1e-12 * motion.step) break;
    }
    way.push_back(x);
  }
  return way;
}

Estimate jibson_ratio(double yield, double peak) {
  const double r = yield / peak;
  if (r >= 1) return {};
  return {0.01 * std::pow(10, 0.215 + std::log10(std::pow(1 - r, 2.341) * std::pow(r, -1.438))), 0.510 * ln10};
}

Estimate jibson_magnitude(double yield, double peak, double magnitude) {
  const double r = yield / peak;
  if (r >= 1) return {};
  return {0.01 * std::pow(10, -2.710 + std::log10(std::pow(1 - r, 2.335) * std::pow(r, -1.478)) + 0.424 * magnitude),
          0.454 * ln10};
}

BrayMacedo bray_macedo(double yield_coefficient, double period, double spectral_acceleration, double magnitude) {
  const double k = std::log(yield_coefficient), s = std::log(spectral_acceleration), T = period;
  const bool stiff = T < 0.1;
  const double of_period = stiff ? -4.551 - 9.690 * T : -5.894 + 3.152 * T - 0.910 * T * T;
  const double ln = of_period + 0.607 * magnitude - 2.491 * k - 0.245 * k * k + (2.703 + 0.344 * k) * s - 0.089 * s * s;
  const double moves = -2.48 - 2.97 * k - 0.12 * k * k - 0.72 * T * k + 1.70 * T + 2.78 * s;
  return {{0.01 * std::exp(ln), 0.74}, std::erfc(moves / std::sqrt(2.)) / 2};
}

Estimate jibson_arias(double yield, double arias) {
  return {0.01 * std::pow(10, 2.401 * std::log10(arias) - 3.481 * std::log10(yield / gravity) - 3.230), 0.656 * ln10};
}

}  // namespace talus
