#pragma once
/// Free flight. Every node moves at the same velocity, so stress stays zero and the velocity constant, to round-off;
/// with shear waves of 0.1 m/s on top linear momentum is conserved to round-off, and no particle or mass is lost.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void rigid_translation(Rung &rung) {
  constexpr double rho = 2000, E = 1e6, nu = 0.3, velocity[3]{1.5, 0.75, 0};
  const double speed = std::hypot(velocity[0], velocity[1]),
               c = std::sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho);
  const auto momentum = [](const Snapshot &s, int d) {
    const auto mass = component(s, "mass"), v = component(s, "velocity", d);
    double sum = 0;
    for (size_t p = 0; p < mass.size(); ++p) sum += mass[p] * v[p];
    return sum;
  };
  const auto total = [](const std::vector<double> &values) {
    double sum = 0;
    for (const double x : values) sum += x;
    return sum;
  };
  for (const int dimension : {2, 3}) {
    const std::string space = name_of(dimension) + " ", rest = dimension == 2 ? "]" : ", \"0 * x\"]";
    const Run flight = rung.run(in_dimension(dimension, {"body.block.velocity=[\"1.5\", \"0.75\"" + rest}));
    double stress = 0, scatter = 0;
    for (int k = 0; k < (dimension == 2 ? 4 : 6); ++k)
      for (const double s : component(flight.end, "stress", k)) stress = std::max(stress, std::abs(s));
    for (int d = 0; d < dimension; ++d)
      for (const double v : component(flight.end, "velocity", d))
        scatter = std::max(scatter, std::abs(v - velocity[d]));
    rung.compare(space + "largest stress over rho c V", 0, stress / (rho * c * speed), 1e-10, 1);
    rung.compare(space + "scatter of velocity over V", 0, scatter / speed, 1e-12, 1);

    const Run wave = rung.run(in_dimension(
        dimension,
        {"body.block.velocity=[\"1.5 + 0.1 * cos(2 * pi * (y - 0.5))\", \"0.75 + 0.1 * sin(2 * pi * (x - 0.5))\"" +
         rest}));
    double change = 0, scale = total(component(wave.start, "mass")) * speed;
    for (int d = 0; d < dimension; ++d)
      change = std::max(change, std::abs(momentum(wave.end, d) - momentum(wave.start, d)));
    rung.compare(space + "change of linear momentum of a block that vibrates, over m V", 0, change / scale, 1e-11, 1);
    rung.compare(space + "particles", static_cast<double>(wave.start.id.size()),
                 static_cast<double>(wave.end.id.size()), 0);
    rung.compare(space + "mass [kg]", total(component(wave.start, "mass")), total(component(wave.end, "mass")), 1e-14);
  }
}

}  // namespace talus::rungs
