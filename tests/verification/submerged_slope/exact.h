#pragma once
/// Still water, 2 m above the crest of a slope: p = rho_l g (level - y) everywhere, and grains as heavy as water leave
/// the skeleton without stress, so that nothing may move.
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void submerged_slope(Rung &rung) {
  constexpr double unit_weight = 1e4, level = 8, height = 4;
  enum class Claim { at_rest, settles, none };
  const auto rest = [&](const std::string &name, int dimension, const std::vector<std::string> &more, Claim claim) {
    std::vector<std::string> overrides{"stage.0.damping=0.5"};
    overrides.insert(overrides.end(), more.begin(), more.end());
    const Run run = rung.run(in_dimension(dimension, overrides));
    double square = 0, largest = 0, speed = 0, moved = 0, count = 0;
    for (const CellMeans &cell : cell_means(run.end, "pore_pressure", dimension)) {
      const double error = cell.value - unit_weight * (level - cell.y);
      square += error * error, largest = std::max(largest, std::abs(error)), ++count;
    }
    for (int d = 0; d < dimension; ++d) {
      const auto now = component(run.end, "displacement", d), first = component(run.start, "displacement", d);
      for (size_t p = 0; p < now.size(); ++p) moved = std::max(moved, std::abs(now[p] - first[p]));
      for (const double v : component(run.end, "velocity", d)) speed = std::max(speed, std::abs(v));
    }
    const auto put = [&](const std::string &quantity, double value, double at_rest, double settling, double scale) {
      claim == Claim::none
          ? rung.report(name + ", " + quantity, 0, value, scale)
          : rung.compare(name + ", " + quantity, 0, value, claim == Claim::at_rest ? at_rest : settling, scale);
    };
    // at rest: round-off of pressures of 80 kPa, 1e-11 Pa, on 20 MPa; settling: residual gas that must find its
    // pressure
    put("largest displacement over height", moved, 1e-9, 1e-5, height);
    put("rms error of pressure over weight of the water", std::sqrt(square / count), 1e-6, 2e-3, unit_weight * height);
    put("largest speed [m/s]", speed, 1e-10, 1e-4, 1);
    rung.report(name + ", largest error of pressure in a cell over weight of the water", 0, largest,
                unit_weight * height);
    rung.compare(name + ", water error over water", 0, run.history.column("water_error_kg").back(), 1e-10,
                 run.history.column("water_kg").front());
  };
  rest("2D saturated", 2, {}, Claim::at_rest);
  rest("2D unsaturated", 2, {"phases=unsaturated"}, Claim::at_rest);
  rest("2D three-phase", 2, {"phases=three-phase"}, Claim::settles);
  rest("2D, surface cuts cells", 2,
       {"body.soil.displacement=[\"0\", \"-0.02 * y\"]", "boundary.water.group=free_surface"}, Claim::none);
  if (!rung.longer()) return;
  rest("3D saturated", 3, {}, Claim::at_rest);
  rest("2D saturated, cells of 0.25 m", 2, {"mesh.size=0.25"}, Claim::at_rest);
}

}  // namespace talus::rungs
