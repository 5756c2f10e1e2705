#pragma once
/// Steady seepage through a slope by finite elements, then its equilibrium, then motion of soil and water: pressures,
/// and so the water that is stored, must stay what they are.
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void wet_hand_over(Rung &rung) {
  constexpr double head = 50e3;  // of the water behind the slope [Pa]
  const auto follow = [&](int dimension, double size) {
    const std::vector<std::string> sizes{"mesh.size=" + number(size), "mesh.thickness=" + number(size)};
    const auto with = [&](const std::vector<std::string> &more) {
      std::vector<std::string> all = sizes;
      all.insert(all.end(), more.begin(), more.end());
      return in_dimension(dimension, all);
    };
    const Run taken = rung.run(with({"stage.2.duration=1e-6"})), moved = rung.run(with({}));
    const auto before = cell_means(taken.end, "pore_pressure", dimension),
               after = cell_means(moved.end, "pore_pressure", dimension);
    double square = 0, speed = 0;
    for (size_t c = 0; c < before.size(); ++c) square += std::pow(after[c].value - before[c].value, 2);
    for (int d = 0; d < dimension; ++d)
      for (const double v : component(moved.end, "velocity", d)) speed = std::max(speed, std::abs(v));
    const std::string name = name_of(dimension) + ", cells of " + number(size) + " m";
    rung.compare(name + ", rms change of pressure in 0.5 s over head", 0, std::sqrt(square / before.size()), 0.005,
                 head);
    const double water = taken.history.column("water_kg").back();
    rung.compare(name + ", change of stored water in 0.5 s over water", 0,
                 moved.history.column("water_kg").back() - water, 1e-4, water);
    rung.compare(name + ", water error over water", 0, moved.history.column("water_error_kg").back(), 1e-10, water);
    rung.report(name + ", largest speed [m/s]", 0, speed, 1);
  };
  follow(2, 0.5);
  if (!rung.longer()) return;
  follow(2, 0.25);
  follow(3, 0.5);
}

}  // namespace talus::rungs
