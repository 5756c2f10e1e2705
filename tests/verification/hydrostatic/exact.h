#pragma once
/// Still water: p = rho_l g (level - y) everywhere. Grains as heavy as water leave the skeleton without stress, so
/// nothing may move at all; also with 2 m of water on top, whose weight the face takes. With heavier grains the
/// skeleton's own weight is a K0 state, given at the start.
#include <algorithm>
#include <cmath>

#include "tests/verification/cell_means.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void hydrostatic(Rung &rung) {
  const auto speed = [](const Run &run, int dimension) {
    double largest = 0;
    for (int d = 0; d < dimension; ++d)
      for (const double v : component(run.end, "velocity", d)) largest = std::max(largest, std::abs(v));
    return largest;
  };
  for (const int dimension : {2, 3})
    for (const double level : {1., 3.}) {
      const Run run =
          rung.run(in_dimension(dimension, {"water.table=[[0, " + number(level) + "], [1, " + number(level) + "]]",
                                            "boundary.water.level=" + number(level), "water.compression=exponential",
                                            "water.bulk_modulus=2e9", "stage.0.duration=0.01"}));
      // round-off of pressures of 30 kPa, 4e-12 Pa, over cells of 5 cm for 10 ms
      rung.compare(name_of(dimension) + " level " + number(level) + " m, largest speed [m/s]", 0, speed(run, dimension),
                   1e-10, 1);
      // supports bear grains, pore water and, through the skeleton, the water on top
      const double grains = run.history.column("mass_kg").back(), above = (level - 1) * 1000 / 600 * grains;
      rung.compare(name_of(dimension) + " level " + number(level) + " m, force on the base",
                   10 * (grains + run.history.column("water_kg").back() + above),
                   run.history.column("base_force_y_N").back(), 1e-4);
    }
  // pores that may dry, but are full: the same, and with gas what its residue takes to find its pressure
  for (const int dimension : {2, 3})
    for (const std::string phases : {"unsaturated", "three-phase"}) {
      const bool gas = phases == "three-phase";
      const Run run = rung.run(in_dimension(dimension, {"phases=" + phases, "water.compression=exponential",
                                                        "water.bulk_modulus=2e9", "stage.0.duration=0.01"}));
      double largest = 0;
      for (const CellMeans &cell : cell_means(run.end, "pore_pressure", dimension))
        largest = std::max(largest, std::abs(cell.value - 1e4 * (1 - cell.y)));
      const std::string name = name_of(dimension) + " " + phases;
      rung.compare(name + ", largest speed [m/s]", 0, speed(run, dimension), gas ? 5e-4 : 1e-10, 1);
      rung.compare(name + ", largest error of pressure in a cell over weight of the water", 0, largest,
                   gas ? 0.03 : 1e-8, 1e4);
    }
}

}  // namespace talus::rungs
