// Gas in a column of soil where it is hard to compute. No cell loses more gas than it has, docs/theory/pores.md (4.9):
// gas of a negative mass would have a pressure below vacuum, without bound where soil is nearly saturated. And gas
// gains no energy where saturation varies from cell to cell, (4.7a).
#include <gtest/gtest.h>

#include <algorithm>
#include <list>
#include <memory>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

constexpr double atmosphere = 1e4;  // absolute pressure of gas at gauge 0 [Pa]

std::unique_ptr<AnySimulation> column(const std::vector<std::string> &overrides) {
  static std::list<Scene> scenes;  // as long as the simulations, which refer to them
  scenes.push_back(read_scene(std::string(TALUS_VERIFICATION) + "/gas_column/scene.toml", overrides));
  RunOptions options;
  options.pictures = options.screen = false;
  return make_simulation(PETSC_COMM_WORLD, scenes.back(), options);
}

std::vector<double> gas_pressures(AnySimulation &simulation) {
  const Snapshot now = simulation.snapshot();
  return std::ranges::find(now.columns, "gas_pressure", &Column::name)->values;
}

double lowest(AnySimulation &simulation) {
  double least = std::ranges::min(gas_pressures(simulation));
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
  return least;
}

double mean_square(AnySimulation &simulation) {
  double sum[2] = {0, 0};
  for (const double p : gas_pressures(simulation)) sum[0] += p * p, sum[1] += 1;
  MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return sum[0] / sum[1];
}

/// Gas of 60 kPa and of 10 Pa, absolute, side by side, which flows to and fro.
void expect_no_gas_below_vacuum(std::vector<std::string> overrides) {
  for (const char *more : {"gas.bulk_modulus=1e4", "gas.pressure='sin(1000 * x) * sin(1234 * y) > 0 ? 5e4 : -9990'",
                           "gas.viscosity=1e-6", "output.interval=0.001"})
    overrides.emplace_back(more);
  const auto simulation = column(overrides);
  EXPECT_LT(lowest(*simulation), -0.99 * atmosphere);
  simulation->run();
  EXPECT_GE(lowest(*simulation), -atmosphere);
}

TEST(ThinGas, stays_above_vacuum) { expect_no_gas_below_vacuum({}); }
TEST(ThinGas, stays_above_vacuum_in_3d) {
  expect_no_gas_below_vacuum(
      {"dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller", "stage.0.duration=0.005"});
}

/// Waves of up to 100 Pa without drag, from a saturation of 0.999 at one end to 0.1 at the other. Their energy may only
/// fall, as it does to a seventh; with the operator of the grains the mean square was a thousand times as large at this
/// time.
TEST(ThinGas, gains_no_energy_where_saturation_varies) {
  const auto simulation = column({"gas.viscosity=1e-9", "gas.pressure='100 * sin(1000 * x) * sin(1234 * y)'",
                                  "water.suction='100 + 9900 * y'", "stage.0.duration=0.03", "output.interval=0"});
  const double start = mean_square(*simulation);
  EXPECT_GT(start, 300);
  simulation->run();
  EXPECT_LT(mean_square(*simulation), start / 2);
}

}  // namespace
}  // namespace talus
