#pragma once
/// Embankment on soft clay with a geogrid at its base (Tandjiria 2002, Geotextiles and Geomembranes 20): with 56 kN/m
/// its factor is 1.35 on the critical slip surface that is no circle, by Tandjiria and by Slide2; without it 1.22 by
/// finite elements (RS2).
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_geogrid(Rung &rung) {
  const auto factor = [&](const std::vector<std::string> &overrides) {
    return rung.factor_of_safety(overrides).value();
  };
  rung.compare("with the geogrid", 1.35, factor({}), 0.03);
  rung.compare("without it", 1.22, factor({"structure.geogrid.tensile_capacity=1"}), 0.03);
}

}  // namespace talus::rungs
