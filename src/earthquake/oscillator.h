#pragma once
/// The oscillator u'' + 2 h w u' + w^2 u = -a of a ground that accelerates by a, exact for acceleration that is linear
/// over each step (Nigam & Jennings 1969, BSSA 59, 909-922).
#include <cmath>
#include <numbers>

namespace talus {

class Oscillator {
 public:
  Oscillator(double period, double damping, double step)
      : w_(2 * std::numbers::pi / period),
        h_(damping),
        dt_(step),
        wd_(w_ * std::sqrt(1 - h_ * h_)),
        decay_(std::exp(-h_ * w_ * dt_)),
        sine_(std::sin(wd_ * dt_)),
        cosine_(std::cos(wd_ * dt_)) {}

  /// Goes on by a step, over which the ground's acceleration goes from one value to the next [m/s2].
  void go_on(double from, double to) {
    // a linear part, and a vibration about it
    const double w2 = w_ * w_, rate = (to - from) / dt_, slope = -rate / w2,
                 start = -from / w2 + 2 * h_ * rate / (w2 * w_);
    const double x = u_ - start, y = (v_ - slope + h_ * w_ * x) / wd_;
    u_ = start + slope * dt_ + decay_ * (x * cosine_ + y * sine_);
    v_ = slope + decay_ * ((y * wd_ - h_ * w_ * x) * cosine_ - (x * wd_ + h_ * w_ * y) * sine_);
  }
  /// Displacement relative to the ground [m].
  double displacement() const { return u_; }
  /// Acceleration of the mass, that of the ground included [m/s2].
  double acceleration() const { return -2 * h_ * w_ * v_ - w_ * w_ * u_; }

 private:
  double w_, h_, dt_, wd_, decay_, sine_, cosine_;
  double u_ = 0, v_ = 0;
};

}  // namespace talus
