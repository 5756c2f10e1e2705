// Steps take no memory from the heap once the soil has been seen everywhere it goes: every call of malloc, by whatever
// road, is counted.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace {
std::atomic<long long> calls{0};
}

// glibc's own functions stand behind these; operator new and PETSc call them.
extern "C" {
void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);
void *__libc_memalign(size_t, size_t);
void *malloc(size_t size) { return ++calls, __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return ++calls, __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { return ++calls, __libc_realloc(old, size); }
void *memalign(size_t alignment, size_t size) { return ++calls, __libc_memalign(alignment, size); }
void *aligned_alloc(size_t alignment, size_t size) { return ++calls, __libc_memalign(alignment, size); }
int posix_memalign(void **memory, size_t alignment, size_t size) {
  return ++calls, (*memory = __libc_memalign(alignment, size)) ? 0 : 12;
}
}

namespace talus {
namespace {

struct Count {
  long long steps = 0, remaps = 0, in_steps = 0, in_remaps = 0;
};

/// Calls in steps with and without a remap, after a warm-up in which every buffer has found its size.
Count count(const std::string &file, const std::vector<std::string> &overrides, int warm_up, int steps) {
  Scene scene = read_scene(file, overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  for (int i = 0; i < warm_up; ++i) simulation->single_step();
  Count count;
  for (int i = 0; i < steps; ++i) {
    const long long before = calls, remaps = simulation->remaps();
    simulation->single_step();
    const long long taken = calls - before;
    if (simulation->remaps() == remaps)
      ++count.steps, count.in_steps += taken;
    else
      ++count.remaps, count.in_remaps += taken;
  }
  return count;
}

const std::string column = std::string(TALUS_GALLERY) + "/column/scene.toml",
                  slope = std::string(TALUS_EXACTNESS) + "/ranks/slope.toml",
                  wet_column = std::string(TALUS_GALLERY) + "/saturated_column/scene.toml",
                  loaded = std::string(TALUS_EXACTNESS) + "/../verification/loaded_face/scene.toml",
                  wet_block = std::string(TALUS_EXACTNESS) + "/../verification/wet_incline/scene.toml";

TEST(Allocations, are_counted) {
  const long long before = calls;
  std::vector<double> some(1000, 1.);
  EXPECT_GT(calls, before) << some[0];
}

TEST(Allocations, none_between_remaps_of_a_collapsing_column) {
  const Count c = count(column, {"mesh.size=0.01"}, 400, 100);
  EXPECT_GT(c.steps, 50);
  EXPECT_EQ(c.in_steps, 0);
}

TEST(Allocations, none_between_remaps_of_a_damped_column) {
  for (const char *integrator : {"integrator.kind=euler", "integrator.kind=arkode"}) {
    const Count c = count(
        column, {"mesh.size=0.01", "body.bars.damping_ratio=0.05", "stage.0.damping_frequencies=[5, 20]", integrator},
        400, 100);
    EXPECT_GT(c.steps, 50);
    EXPECT_EQ(c.in_steps, 0) << integrator;
  }
}

TEST(Allocations, none_during_remaps_of_a_collapsing_column) {
  const Count c = count(column, {"mesh.size=0.01", "transfer.remap_interval=0"}, 2000, 100);
  EXPECT_EQ(c.remaps, 100);
  EXPECT_EQ(c.in_remaps, 0);
}

TEST(Allocations, none_on_a_base_that_heats_itself) {
  std::vector<std::string> heated{"mesh.size=0.01",
                                  "boundary.base.kind=heated_friction",
                                  "boundary.base.friction_angle=10 + 10 * exp(-slip / 0.01)",
                                  "boundary.base.thickness=1e-4",
                                  "boundary.base.hydraulic_conductivity=1e-9",
                                  "boundary.base.storage=1e-8",
                                  "boundary.base.thermal_pressurisation=1e5"};
  const Count between = count(column, heated, 400, 100);
  EXPECT_GT(between.steps, 50);
  EXPECT_EQ(between.in_steps, 0);
  heated.emplace_back("transfer.remap_interval=0");
  const Count during = count(column, heated, 4000, 100);
  EXPECT_EQ(during.remaps, 100);
  EXPECT_EQ(during.in_remaps, 0);
}

TEST(Allocations, none_beside_rigid_bodies) {
  std::vector<std::string> bodies{"mesh.size=0.01",
                                  "rigid.wall.friction_angle=20",
                                  "rigid.block.friction_angle=20",
                                  "rigid.wall.polygon=[[0.25, -0.01], [0.27, -0.01], [0.27, 0.1], [0.25, 0.1]]",
                                  "rigid.block.polygon=[[0.05, 0.1], [0.1, 0.1], [0.1, 0.12], [0.05, 0.12]]",
                                  "rigid.block.density=1000"};
  const Count between = count(column, bodies, 1000, 100);
  EXPECT_GT(between.steps, 50);
  EXPECT_EQ(between.in_steps, 0);
  bodies.emplace_back("transfer.remap_interval=0");
  const Count during = count(column, bodies, 4000, 100);
  EXPECT_EQ(during.remaps, 100);
  EXPECT_EQ(during.in_remaps, 0);
}

TEST(Allocations, none_in_steps_and_remaps_under_error_control) {
  const Count c = count(column, {"mesh.size=0.01", "integrator.kind=arkode"}, 1500, 200);
  EXPECT_GT(c.steps, 50);
  EXPECT_GT(c.remaps, 1);
  EXPECT_EQ(c.in_steps, 0);
  EXPECT_EQ(c.in_remaps, 0);
}

TEST(Allocations, none_where_steps_follow_the_frequency_of_the_mesh) {
  const Count c = count(column, {"mesh.size=0.01", "integrator.omega_max=mesh"}, 1000, 200);
  EXPECT_GT(c.remaps, 1);
  EXPECT_EQ(c.in_steps, 0);
  EXPECT_EQ(c.in_remaps, 0);
}

TEST(Allocations, none_in_a_drained_slope_of_two_soils) {
  const Count c = count(slope, {"transfer.remap_interval=0.1"}, 1000, 200);
  EXPECT_GT(c.steps, 10);
  EXPECT_GT(c.remaps, 1);
  EXPECT_EQ(c.in_steps, 0);
  EXPECT_EQ(c.in_remaps, 0);
}

TEST(Allocations, none_where_pore_fluids_move) {
  const std::vector<std::string> curves = {"body.sand.retention.curve=van_genuchten",
                                           "body.sand.retention.reference_suction=500",
                                           "body.sand.retention.shape=0.5",
                                           "body.sand.relative_permeability.curve=van_genuchten_mualem",
                                           "body.sand.relative_permeability.shape=0.5",
                                           "water.stress=bishop"};
  for (const std::string phases : {"saturated", "unsaturated", "three-phase"}) {
    std::vector<std::string> overrides{"mesh.size=0.01", "phases=" + phases};
    if (phases != "saturated") overrides.insert(overrides.end(), curves.begin(), curves.end());
    const Count c = count(wet_column, overrides, phases == "three-phase" ? 15000 : 3000, 400);
    EXPECT_GT(c.steps, 10) << phases;
    EXPECT_GT(c.remaps, 1) << phases;
    EXPECT_EQ(c.in_steps, 0) << phases;
    EXPECT_EQ(c.in_remaps, 0) << phases;
  }
}

TEST(Allocations, none_where_pore_pressure_is_implicit) {
  const std::vector<std::string> curves = {"body.sand.retention.curve=van_genuchten",
                                           "body.sand.retention.reference_suction=500",
                                           "body.sand.retention.shape=0.5"};
  for (const std::string phases : {"saturated", "unsaturated"}) {
    std::vector<std::string> overrides{"mesh.size=0.01", "phases=" + phases, "water.pressure=implicit"};
    if (phases != "saturated") overrides.insert(overrides.end(), curves.begin(), curves.end());
    const Count c = count(wet_column, overrides, 1000, 400);
    EXPECT_GT(c.steps, 10) << phases;
    EXPECT_GT(c.remaps, 1) << phases;
    EXPECT_EQ(c.in_steps, 0) << phases;
    EXPECT_EQ(c.in_remaps, 0) << phases;
  }
}

TEST(Allocations, none_under_loads_that_move_with_a_face) {
  const Count c = count(loaded, {}, 300, 200);
  EXPECT_GT(c.steps, 10);
  EXPECT_GT(c.remaps, 1);
  EXPECT_EQ(c.in_steps, 0);
  EXPECT_EQ(c.in_remaps, 0);
}

TEST(Allocations, none_on_a_base_that_rubs_with_wet_grains) {
  const Count c = count(wet_block, {}, 1500, 200);
  EXPECT_GT(c.steps, 10);
  EXPECT_EQ(c.in_steps, 0);
  EXPECT_EQ(c.in_remaps, 0);
}

}  // namespace
}  // namespace talus
