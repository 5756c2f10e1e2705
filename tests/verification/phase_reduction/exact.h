#pragma once
/// A phase model without what it adds is the one below it.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void phase_reduction(Rung &rung) {
  using Overrides = std::vector<std::string>;
  int dimension = 2;
  const auto difference = [&](const Overrides &one, const Overrides &other) {
    const auto in_space = [&](Overrides all) {
      if (dimension == 3)
        all.push_back(
            "body.soil.velocity=[\"sin(pi * x) * sin(2 * pi * y)\", \"-sin(pi * y) * sin(2 * pi * x)\", \"0\"]");
      return in_dimension(dimension, all);
    };
    const Run a = rung.run(in_space(one)), b = rung.run(in_space(other));
    double square = 0, all = 0;
    for (int d = 0; d < dimension; ++d) {
      const auto x = component(a.end, "displacement", d), y = component(b.end, "displacement", d);
      for (size_t i = 0; i < x.size(); ++i) square += (x[i] - y[i]) * (x[i] - y[i]), all += y[i] * y[i];
    }
    return std::sqrt(square / all);
  };
  const Overrides wet{"water.bulk_modulus=2e6", "water.table=[[0, 1], [1, 1]]", "water.excess=50e3"},
      moist{"water.bulk_modulus=2e6", "water.suction=1e8", "phases=unsaturated"};
  const auto with = [](Overrides a, const std::string &more) {
    a.push_back(more);
    return a;
  };
  for (dimension = 2; dimension <= (rung.longer() ? 3 : 2); ++dimension) {
    rung.compare(name_of(dimension) + " unsaturated, all pores full, and saturated", 0,
                 difference(with(wet, "phases=unsaturated"), wet), 1e-9, 1);
    // gas of 1e-4 of the pores, compressed by 50 kPa, gives way by 4e-10 /Pa beside the water's 5e-7 /Pa
    rung.compare(name_of(dimension) + " three-phase, all pores full, and saturated", 0,
                 difference(with(wet, "phases=three-phase"), wet), 5e-3, 1);
    // 2e-5 of the pores hold water, 1e-5 of the mass of the grains
    rung.compare(name_of(dimension) + " unsaturated, hardly any water, and dry", 0,
                 difference(with(moist, "transfer.remap_interval=0"), {"phases=dry", "transfer.remap_interval=0"}),
                 1e-3, 1);
    rung.report(name_of(dimension) + " the same with fewer remaps", 0, difference(moist, {"phases=dry"}), 1);
  }
}

}  // namespace talus::rungs
