#pragma once
/// Strip footing on weightless Tresca soil: limit load per width N_c c_u, N_c = 2 + pi (Prandtl 1920), rough or smooth.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void footing(Rung &rung) {
  // the free facet beside the last node of the footing hangs on it with one end: half of it is carried along
  constexpr double cohesion = 10e3, size = 0.1, half_width = 1 + size / 2, pi = 3.14159265358979323846;
  const auto factor = [&](const Run &run, double thickness) {
    const auto force = run.history.column("footing_force_y_N");
    double sum = 0;
    const size_t rows = force.size() / 10;  // the last tenth
    for (size_t i = force.size() - rows; i < force.size(); ++i) sum -= force[i];
    return sum / static_cast<double>(rows) / (cohesion * half_width * thickness);
  };
  const auto in_space = [](double thickness, int layers) {
    return in_dimension(3, {"boundary.footing.velocity=[\"0\", \"-0.005 * min(1, t / 0.1)\", \"0\"]",
                            "mesh.refine=[{from = [0.5, 3.4, 0], to = [1.5, 4, 1], size = 0.1}]",
                            "mesh.thickness=" + number(thickness), "mesh.layers=" + std::to_string(layers)});
  };
  rung.compare("2D N_c", 2 + pi, factor(rung.run(), 1), 0.03);
  rung.compare("slice N_c", 2 + pi, factor(rung.run(in_space(0.1, 1)), 0.1), 0.03);
  rung.compare("3D N_c", 2 + pi, factor(rung.run(in_space(0.3, 0)), 0.3), 0.03);
  rung.report("2D N_c without a cure of locking", 2 + pi, factor(rung.run({"transfer.locking=none"}), 1));
}

}  // namespace talus::rungs
