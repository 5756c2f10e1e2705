#pragma once
/// Saturated block on a plane inclined by beta with pore pressure p at the base that has no time to leave: friction is
/// that of the effective normal stress, tan phi_b (rho g h cos beta - p).
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void wet_incline(Rung &rung) {
  constexpr double g = 9.81, degree = M_PI / 180, beta = 30 * degree, height = 0.5, density = 0.6 * 2650 + 0.4 * 1000;
  struct Mesh {
    int dimension;
    double size;
  };
  for (const auto [dimension, size] : {Mesh{2, 0.1}, Mesh{2, 0.09}, Mesh{3, 0.1}})
    for (const double excess : {0., 1000., 2000.}) {
      const std::string p = number(excess) + " + 1000 * 8.495709211125343 * (0.5 - y)", across = "\"" + p + "\"",
                        along = "\"" + p + " - 1990 * 8.495709211125343 * (0.5 - y)\"";
      std::vector<std::string> overrides{"water.excess=" + p, "body.block.stress=[" + across + ", " + along + ", " +
                                                                  across + ", \"0\"" +
                                                                  (dimension == 3 ? ", \"0\", \"0\"]" : "]")};
      overrides.push_back("mesh.size=" + number(size));
      if (dimension == 3) overrides.push_back("gravity=[4.905, -8.495709211125343, 0]");
      const Run run = rung.run(in_dimension(dimension, overrides));
      const auto friction = run.history.column("base_force_x_N"), normal = run.history.column("base_force_y_N");
      double rubbed = 0, pressed = 0;
      for (size_t k = friction.size() / 2; k < friction.size(); ++k) rubbed -= friction[k], pressed += normal[k];
      const double total = density * g * height * std::cos(beta),
                   pressure = excess + 1000 * g * height * std::cos(beta);
      const std::string name = name_of(dimension) + ", cells of " + number(size) +
                               " m, friction with excess pressure " + number(excess) +
                               " Pa, over that of the total normal force";
      rung.compare(name, 1 - pressure / total, rubbed / (std::tan(20 * degree) * pressed), 0.03, 1);
    }
}

}  // namespace talus::rungs
