#pragma once
/// Consolidation without a limit to strain: with sigma' = E ln(stretch) and a permeability that falls as the square of
/// the stretch the theory of Gibson, England & Hussey (1967) is linear in the stretch, so that u = E ln[1 + (exp(q / E)
/// - 1) sum (2 / M) sin(M a / H) exp(-M^2 T)], a the depth of a grain before it moved, M = (2m + 1) pi / 2, T = c_v t /
/// H^2, c_v = k E / mu; the settlement is H (1 - exp(-q / E)) [1 - sum 2 / M^2 exp(-M^2 T)].
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void large_strain_consolidation(Rung &rung) {
  constexpr double modulus = 100e3, load = 50e3, permeability = 2e-10, viscosity = 1e-3,
                   c_v = permeability * modulus / viscosity;
  const auto consolidate = [&](int dimension, double T, double size, double tolerance) {
    const double seconds = T / c_v;
    const Run run = rung.run(
        in_dimension(dimension, {"body.soil.particles_per_cell=" + number(dimension == 2 ? 12 : 8),
                                 "stage.0.duration=" + number(seconds), "mesh.size=" + number(size),
                                 "mesh.thickness=" + number(size), "output.history_interval=" + number(seconds / 20)}));
    double settled = 1, square = 0, count = 0;
    for (int m = 0; m < 200; ++m) {
      const double M = (2 * m + 1) * M_PI / 2;
      settled -= 2 / (M * M) * std::exp(-M * M * T);
    }
    settled *= 1 - std::exp(-load / modulus);
    const auto start = cell_means(run.start, "pore_pressure", dimension),
               end = cell_means(run.end, "pore_pressure", dimension);
    for (size_t c = 0; c < start.size(); ++c) {
      double sum = 0;
      for (int m = 0; m < 200; ++m) {
        const double M = (2 * m + 1) * M_PI / 2;
        sum += 2 / M * std::sin(M * (1 - start[c].y)) * std::exp(-M * M * T);
      }
      square += std::pow(end[c].value - modulus * std::log1p(std::expm1(load / modulus) * sum), 2), ++count;
    }
    const std::string name = name_of(dimension) + ", cells of " + number(size * 1e3) + " mm, T = " + number(T);
    const double area = dimension == 2 ? 0.3 : 0.3 * size,
                 left = -run.history.column("water_kg").back() + run.history.column("water_kg").front();
    rung.compare(name + ", settlement by the water that has left [m]", settled, left / (1000 * area), tolerance);
    rung.compare(name + ", rms error of pressure over load", 0, std::sqrt(square / count), tolerance + 0.01, load);
    rung.report(name + ", settlement of the loaded face [m], error over cell", settled,
                -run.history.column("load_displacement_y_m").back(), size);
    rung.compare(name + ", water stored less initial, in and out", 0, run.history.column("water_error_kg").back(),
                 1e-10, run.history.column("water_kg").front());
  };
  // first order in the cells: 1 % in cells of 25 mm; pressure has the scatter of the surface's cells on top
  consolidate(2, 0.1, 0.05, 0.03);
  consolidate(2, 0.1, 0.025, 0.01);
  if (!rung.longer()) return;
  consolidate(2, 0.5, 0.05, 0.03);
  consolidate(2, 0.5, 0.025, 0.01);
  consolidate(3, 0.1, 0.05, 0.03);
}

}  // namespace talus::rungs
