#pragma once
/// A layer with Rayleigh damping on a rigid base and on an elastic half-space: motion of its surface over that of the
/// outcrop. With k^2 = omega^2 (1 - i alpha / omega) / (c^2 (1 + i omega beta)), s = 1 / (1 - i alpha / omega) and the
/// impedance Z of the half-space u / u_o = 1 - s + s / (cos kH - sin kH rho c^2 (1 + i omega beta) k / (i omega Z)),
/// since the mass part brakes the motion relative to the outcrop. Kramer (1996), eq. (7.13), has 1 / |cos kH| on a
/// rigid base, with k = omega / (c sqrt(1 + 2 i xi)) and, here, the damping ratio xi = alpha / (2 omega) + beta omega
/// / 2.
#include <algorithm>
#include <cmath>
#include <complex>

#include "earthquake/sources.h"
#include "scene/rayleigh.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void damped_layer(Rung &rung) {
  using Complex = std::complex<double>;
  constexpr double c = 10, H = 1, density = 1000, two_pi = 6.283185307179586;
  constexpr Complex i(0, 1);
  const Rayleigh damping = rayleigh(0.05, {2.5, 7.5});
  const auto exact = [&](double f, double impedance) {
    const double omega = two_pi * f;
    const Complex mass = 1. - i * damping.mass / omega, stiffness = 1. + i * omega * damping.stiffness;
    const Complex k = omega / c * std::sqrt(mass / stiffness), s = 1. / mass;
    const Complex leaks = std::isinf(impedance) ? 0. : density * c * c * stiffness * k / (i * omega * impedance);
    return std::abs(1. - s + s / (std::cos(k * H) - std::sin(k * H) * leaks));
  };
  const auto kramer = [&](double f) {
    const double omega = two_pi * f, xi = damping.mass / (2 * omega) + damping.stiffness * omega / 2;
    return 1 / std::abs(std::cos(omega * H / (c * std::sqrt(1. + 2. * i * xi))));
  };
  const GroundMotion ground =
      read_motion(read_components("earthquake = [{kind = 'ricker', amplitude = 1, frequency = 6}]")[0]);
  const std::vector<double> way = ground.displacement();
  const auto compare = [&](const std::string &name, double ratio, const std::vector<std::string> &overrides,
                           int dimension) {
    const bool rigid = std::isinf(ratio);
    const Run run = rung.run(in_dimension(dimension, overrides));
    const auto time = run.history.column("time_s"), u = run.history.column("end_displacement_x_m");
    const auto computed = [&](double f) {
      Complex soil = 0, outcrop = 0;
      for (std::size_t k = 1; k < time.size(); ++k)
        soil += (time[k] - time[k - 1]) / 2 *
                (u[k] * std::exp(-i * two_pi * f * time[k]) + u[k - 1] * std::exp(-i * two_pi * f * time[k - 1]));
      for (std::size_t k = 0; k < way.size(); ++k)
        outcrop += ground.step * way[k] * std::exp(-i * two_pi * f * ground.step * static_cast<double>(k));
      return std::abs((rigid ? 1. : 0.) + soil / outcrop);
    };
    double error = 0, largest = 0;
    for (double f = 0.2; f <= 10; f += 0.05)
      error = std::max(error, std::abs(computed(f) - exact(f, ratio * density * c))),
      largest = std::max(largest, exact(f, ratio * density * c));
    rung.compare(name + ": largest error of the transfer function, of its peak, 0.2 to 10 Hz", 0, error / largest,
                 rigid ? 0.02 : 0.03, 1);
    if (!rigid) return;
    const auto peak = [&](double from, const auto &of) {
      double most = 0;
      for (double f = from; f < from + 4; f += 0.01) most = std::max(most, of(f));
      return most;
    };
    for (const double from : {0.5, 5.5})
      rung.compare(name + ": peak " + (from < 1 ? "1" : "2") + " of Kramer's layer", peak(from, kramer),
                   peak(from, computed), 0.02);
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  compare("2D", infinity, {}, 2);
  compare("2D, arkode", infinity, {"integrator.kind=arkode"}, 2);
  compare("3D", infinity, {"mesh.size=0.04"}, 3);
  compare("2D, half-space of twice the impedance", 2,
          {"mesh.size=0.025", "boundary.left.kind=non_reflecting", "boundary.left.incoming_wave=true",
           "boundary.left.density=2000", "boundary.left.shear_wave_speed=5", "boundary.left.compression_wave_speed=10"},
          2);
}

}  // namespace talus::rungs
