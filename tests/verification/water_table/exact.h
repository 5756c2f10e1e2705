#pragma once
/// Column between smooth walls below a water table at y_w. Submerged: sigma'_v = -(1 - n)(rho_s - rho_w) g (H - y). A
/// table that falls to y_w < H adds (1 - n) rho_w g min(H - y, H - y_w), as pores drain and uplift ends above it.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void water_table(Rung &rung) {
  constexpr double E = 10e6, nu = 0.2, n = 0.4, grains = 2650, water = 1000, g = 10, height = 1, table = 0.5;
  const double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), base = (1 - n) * (grains - water) * g * height;
  const auto stress_error = [&](const Run &run, double drained) {
    const auto y = component(run.end, "position", 1), stress = component(run.end, "stress", 1),
               volume = component(run.end, "volume");
    double square = 0, total = 0;
    for (size_t i = 0; i < y.size(); ++i) {
      const double depth = height - y[i],
                   exact = -(1 - n) * g * ((grains - water) * depth + water * std::min(depth, drained));
      square += volume[i] * (stress[i] - exact) * (stress[i] - exact), total += volume[i];
    }
    return std::sqrt(square / total) / base;
  };
  const double gained = (1 - n) * water * g, depth = height - table,
               settlement = gained * (depth * depth / 2 + depth * table) / modulus;
  for (const int dimension : {2, 3}) {
    const std::string space = name_of(dimension) + " ";
    const Run still = rung.run(in_dimension(dimension, {"water.level=0", "mesh.size=0.05"}));
    rung.compare(space + "submerged: effective stress, L2 error over base stress", 0, stress_error(still, 0), 0.02, 1);
    double moved = 0;
    for (const double u : component(still.end, "displacement", 1)) moved = std::max(moved, std::abs(u));
    rung.compare(space + "submerged: displacement in 0.8 s over that of the drawdown", 0, moved / settlement, 0.01, 1);
    const Run drained = rung.run(in_dimension(dimension, {"mesh.size=" + number(dimension == 2 ? 0.025 : 0.05)}));
    rung.compare(space + "drawdown: effective stress, L2 error over base stress", 0, stress_error(drained, depth), 0.02,
                 1);
    const auto y = component(drained.end, "position", 1), u = component(drained.end, "displacement", 1);
    rung.compare(space + "drawdown: settlement of the surface [m]", -settlement,
                 u[std::max_element(y.begin(), y.end()) - y.begin()], 0.02);
  }
  // a slope under water rests as one of buoyant weight in air
  const std::vector<std::string> slope{"mesh.section=../../../docs/guide/slope.csv",
                                       "mesh.size=0.7",
                                       "body.soil.region=clay",
                                       "boundary.base.kind=fixed",
                                       "stage.0.reset_displacement=false",
                                       "stage.0.duration=5",
                                       "stage.1.duration=0"};
  const auto shape = [&](std::vector<std::string> more) {
    more.insert(more.end(), slope.begin(), slope.end());
    const Run run = rung.run(more);
    auto x = component(run.end, "displacement", 0);
    const auto y = component(run.end, "displacement", 1);
    x.insert(x.end(), y.begin(), y.end());
    return x;
  };
  const auto submerged = shape({"water.table=[[0, 9], [25, 9]]", "water.level=0"}),
             buoyant = shape({"water.table=[[0, -9], [25, -9]]", "water.level=0", "body.soil.grain_density=1650",
                              "body.soil.saturation=0"});
  double difference = 0, size = 0;
  for (size_t i = 0; i < buoyant.size(); ++i)
    difference += std::pow(submerged[i] - buoyant[i], 2), size += buoyant[i] * buoyant[i];
  rung.compare("2D slope under water against buoyant weight: displacement, L2", 0, std::sqrt(difference / size), 0.005,
               1);
}

}  // namespace talus::rungs
