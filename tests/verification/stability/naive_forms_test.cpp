// The forms that others take and that are there to show where they fail, in the time loop.
// Explicit drag: the step that the program states for it is the one of the closed form for saturated soil, it holds,
// and a little more fails where drag sets it; with implicit drag the same soil keeps the step without drag. Pressure by
// its rate: water is lost near saturation, and pressure scatters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"
#include "solvers/critical_step.h"

namespace talus {
namespace {

struct Layer {
  explicit Layer(std::vector<std::string> overrides)
      : scene(read_scene(TALUS_TERZAGHI, with(std::move(overrides)))),
        simulation(make_simulation(PETSC_COMM_WORLD, scene, options())) {}
  static std::vector<std::string> with(std::vector<std::string> overrides) {
    overrides.insert(overrides.end(), {"mesh.size=0.15", "water.bulk_modulus=20e6", "water.compression=exponential",
                                       "output.interval=0"});
    return overrides;
  }
  static RunOptions options() {
    RunOptions none;
    none.pictures = none.screen = false;
    return none;
  }
  /// Largest speed of a particle after so many steps, infinite where the run has ended before [m/s].
  double speed_after(int steps) {
    try {
      for (int i = 0; i < steps; ++i) simulation->single_step();
    } catch (const RunError &) {
      return std::numeric_limits<double>::infinity();
    }
    double largest = 0;
    for (const Column &column : simulation->snapshot().columns)
      if (column.name == "velocity")
        for (double v : column.values) largest = std::max(largest, std::abs(v));
    return largest;
  }
  Scene scene;
  std::unique_ptr<AnySimulation> simulation;
};

TEST(ExplicitDrag, limits_the_step_as_the_closed_form_says_and_implicit_drag_does_not) {
  constexpr double n = 0.3, grains = 2650, water = 1000, viscosity = 1e-3;
  const double free = Layer({}).simulation->critical_step();
  for (const char *permeability : {"1e-8", "1e-11", "1e-14"}) {
    const std::string k = std::string("body.soil.permeability=") + permeability;
    const double rate =
        n * ((1 - n) * grains + n * water) * viscosity / ((1 - n) * grains * water * std::stod(permeability));
    EXPECT_NEAR(Layer({k, "water.drag=explicit"}).simulation->critical_step() / with_explicit_drag(free, rate), 1, 1e-4)
        << k;  // water is denser under pressure, by 5e-5
    EXPECT_EQ(Layer({k}).simulation->critical_step(), free) << k;
  }
}

// Speeds of the consolidating layer are of the order of q / (rho c), 1 mm/s.
TEST(ExplicitDrag, holds_at_its_step_and_fails_beyond_it_where_drag_sets_it) {
  for (const char *k : {"body.soil.permeability=1e-8", "body.soil.permeability=1e-11", "body.soil.permeability=1e-14"})
    EXPECT_LT(Layer({k, "water.drag=explicit", "integrator.fraction=1"}).speed_after(400), 0.05) << k;
  for (const char *k : {"body.soil.permeability=1e-12", "body.soil.permeability=1e-14"}) {
    const double step = Layer({k, "water.drag=explicit"}).simulation->critical_step();
    const std::string longer = "integrator.step=" + std::to_string(1.1 * step * 1e12) + "e-12";
    EXPECT_GT(Layer({k, "water.drag=explicit", "integrator.limit=2", longer}).speed_after(400), 1e6) << k;
    EXPECT_LT(Layer({k, "integrator.fraction=1"}).speed_after(400), 0.05) << k;
  }
}

// The rate is that of the present saturation: dry soil hardly conducts.
TEST(ExplicitDrag, shortens_the_step_further_in_unsaturated_soil) {
  const std::vector<std::string> dry = {"phases=unsaturated",
                                        "water.suction=50e3",
                                        "body.soil.retention.curve=van_genuchten",
                                        "body.soil.retention.reference_suction=10e3",
                                        "body.soil.retention.shape=0.5",
                                        "body.soil.relative_permeability.curve=van_genuchten_mualem",
                                        "body.soil.relative_permeability.shape=0.5",
                                        "water.table=[[0, -1], [1, -1]]",
                                        "water.excess=0",
                                        "body.soil.permeability=1e-12",
                                        "water.drag=explicit"};
  std::vector<std::string> wet = dry;
  wet[1] = "water.suction=1e3";
  const double of_dry = Layer(dry).simulation->critical_step(), of_wet = Layer(wet).simulation->critical_step();
  EXPECT_LT(of_dry, 0.1 * of_wet);
  EXPECT_GT(of_dry, 0);
}

/// A column under rain that fills its top cells, with particles as points and a remap every step.
struct Wetting {
  explicit Wetting(const char *storage) {
    Scene scene = read_scene(
        TALUS_WETTING, {"mesh.size=0.1", "stage.0.duration=0.3", "output.interval=0", "output.history_interval=0.01",
                        "transfer.pore_smoothing=none", "transfer.integration=particle",
                        "transfer.average_stress=false", "transfer.locking=none", "transfer.remap_interval=0",
                        "transfer.relaxation=0", std::string("water.storage=") + storage});
    const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, Layer::options());
    simulation->run();
    const HistoryTable &history = simulation->history();
    stored = history.column("water_kg").front(), gained = history.column("water_kg").back() - stored,
    error = history.column("water_error_kg").back();
    for (const Column &column : simulation->snapshot().columns)
      if (column.name == "pore_pressure") lowest = *std::min_element(column.values.begin(), column.values.end());
  }
  double stored, gained, error, lowest;
};

// The driest soil at the start is at -36 kPa, and rain does not dry it.
TEST(NaiveStorage, loses_water_near_saturation_where_masses_keep_it) {
  const Wetting by_mass("mass"), by_rate("rate");
  EXPECT_LT(std::abs(by_mass.error), 1e-11 * by_mass.stored);
  EXPECT_GT(by_mass.lowest, -37e3);
  EXPECT_LT(by_rate.error, -by_mass.gained) << "more is lost than the column should have gained";
  EXPECT_LT(by_rate.lowest, -45e3);
}

}  // namespace
}  // namespace talus
