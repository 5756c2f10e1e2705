#pragma once
/// Free flight: boundaries follow the surface of the soil wherever it is, so nothing passes it and pressures stay what
/// they were.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void wet_flight(Rung &rung) {
  const auto fly = [&](int dimension, const std::string &phases, const std::vector<std::string> &more) {
    std::vector<std::string> overrides{"phases=" + phases};
    if (phases != "saturated") overrides.push_back("water.suction=2 kPa");
    if (dimension == 3) overrides.push_back("body.block.velocity=[\"1.5\", \"0.75\", \"0\"]");
    overrides.insert(overrides.end(), more.begin(), more.end());
    const Run run = rung.run(in_dimension(dimension, overrides));
    const std::string name = name_of(dimension) + " " + phases;
    const double start = component(run.start, "pore_pressure")[0];
    double change = 0;
    for (const double p : component(run.end, "pore_pressure")) change = std::max(change, std::abs(p - start));
    const bool full = phases == "saturated";
    const double scale = full ? 2e6 : 2e3;  // K_l, or the suction
    rung.compare(name + ", largest change of pressure over " + (full ? "K_l" : "suction"), 0, change, 1e-5, scale);
    for (const std::string fluid : {"water", "gas"}) {
      if (fluid == "gas" && phases != "three-phase") continue;
      const double mass = run.history.column(fluid + "_kg").front();
      const double lost = std::abs(run.history.column(fluid + "_out_kg").back());
      rung.compare(name + ", " + fluid + " lost over " + fluid, 0, lost, 1e-6, mass);
      rung.compare(name + ", " + fluid + " error over " + fluid, 0,
                   std::abs(run.history.column(fluid + "_error_kg").back()), 1e-10, mass);
    }
    // The surface is nowhere deeper than the cell it cuts and the one below, and along the block's sides but where a
    // cell at a corner holds a bit of it
    const auto flags = component(run.end, "surface");
    std::vector<double> depth(flags.size(), 1e300);
    for (int d = 0; d < dimension && d < 2; ++d) {
      const auto x = component(run.end, "position", d);
      const auto [low, high] = std::minmax_element(x.begin(), x.end());
      for (size_t i = 0; i < depth.size(); ++i) depth[i] = std::min({depth[i], x[i] - *low, *high - x[i]});
    }
    const double cell = 0.1;  // [m]
    double deepest = 0, shallow = 0, found = 0;
    for (size_t i = 0; i < flags.size(); ++i) {
      if (flags[i] > 0) deepest = std::max(deepest, depth[i]);
      if (depth[i] < cell / 2) ++shallow, found += flags[i];
    }
    rung.compare(name + ", depth of the deepest particle that counts as surface over a cell", 0, deepest / cell, 2, 1);
    rung.compare(name + ", share of the outermost half cell that does not count", 0, 1 - found / shallow, 0.1, 1);
    rung.report(name + ", remaps", 0, static_cast<double>(run.remaps), 1);
  };
  fly(2, "saturated", {"water.table=[[0, 0], [1, 0]]"});
  fly(2, "unsaturated", {});
  fly(2, "three-phase", {});
  if (!rung.longer()) return;
  fly(3, "saturated", {"water.table=[[0, 0], [1, 0]]"});
  fly(3, "unsaturated", {});
}

}  // namespace talus::rungs
