#pragma once
/// Elastic slope under gravity: no closed form. The finer mesh stands for the exact answer of the coarser one, plane
/// strain for that of a slice of tetrahedra. The mean settlement, over the mass, is the work of the weight: the
/// discrete one is never above the exact one.
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_elastic_slope(Rung &rung) {
  const auto settlement = [&](const std::vector<std::string> &overrides) {
    const Run run = rung.run(overrides);
    const auto mass = component(run.end, "mass"), u = component(run.end, "displacement", 1);
    double sum = 0, total = 0;
    for (size_t p = 0; p < u.size(); ++p) sum -= mass[p] * u[p], total += mass[p];
    return sum / total;
  };
  const double finer = settlement({"mesh.size=0.25"});
  rung.compare("mean settlement, cells of 0.5 m against 0.25 m", finer, settlement({}), 1e-4);
  rung.compare("mean settlement, slice of tetrahedra", finer, settlement(in_dimension(3)), 1e-4);
  rung.report("mean settlement, linear elements with patches", finer, settlement({"quasi_static.elements=patches"}));
}

}  // namespace talus::rungs
