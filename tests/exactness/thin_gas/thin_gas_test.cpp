// No cell loses more gas than it has, docs/theory/pores.md (4.9): a column of nearly dry soil starts with gas of 60 kPa
// and of 10 Pa, absolute, side by side, which flows to and fro. Gas whose mass were negative would have a pressure
// below vacuum, without bound where soil is nearly saturated.
#include <gtest/gtest.h>

#include <algorithm>

#include "scene/reader.h"
#include "simulation.h"

namespace talus {
namespace {

constexpr double atmosphere = 1e4;  // absolute pressure of gas at gauge 0 [Pa]

void expect_no_gas_below_vacuum(std::vector<std::string> overrides) {
  for (const char *more : {"gas.bulk_modulus=1e4", "gas.pressure='sin(1000 * x) * sin(1234 * y) > 0 ? 5e4 : -9990'",
                           "gas.viscosity=1e-6", "output.interval=0.001"})
    overrides.emplace_back(more);
  Scene scene = read_scene(std::string(TALUS_VERIFICATION) + "/gas_column/scene.toml", overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const auto lowest = [&] {
    const Snapshot now = simulation->snapshot();
    const auto found =
        std::find_if(now.columns.begin(), now.columns.end(), [](const Column &c) { return c.name == "gas_pressure"; });
    double least = std::ranges::min(found->values);
    MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
    return least;
  };
  EXPECT_LT(lowest(), -0.99 * atmosphere);
  simulation->run();
  EXPECT_GE(lowest(), -atmosphere);
}

TEST(ThinGas, stays_above_vacuum) { expect_no_gas_below_vacuum({}); }
TEST(ThinGas, stays_above_vacuum_in_3d) {
  expect_no_gas_below_vacuum(
      {"dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller", "stage.0.duration=0.005"});
}

}  // namespace
}  // namespace talus
