#pragma once
/// Column under its own weight. Mass above a point does not change, so sigma_v = -rho0 g (H - a) at the point that was
/// at height a, however far the column compresses; with sigma_v = E_c ln(lambda) the displacement is the integral of
/// lambda - 1.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void gravity_column(Rung &rung) {
  constexpr double rho = 2000, g = 10, height = 1, nu = 0.2, base_stress = rho * g * height;
  const auto errors = [&](const Run &run, double E, double &stress_error, double &displacement_error,
                          double &settlement) {
    const double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), scale = modulus / (rho * g);
    const auto u_of = [&](double a) {
      return scale * (std::exp(-(height - a) / scale) - std::exp(-height / scale)) - a;
    };
    settlement = -u_of(height);
    const auto y = component(run.end, "position", 1), u = component(run.end, "displacement", 1),
               stress = component(run.end, "stress", 1), mass = component(run.end, "mass");
    double stress_square = 0, displacement_square = 0, total = 0;
    for (size_t p = 0; p < y.size(); ++p) {
      const double a = y[p] - u[p], ds = stress[p] + rho * g * (height - a), du = u[p] - u_of(a);
      stress_square += mass[p] * ds * ds, displacement_square += mass[p] * du * du, total += mass[p];
    }
    stress_error = std::sqrt(stress_square / total), displacement_error = std::sqrt(displacement_square / total);
  };
  for (const int dimension : {2, 3})
    for (const auto &[name, E] : {std::pair{"soft", 100e3}, {"stiff", 10e6}}) {
      const Run run = rung.run(in_dimension(
          dimension, {"body.soil.particles_per_cell=" + std::string(dimension == 2 ? "3" : "8"),
                      "body.soil.young_modulus=" + number(E), "stage.0.duration=" + number(6 * std::sqrt(100e3 / E)),
                      "stage.0.gravity_ramp=" + number(std::sqrt(100e3 / E))}));
      double stress, displacement, settlement;
      errors(run, E, stress, displacement, settlement);
      const std::string which = name_of(dimension) + " " + name;
      rung.compare(which + " vertical stress, L2 error over base stress", 0, stress / base_stress, 0.01, 1);
      rung.compare(which + " displacement, L2 error over settlement", 0, displacement / settlement, 0.01, 1);
    }
}

}  // namespace talus::rungs
