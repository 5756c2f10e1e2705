#pragma once
/// Gas in a rigid skeleton. Small amplitudes: P_tt + L P_t = (K / rho) P_xx, L = n S_g mu / (k rho), here with both
/// ends closed and cos(pi y / H) at the start. Steady flow at constant temperature: the square of the absolute pressure
/// is linear over the height.
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void gas_column(Rung &rung) {
  constexpr double height = 0.5, porosity = 0.4, rho = 1.2, bulk = 101325, viscosity = 1.8e-5;
  const double gas_share = 1 - std::pow(1 + 50. / 5 * 50 / 5, -0.5), k = M_PI / height,
               omega0 = k * std::sqrt(bulk / rho);
  const auto ledger = [&](const std::string &name, const Run &run) {
    for (const std::string fluid : {"water", "gas"})
      rung.compare(name + ", " + fluid + " error over " + fluid, 0,
                   std::abs(run.history.column(fluid + "_error_kg").back()), 1e-12,
                   run.history.column(fluid + "_kg").front());
  };
  const auto rms = [&](const Run &run, int dimension, auto &&exact) {
    double square = 0, count = 0;
    for (const CellMeans &cell : cell_means(run.end, "gas_pressure", dimension))
      square += std::pow(cell.value - exact(cell.y), 2), ++count;
    return std::sqrt(square / count);
  };
  const auto wave = [&](int dimension, double permeability, double t) {
    const double damping = porosity * gas_share * viscosity / (permeability * rho),
                 square = omega0 * omega0 - damping * damping / 4;
    const double omega = std::sqrt(std::abs(square));
    const double fade =
        square > 0 ? std::exp(-damping * t / 2) * (std::cos(omega * t) + damping / (2 * omega) * std::sin(omega * t))
                   : (std::exp((omega - damping / 2) * t) * (1 + damping / (2 * omega)) +
                      std::exp(-(omega + damping / 2) * t) * (1 - damping / (2 * omega))) /
                         2;
    const Run run = rung.run(in_dimension(
        dimension, {"body.soil.gas_permeability=" + number(permeability), "gas.pressure=100 * cos(pi * y / 0.5)",
                    "stage.0.duration=" + number(t), "boundary.lid.kind=roller", "boundary.lid.group=load"}));
    const std::string name = name_of(dimension) + " wave, k = " + number(permeability) + " m2";
    rung.compare(name + ", rms error over amplitude", 0,
                 rms(run, dimension, [&](double y) { return 100 * fade * std::cos(k * y); }), 0.01, 100);
    ledger(name, run);
  };
  const auto flow = [&](int dimension) {
    constexpr double pressure = 50e3;
    const Run run = rung.run(in_dimension(
        dimension,
        {"body.soil.gas_permeability=1e-9", "boundary.source.kind=gas_pressure", "boundary.source.group=base",
         "boundary.source.pressure=50e3 * min(1, t / 0.01)", "stage.0.duration=0.04", "stage.0.damping=0.1"}));
    const double low = bulk * bulk, high = (bulk + pressure) * (bulk + pressure);
    rung.compare(name_of(dimension) + " steady flow, rms error over pressure", 0,
                 rms(run, dimension, [&](double y) { return std::sqrt(high + (low - high) * y / height) - bulk; }),
                 0.01, pressure);
    ledger(name_of(dimension) + " steady flow", run);
  };
  wave(2, 1e-8, 0.006);
  wave(2, 1e-10, 0.01);
  flow(2);
  flow(3);
  if (!rung.longer()) return;
  wave(3, 1e-8, 0.006);
  wave(3, 1e-10, 0.01);
}

}  // namespace talus::rungs
