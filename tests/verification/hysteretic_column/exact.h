#pragma once
/// A column of hysteretic soil under a record, against two computations of its own: the same column in time by finite
/// elements of one dimension, whose soil follows the modified hyperbola and Masing's rules by a memory of reversals;
/// and the equivalent linear one (Schnabel, Lysmer & Seed 1972; Kramer 1996, sec. 7.2.1.3), whose modulus and damping
/// are those of 0.65 of the largest strain. Waves run along the column and compress it: with the strain e the angle of
/// shear on the steepest plane of the deviator is 2 e / sqrt 3, and the stress K e + 2 tau / sqrt 3.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "earthquake/intensity.h"
#include "earthquake/sources.h"
#include "physics/laws/backbone.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

namespace column {

constexpr double steepest = 2 / std::numbers::sqrt3;

struct Layer {
  double density, bulk, shear;  ///< [kg/m3], [Pa]
  Backbone curve;
};

/// Masing's rules with a memory of reversals: after one the curve goes on from there at twice its size, until it meets
/// the branch that the reversal left.
class Masing {
 public:
  /// tau over G after a change of the angle of shear.
  double advance(const Backbone &curve, double change) {
    const double next = gamma_ + change;
    if (change * direction_ < 0) reversals_.push_back({gamma_, tau_});
    if (change != 0) direction_ = change > 0 ? 1 : -1;
    while (reversals_.size() >= 2 && passes(next, reversals_[reversals_.size() - 2].gamma))
      reversals_.resize(reversals_.size() - 2);
    if (reversals_.size() == 1 && passes(next, -reversals_[0].gamma)) reversals_.clear();
    const Point from = reversals_.empty() ? Point{0, 0} : reversals_.back();
    const double size = reversals_.empty() ? 1 : 2, along = (next - from.gamma) / size;
    gamma_ = next;
    return tau_ = from.tau + size * std::copysign(curve.over_modulus(std::abs(along)), along);
  }

 private:
  struct Point {
    double gamma, tau;
  };
  bool passes(double gamma, double limit) const { return direction_ > 0 ? gamma >= limit : gamma <= limit; }

  std::vector<Point> reversals_;
  double gamma_ = 0, tau_ = 0;
  int direction_ = 0;
};

/// Displacement of the free end relative to the base at equal steps of time [m].
inline std::vector<double> in_time(const std::vector<Layer> &layers, double thickness, const GroundMotion &ground,
                                   double interval, std::size_t count) {
  constexpr int of_layer = 40, parts = 20;  // elements; steps to an interval
  const int elements = of_layer * static_cast<int>(layers.size());
  const double h = thickness / of_layer, dt = interval / parts;
  std::vector<double> u(elements + 1, 0.), v(elements + 1, 0.), mass(elements + 1, 0.), force(elements + 1), end{0.};
  std::vector<Masing> soil(elements);
  std::vector<double> before(elements, 0.);
  for (int e = 0; e < elements; ++e)
    for (int side : {0, 1}) mass[e + side] += layers[e / of_layer].density * h / 2;
  for (std::size_t k = 1; k < count; ++k) {
    for (int part = 0; part < parts; ++part) {
      const double t = (static_cast<double>(k - 1) + static_cast<double>(part) / parts) * interval;
      for (int n = 0; n <= elements; ++n) force[n] = -mass[n] * ground.at(t);
      for (int e = 0; e < elements; ++e) {
        const Layer &layer = layers[e / of_layer];
        const double strain = (u[e + 1] - u[e]) / h;
        const double tau = layer.shear * soil[e].advance(layer.curve, steepest * (strain - before[e]));
        const double stress = layer.bulk * strain + steepest * tau;
        before[e] = strain, force[e] += stress, force[e + 1] -= stress;
      }
      for (int n = 1; n <= elements; ++n) v[n] += dt * force[n] / mass[n], u[n] += dt * v[n];
    }
    end.push_back(u[elements]);
  }
  return end;
}

/// The same by the equivalent linear method.
inline std::vector<double> equivalent_linear(const std::vector<Layer> &layers, double thickness,
                                             const GroundMotion &ground, double interval, std::size_t count) {
  using Complex = std::complex<double>;
  constexpr Complex i(0, 1);
  constexpr int of_layer = 10, size = 2048;  // a quiet time after the motion
  const int sublayers = of_layer * static_cast<int>(layers.size());
  const double h = thickness / of_layer, step = interval * 2;
  std::vector<Complex> spectrum(size / 2);
  const auto turn = [&](int f, int k) {
    return std::exp(-2 * std::numbers::pi * i * static_cast<double>(f) * static_cast<double>(k) /
                    static_cast<double>(size));
  };
  for (int f = 0; f < size / 2; ++f)
    for (int k = 0; k * step <= ground.duration(); ++k) spectrum[f] += ground.at(k * step) * turn(f, k);
  std::vector<double> largest(sublayers, 0.), end(count, 0.);
  for (int iteration = 0; iteration < 12; ++iteration) {
    std::vector<Complex> modulus(sublayers);
    for (int e = 0; e < sublayers; ++e) {
      const Layer &layer = layers[e / of_layer];
      const double gamma = std::max(0.65 * steepest * largest[e], 1e-7),
                   secant = layer.curve.over_modulus(gamma) / gamma;
      double area = 0;
      constexpr int parts = 200;
      for (int k = 0; k < parts; ++k) area += layer.curve.over_modulus((k + 0.5) / parts * gamma) * gamma / parts;
      const double damping = 4 / std::numbers::pi * (2 * area / (secant * gamma * gamma) - 1) / 2;
      modulus[e] = layer.bulk + steepest * steepest * layer.shear * secant * (1. + 2. * i * damping);
    }
    std::vector<std::vector<Complex>> strain(sublayers, std::vector<Complex>(size / 2));
    std::vector<Complex> relative(size / 2);
    for (int f = 1; f < size / 2; ++f) {
      const double omega = 2 * std::numbers::pi * f / (size * step);
      // from the free end down, for an acceleration of 1 there
      Complex a = 1, slope = 0;  // acceleration and its derivative along the column
      for (int e = sublayers - 1; e >= 0; --e) {
        const Complex k = omega * std::sqrt(layers[e / of_layer].density / modulus[e]);
        const Complex c = std::cos(k * h), s = std::sin(k * h);
        const Complex middle = -k * std::sin(k * h / 2.) * a * -1. + std::cos(k * h / 2.) * slope;
        strain[e][f] = middle / (-omega * omega);
        const Complex below = c * a - s / k * slope;
        slope = k * s * a + c * slope, a = below;
        if (e > 0) slope *= modulus[e] / modulus[e - 1];
      }
      for (auto &one : strain) one[f] *= spectrum[f] / a;
      relative[f] = (1. / a - 1.) * spectrum[f] / (-omega * omega);
    }
    const auto at = [&](const std::vector<Complex> &of, double t) {
      double sum = 0;
      for (int f = 1; f < size / 2; ++f)
        sum += (of[f] * std::exp(2 * std::numbers::pi * i * static_cast<double>(f) * t / (size * step))).real();
      return 2 * sum / size;
    };
    for (int e = 0; e < sublayers; ++e) {
      largest[e] = 0;
      for (int k = 0; k * step <= ground.duration() + 0.5; ++k)
        largest[e] = std::max(largest[e], std::abs(at(strain[e], k * step)));
    }
    if (iteration == 11)
      for (std::size_t k = 0; k < count; ++k) end[k] = at(relative, static_cast<double>(k) * interval);
  }
  return end;
}

}  // namespace column

inline void hysteretic_column(Rung &rung) {
  constexpr double interval = 5e-3;
  const auto layer = [](double density, double modulus, double reference) {
    column::Layer one{density, modulus / 3, modulus / 2, {}};
    one.curve.reference_strain = reference;
    return one;
  };
  const std::vector<column::Layer> layers{layer(1900, 171e6, 1e-3), layer(1800, 72e6, 5e-4)};
  const GroundMotion ground = read_motion(read_components(
      "earthquake = [{kind = 'kanai_tajimi', amplitude = 2, duration = 5, rise = 0.5, strong = 3}]")[0]);
  const Run run = rung.run();
  const auto time = run.history.column("time_s"), u = run.history.column("end_displacement_x_m");
  const std::size_t count = time.size();
  /// Response spectrum of the free end from its displacement relative to the base.
  const auto spectrum = [&](const std::vector<double> &way, double period) {
    GroundMotion surface{interval, {0}};
    for (std::size_t k = 1; k + 1 < way.size(); ++k)
      surface.acceleration.push_back((way[k + 1] - 2 * way[k] + way[k - 1]) / (interval * interval) +
                                     ground.at(static_cast<double>(k) * interval));
    return spectral_acceleration(surface, period);
  };
  const auto exact = column::in_time(layers, 10, ground, interval, count),
             linear = column::equivalent_linear(layers, 10, ground, interval, count);
  double worst = 0, worst_linear = 0, largest = 0;
  for (int k = 0; k <= 40; ++k) {
    const double period = 0.1 * std::pow(20, k / 40.), reference = spectrum(exact, period);
    worst = std::max(worst, std::abs(spectrum(u, period) / reference - 1));
    worst_linear = std::max(worst_linear, std::abs(spectrum(linear, period) / reference - 1));
    largest = std::max(largest, reference);
  }
  rung.compare("largest difference of the response spectrum, periods from 0.1 to 2 s", 0, worst, 0.05, 1);
  for (const double period : {0.1, 0.2, 0.4, 0.6, 1., 2.})
    rung.compare("spectral acceleration at " + number(period) + " s [m/s2]", spectrum(exact, period),
                 spectrum(u, period), 0.05);
  rung.report("equivalent linear: largest difference of the spectrum from that in time", 0, worst_linear, 1);
  for (const double period : {0.2, 0.4, 1.})
    rung.report("equivalent linear: spectral acceleration at " + number(period) + " s [m/s2]", spectrum(exact, period),
                spectrum(linear, period));
}

}  // namespace talus::rungs
