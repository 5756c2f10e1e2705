#pragma once
/// Nothing leaves a closed box: masses of water and gas stay to round-off while cells are crossed and soil wets and
/// dries.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void closed_box(Rung &rung) {
  const auto shake = [&](int dimension, const std::string &phases, const std::string &integrator,
                         const std::string &duration) {
    const std::string level = number(phases == "saturated" ? 1 : 0.5);
    std::vector<std::string> more{"phases=" + phases, "water.table=[[0, " + level + "], [1, " + level + "]]",
                                  "integrator.kind=" + integrator, "stage.0.duration=" + duration};
    if (dimension == 3)
      more.push_back(
          "body.soil.velocity=[\"4 * sin(pi * x) * sin(2 * pi * y)\", \"-4 * sin(pi * y) * sin(2 * pi * x)\", \"0\"]"),
          more.push_back("mesh.size=0.2");
    const Run run = rung.run(in_dimension(dimension, more));
    const std::string name = name_of(dimension) + " " + phases + (integrator == "euler" ? "" : ", " + integrator);
    for (const std::string fluid : {"water", "gas"}) {
      if (fluid == "gas" && phases != "three-phase") continue;
      double error = 0;
      for (const double e : run.history.column(fluid + "_error_kg")) error = std::max(error, std::abs(e));
      rung.compare(name + ", " + fluid + " error over " + fluid, 0, error, 1e-12,
                   run.history.column(fluid + "_kg").front());
      rung.compare(name + ", " + fluid + " lost over " + fluid, 0,
                   std::abs(run.history.column(fluid + "_out_kg").back()), 1e-12,
                   run.history.column(fluid + "_kg").front());
    }
    rung.report(name + ", remaps", 0, static_cast<double>(run.remaps), 1);
  };
  for (const std::string phases : {"saturated", "unsaturated", "three-phase"}) {
    for (const int dimension : {2, 3}) shake(dimension, phases, "euler", "0.05");
    shake(2, phases, "arkode", "0.01");
  }
}

}  // namespace talus::rungs
