// A run on several ranks is the run on one, particle by particle. Sums over nodes that ranks share are taken in another
// order, so not bit by bit: round-off grows through 200 steps of plastic soil, and 1e-10 leaves it room.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

struct Result {
  Snapshot particles;  ///< of this rank
  long long count;
  double mass, time;
};

Result after_200_steps(MPI_Comm comm, const std::string &file, const std::vector<std::string> &overrides) {
  Scene scene = read_scene(file, overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(comm, scene, options);
  for (int i = 0; i < 200; ++i) simulation->single_step();
  return {simulation->snapshot(), simulation->particles(), simulation->mass(), simulation->time()};
}

template <class T>
void tell_all(std::vector<T> &values, MPI_Datatype type) {
  int count = static_cast<int>(values.size());
  MPI_Bcast(&count, 1, MPI_INT, 0, PETSC_COMM_WORLD);
  values.resize(count);
  MPI_Bcast(values.data(), count, type, 0, PETSC_COMM_WORLD);
}

constexpr std::array compared{"position", "velocity", "stress"};

const Column &column_of(const Snapshot &snapshot, const std::string &name) {
  return *std::find_if(snapshot.columns.begin(), snapshot.columns.end(),
                       [&](const Column &c) { return c.name == name; });
}

/// Waits for the first rank without taking the core that it computes on.
void wait_for_first_rank() {
  MPI_Request all;
  MPI_Ibarrier(PETSC_COMM_WORLD, &all);
  for (int here = 0; !here; usleep(1000)) MPI_Test(&all, &here, MPI_STATUS_IGNORE);
}

/// The first rank runs the whole scene alone and tells the others: once for all tests that ask for the same scene.
const Result &alone(const std::string &file, const std::vector<std::string> &overrides) {
  static std::map<std::pair<std::string, std::vector<std::string>>, Result> found;
  const auto [place, is_new] = found.try_emplace({file, overrides});
  Result &result = place->second;
  if (!is_new) return result;
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) result = after_200_steps(PETSC_COMM_SELF, file, overrides);
  wait_for_first_rank();
  MPI_Bcast(&result.count, 1, MPI_LONG_LONG, 0, PETSC_COMM_WORLD);
  for (double *number : {&result.mass, &result.time}) MPI_Bcast(number, 1, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
  tell_all(result.particles.id, MPI_LONG_LONG);
  std::vector<Column> columns;
  for (const char *name : compared) {
    Column column = rank == 0 ? column_of(result.particles, name) : Column{name, "", "", 1, {}};
    MPI_Bcast(&column.components, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    tell_all(column.values, MPI_DOUBLE);
    columns.push_back(column);
  }
  result.particles.columns = columns;
  return result;
}

/// Largest difference of a field between particles of this rank and the same ones of the other run, over the field's
/// largest value.
double difference(const Snapshot &mine, const Snapshot &whole, const std::string &name) {
  std::map<long long, size_t> place;
  for (size_t i = 0; i < whole.id.size(); ++i) place[whole.id[i]] = i;
  const Column &a = column_of(mine, name), &b = column_of(whole, name);
  double largest = 0, scale = 0;
  for (const double value : b.values) scale = std::max(scale, std::abs(value));
  for (size_t i = 0; i < mine.id.size(); ++i)
    for (int k = 0; k < a.components; ++k)
      largest = std::max(largest,
                         std::abs(a.values[i * a.components + k] - b.values[place.at(mine.id[i]) * b.components + k]));
  return largest / scale;
}

/// `of_ranks`: overrides that make no difference to one rank.
void expect_the_same(const std::string &file, const std::vector<std::string> &overrides, double tolerance = 1e-10,
                     const std::vector<std::string> &of_ranks = {}) {
  std::vector<std::string> on_ranks = overrides;
  on_ranks.insert(on_ranks.end(), of_ranks.begin(), of_ranks.end());
  const Result &whole = alone(file, overrides);
  const Result shared = after_200_steps(PETSC_COMM_WORLD, file, on_ranks);
  EXPECT_EQ(shared.count, whole.count);
  EXPECT_NEAR(shared.mass, whole.mass, 1e-14 * whole.mass);
  EXPECT_NEAR(shared.time, whole.time, tolerance * whole.time);  // steps follow frequencies of these fields
  for (const char *field : compared)
    EXPECT_LT(difference(shared.particles, whole.particles, field), tolerance) << field;
  long long count = static_cast<long long>(shared.particles.id.size());
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_LONG_LONG, MPI_SUM, PETSC_COMM_WORLD);
  EXPECT_EQ(count, whole.count);
}

const std::string column = std::string(TALUS_GALLERY) + "/column/scene.toml",
                  slope = std::string(TALUS_EXACTNESS) + "/ranks/slope.toml",
                  wet_column = std::string(TALUS_GALLERY) + "/saturated_column/scene.toml",
                  box = std::string(TALUS_EXACTNESS) + "/../verification/closed_box/scene.toml";

TEST(Ranks, column_collapse_is_the_same) { expect_the_same(column, {"mesh.size=0.01"}); }
TEST(Ranks, column_collapse_is_the_same_on_a_base_that_heats_itself) {
  expect_the_same(column, {"mesh.size=0.01", "boundary.base.kind=heated_friction",
                           "boundary.base.friction_angle=10 + 10 * exp(-slip / 0.01)", "boundary.base.thickness=1e-4",
                           "boundary.base.hydraulic_conductivity=1e-9", "boundary.base.storage=1e-8",
                           "boundary.base.thermal_pressurisation=1e5", "boundary.base.heat_capacity=1e6"});
}
TEST(Ranks, column_collapse_is_the_same_with_a_remap_in_every_step) {
  expect_the_same(column, {"mesh.size=0.01", "transfer.remap_interval=0"});
}
TEST(Ranks, slope_that_softens_by_averaged_strain_is_the_same) {
  expect_the_same(slope, {"body.weathered.averaging_length=1.5"});
}
TEST(Ranks, slope_whose_strength_varies_with_place_is_the_same) {
  expect_the_same(slope, {"body.weathered.cohesion=1e3 + 100 * x", "body.weathered.friction_angle=24 - 0.2 * y",
                          "body.weathered.residual_cohesion=0", "body.unweathered.cohesion=5e3 + 300 * (14 - y)"});
}
TEST(Ranks, slope_whose_soils_are_damped_differently_is_the_same) {
  expect_the_same(slope, {"body.weathered.damping_ratio=0.1", "body.unweathered.damping_ratio=0.03",
                          "stage.0.damping_frequencies=[1, 8]"});
}
TEST(Ranks, slope_of_hysteretic_soil_is_the_same) {
  expect_the_same(slope, {"body.weathered.law=hysteretic_mohr_coulomb", "body.weathered.reference_strain=1e-3"});
}
TEST(Ranks, column_collapse_is_the_same_with_particle_stress) {
  expect_the_same(column, {"mesh.size=0.01", "transfer.average_stress=false", "transfer.locking=nodal"});
}
TEST(Ranks, column_collapse_is_the_same_in_3d) {
  const std::string k0 = "\"-9.81 * 2650 * (0.1 - y) * 0.3 / 0.7\"";
  expect_the_same(
      column, {"mesh.size=0.02", "dimension=3", "mesh.layers=0", "mesh.thickness=0.06", "boundary.front.kind=roller",
               "boundary.back.kind=roller", "output.point.corner.position=[0.2, 0.1, 0]",
               "body.bars.stress=[" + k0 + ", \"-9.81 * 2650 * (0.1 - y)\", " + k0 + ", \"0\", \"0\", \"0\"]"});
}
/// Cells whose edges ranks have halved.
const std::vector<std::string> halved_3d{"mesh.size=0.05",
                                         "mesh.halvings=1",
                                         "dimension=3",
                                         "mesh.layers=0",
                                         "mesh.thickness=0.1",
                                         "boundary.front.kind=roller",
                                         "boundary.back.kind=roller",
                                         "output.point.corner.position=[0.2, 0.1, 0]",
                                         "body.bars.stress=[\"0\", \"0\", \"0\", \"0\", \"0\", \"0\"]"};
TEST(Ranks, column_collapse_is_the_same_in_halved_cells) {
  expect_the_same(column, {"mesh.size=0.04", "mesh.halvings=2"});
}
TEST(Ranks, column_collapse_is_the_same_in_halved_cells_in_3d) { expect_the_same(column, halved_3d); }
TEST(Ranks, column_collapse_is_the_same_with_steps_by_the_frequency_of_the_mesh) {
  expect_the_same(column, {"mesh.size=0.01", "integrator.omega_max=mesh"});
}
TEST(Ranks, column_of_wet_sand_is_the_same_with_steps_by_the_frequency_of_the_mesh) {
  expect_the_same(wet_column, {"mesh.size=0.01", "integrator.omega_max=mesh"});
}
TEST(Ranks, column_collapse_is_the_same_under_error_control) {
  expect_the_same(column, {"mesh.size=0.01", "integrator.kind=arkode", "integrator.velocity_tolerance=1e-5"});
}
TEST(Ranks, soil_and_water_in_a_closed_box_are_the_same) { expect_the_same(box, {}); }
TEST(Ranks, soil_and_water_in_a_closed_box_are_the_same_under_error_control) {
  expect_the_same(box, {"integrator.kind=arkode"});
}
TEST(Ranks, column_collapse_is_the_same_with_the_steps_of_petsc) {
  expect_the_same(column, {"mesh.size=0.02", "integrator.kind=petsc"});
}
TEST(Ranks, moist_soil_in_a_closed_box_is_the_same) {
  expect_the_same(box, {"phases=unsaturated", "water.table=[[0, 0.5], [1, 0.5]]"});
}
TEST(Ranks, soil_water_and_gas_in_a_closed_box_are_the_same) {
  expect_the_same(box, {"phases=three-phase", "water.table=[[0, 0.5], [1, 0.5]]"});
}
TEST(Ranks, column_of_wet_sand_is_the_same) {
  for (const std::string phases : {"saturated", "unsaturated", "three-phase"}) {
    SCOPED_TRACE(phases);
    expect_the_same(wet_column, {"mesh.size=0.01", "phases=" + phases, "body.sand.retention.curve=van_genuchten",
                                 "body.sand.retention.reference_suction=500", "body.sand.retention.shape=0.5",
                                 "boundary.rain.kind=rainfall", "boundary.rain.group=free_surface",
                                 "boundary.rain.intensity=0.01"});
  }
}
/// Round-off may end conjugate gradients an iteration sooner: what is left of the residual then differs.
TEST(Ranks, column_of_wet_sand_is_the_same_with_implicit_pressure) {
  expect_the_same(wet_column, {"mesh.size=0.01", "water.pressure=implicit", "water.bulk_modulus=2.2e9"}, 1e-4);
}
/// A round of Newton's method more or less, where pores become full, leaves another residual too: 9e-3 on four ranks,
/// and within 1e-3 with a thousandth of the residual.
TEST(Ranks, column_of_moist_sand_in_rain_is_the_same_with_implicit_pressure) {
  expect_the_same(wet_column,
                  {"mesh.size=0.01", "phases=unsaturated", "body.sand.retention.curve=van_genuchten",
                   "body.sand.retention.reference_suction=500", "body.sand.retention.shape=0.5",
                   "boundary.rain.kind=rainfall", "boundary.rain.group=free_surface", "boundary.rain.intensity=0.01",
                   "water.pressure=implicit", "water.bulk_modulus=2.2e9"},
                  2e-2);
}
TEST(Ranks, drained_slope_of_two_soils_is_the_same) { expect_the_same(slope, {}); }

/// The example of the guide's page on terrain, coarser. Its 200 steps are 18 s, in which the soil runs over the lip of
/// its scarp: that amplifies round-off, to 3e-10 of the largest stress.
TEST(Ranks, slide_on_terrain_is_the_same) { expect_the_same(TALUS_GUIDE "/valley.toml", {"mesh.size=12"}, 3e-9); }

/// The same where the mesh is divided anew at every remap: everything moves from rank to rank again and again.
void expect_the_same_when_balanced(const std::string &file, const std::vector<std::string> &overrides) {
  expect_the_same(file, overrides, 1e-10, {"mesh.balance_ranks=always"});
}
TEST(Balanced, column_collapse_is_the_same) { expect_the_same_when_balanced(column, {"mesh.size=0.01"}); }
TEST(Balanced, column_collapse_is_the_same_on_a_base_that_heats_itself) {
  expect_the_same_when_balanced(
      column, {"mesh.size=0.01", "boundary.base.kind=heated_friction",
               "boundary.base.friction_angle=10 + 10 * exp(-slip / 0.01)", "boundary.base.thickness=1e-4",
               "boundary.base.hydraulic_conductivity=1e-9", "boundary.base.storage=1e-8",
               "boundary.base.thermal_pressurisation=1e5", "boundary.base.heat_capacity=1e6"});
}
TEST(Balanced, column_collapse_is_the_same_with_particle_stress) {
  expect_the_same_when_balanced(column, {"mesh.size=0.01", "transfer.average_stress=false", "transfer.locking=nodal"});
}
TEST(Balanced, column_collapse_is_the_same_with_steps_by_the_frequency_of_the_mesh) {
  expect_the_same_when_balanced(column, {"mesh.size=0.01", "integrator.omega_max=mesh"});
}
TEST(Balanced, column_collapse_is_the_same_under_error_control) {
  expect_the_same_when_balanced(column,
                                {"mesh.size=0.01", "integrator.kind=arkode", "integrator.velocity_tolerance=1e-5"});
}
TEST(Balanced, slope_that_softens_by_averaged_strain_is_the_same) {
  expect_the_same_when_balanced(slope, {"body.weathered.averaging_length=1.5", "transfer.remap_interval=0.01"});
}
TEST(Balanced, column_of_wet_sand_is_the_same) {
  for (const std::string phases : {"saturated", "unsaturated", "three-phase"}) {
    SCOPED_TRACE(phases);
    expect_the_same_when_balanced(
        wet_column,
        {"mesh.size=0.01", "phases=" + phases, "body.sand.retention.curve=van_genuchten",
         "body.sand.retention.reference_suction=500", "body.sand.retention.shape=0.5", "boundary.rain.kind=rainfall",
         "boundary.rain.group=free_surface", "boundary.rain.intensity=0.01", "transfer.remap_interval=0.01"});
  }
}
TEST(Balanced, column_collapse_is_the_same_in_3d) {
  expect_the_same_when_balanced(
      column, {"mesh.size=0.025", "dimension=3", "mesh.layers=0", "mesh.thickness=0.05", "boundary.front.kind=roller",
               "boundary.back.kind=roller", "output.point.corner.position=[0.2, 0.1, 0]",
               "body.bars.stress=[\"0\", \"0\", \"0\", \"0\", \"0\", \"0\"]"});
}

TEST(Balanced, column_collapse_is_the_same_in_halved_cells) {
  expect_the_same_when_balanced(column, {"mesh.size=0.04", "mesh.halvings=2"});
}
TEST(Balanced, column_collapse_is_the_same_in_halved_cells_in_3d) { expect_the_same_when_balanced(column, halved_3d); }

/// Above the terrain of the guide, ten times the air: ranks share the soil and not the cells, as evenly as patches of 8
/// cells with 8 particles each, which are never divided, allow.
TEST(Ranks, soil_is_shared_evenly_whatever_air_there_is) {
  Scene scene = read_scene(TALUS_GUIDE "/valley.toml", {"mesh.size=12", "mesh.terrain.air=300"});
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  long long most = static_cast<long long>(simulation->snapshot().id.size());
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_LONG_LONG, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_LT(static_cast<double>(most - 64) * ranks, 1.05 * static_cast<double>(simulation->particles()));
}

/// The slope of the guide, coarse and weaker, until it fails; the event's time is when the crest passed the threshold
/// [s].
double failure_time(MPI_Comm comm) {
  Scene scene =
      read_scene(TALUS_GUIDE "/slope.toml", {"mesh.size=1", "body.clay.cohesion=5e3", "stage.slide.duration=0"});
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(comm, scene, options);
  simulation->run();
  for (const Event &event : simulation->events())
    if (event.kind == event::failure) return event.load_time;
  return -1;
}

// Round-off that ranks add in another order is amplified once the slope runs away; when it does is the result.
TEST(Ranks, a_softening_slope_fails_at_the_same_time) {
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  double alone = rank == 0 ? failure_time(PETSC_COMM_SELF) : 0;
  wait_for_first_rank();
  MPI_Bcast(&alone, 1, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
  const double shared = failure_time(PETSC_COMM_WORLD);
  EXPECT_GT(alone, 5);
  EXPECT_NEAR(shared, alone, 0.01 * alone);
}

}  // namespace
}  // namespace talus
