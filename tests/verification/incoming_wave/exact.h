#pragma once
/// A wave that comes in through a compliant base (Joyner & Chen 1975): the free end of a bar moves as the outcrop of
/// the rock beyond the base does where bar and rock are the same, and else by the series of waves between both ends:
/// u(t) = T sum_n R^n u_o(t - (2 n + 1) L / c), T = 2 Z_r / (Z_r + Z_s), R = (Z_s - Z_r) / (Z_s + Z_r) (Kramer 1996,
/// sec. 5.4).
#include <algorithm>
#include <cmath>

#include "earthquake/sources.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void incoming_wave(Rung &rung) {
  constexpr double c = 10, Z = 1e4, L = 1;
  const auto compare = [&](const std::string &name, double ratio, double frequency, std::vector<std::string> overrides,
                           int dimension) {
    const std::string motion = "{kind = 'ricker', amplitude = 1, frequency = " + number(frequency) + "}";
    overrides.push_back("earthquake=[" + motion + "]");
    const GroundMotion outcrop = read_motion(read_components("earthquake = [" + motion + "]")[0]);
    const std::vector<double> way = outcrop.displacement();
    const auto at = [&](double t) {
      const double place = std::clamp(t / outcrop.step, 0., static_cast<double>(way.size()) - 1.001);
      const auto k = static_cast<std::size_t>(place);
      return way[k] + (place - static_cast<double>(k)) * (way[k + 1] - way[k]);
    };
    const Run run = rung.run(in_dimension(dimension, overrides));
    const auto time = run.history.column("time_s"), u = run.history.column("end_displacement_x_m");
    const double rock = ratio * Z, T = 2 * rock / (rock + Z), R = (Z - rock) / (Z + rock);
    double error = 0, most = 0;
    for (std::size_t k = 0; k < time.size(); ++k) {
      double exact = 0;
      for (int n = 0; n < 20; ++n) exact += T * std::pow(R, n) * at(time[k] - (2 * n + 1) * L / c);
      error = std::max(error, std::abs(u[k] - exact)), most = std::max(most, std::abs(exact));
    }
    rung.compare(name + ": largest error of the displacement of the free end, of its largest value", 0, error / most,
                 0.03, 1);
  };
  compare("2D, rock as soil", 1, 20, {}, 2);
  const std::vector<std::string> hard{"boundary.left.density=2000", "boundary.left.shear_wave_speed=10",
                                      "boundary.left.compression_wave_speed=20", "mesh.size=0.005"};
  compare("2D, rock of 4 times the impedance", 4, 20, hard, 2);
  compare("3D, rock as soil", 1, 10, {"mesh.size=0.025", "stage.0.duration=0.6"}, 3);
}

}  // namespace talus::rungs
