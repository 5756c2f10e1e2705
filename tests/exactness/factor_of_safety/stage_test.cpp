// The factor of safety as a stage among others: it judges the soil as the stages before left it, and leaves it so.
#include "scene/stage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/read_file.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"
#include "tests/unit/output/fixtures.h"

namespace talus {
namespace {

/// A vertical cut in which water rises in the stage `rise`.
const std::string cut = R"(
phases = "drained"
gravity = 10
[mesh]
section = "box.csv"
size = 0.25
[body.soil]
region = "soil"
density = 2000
law = "mohr_coulomb"
young_modulus = 10e6
poisson_ratio = 0.3
cohesion = 9e3
friction_angle = 20
dilation_angle = 20
[boundary.base]
kind = "fixed"
[boundary.left]
kind = "roller"
[water]
table = [[-1, -1], [2, -1]]
level = [[0, 0], [1, 0], [2, 1.5]]
open_water_load = false
)";
const std::string load = "[[stage]]\nname = \"load\"\nkind = \"quasi_static\"\nduration = 1\n",
                  rise = "[[stage]]\nname = \"rise\"\nkind = \"quasi_static\"\nduration = 1\n",
                  move = "[[stage]]\nname = \"move\"\nduration = 0.02\n";
std::string factor(const std::string &name) {
  return "[[stage]]\nname = \"" + name + "\"\nkind = \"factor_of_safety\"\n";
}

struct Done {
  Snapshot state;
  std::vector<Event> events;
  std::vector<double> factors() const {
    std::vector<double> found;
    for (const Event &event : events)
      if (event.kind == std::string(event::factor_of_safety))
        for (const auto &[name, value] : event.values)
          if (name == std::string("factor")) found.push_back(value);
    return found;
  }
};
Done run(const std::string &stages, bool gauss_points = true, const std::string &directory = "", bool resume = false) {
  const Scene scene = parse_scene(cut + stages, std::string(TALUS_MESHES) + "/scene.toml");
  RunOptions options;
  options.pictures = options.screen = false, options.gauss_points = gauss_points;
  options.directory = directory, options.resume = resume;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  return {simulation->snapshot(), simulation->events()};
}

void expect_same(const Snapshot &a, const Snapshot &b) {
  ASSERT_EQ(a.columns.size(), b.columns.size());
  for (size_t c = 0; c < a.columns.size(); ++c) {
    const std::vector<double> &one = a.columns[c].values, &other = b.columns[c].values;
    ASSERT_EQ(one.size(), other.size()) << a.columns[c].name;
    double scale = 0;
    for (const double value : one) scale = std::max(scale, std::abs(value));
    for (size_t k = 0; k < one.size(); ++k)
      ASSERT_NEAR(one[k], other[k], 1e-12 * scale) << a.columns[c].name << " " << k;
  }
}

TEST(FactorStage, finds_before_and_after_a_rise_of_water_what_two_runs_find) {
  const std::vector<double> both = run(load + factor("dry") + rise + factor("wet")).factors(),
                            dry = run(load + factor("dry")).factors(), wet = run(load + rise + factor("wet")).factors();
  ASSERT_EQ(both.size(), 2u);
  ASSERT_EQ(dry.size(), 1u);
  ASSERT_EQ(wet.size(), 1u);
  EXPECT_NEAR(both[0], dry[0], 1e-12);
  EXPECT_NEAR(both[1], wet[0], 1e-12);
  EXPECT_LT(wet[0], 0.95 * dry[0]) << "water takes strength";
}

/// Equilibrium, and motion, which would begin with other stress or at another step.
TEST(FactorStage, leaves_the_soil_to_later_stages_as_it_was) {
  expect_same(run(load + rise).state, run(load + factor("dry") + rise).state);
  expect_same(run(load + move, false).state, run(load + factor("dry") + move, false).state);
  expect_same(run(load, false).state, run(load + factor("dry"), false).state);
}

TEST(FactorStage, writes_files_of_its_own_and_is_not_repeated_by_a_resumed_run) {
  const SharedFolder folder;
  const std::string results = folder / "run", stages = load + factor("dry") + rise + factor("wet");
  (void)run(stages, false, results);
  MPI_Barrier(MPI_COMM_WORLD);  // the first rank writes
  for (const char *file : {"/factor_of_safety_dry.csv", "/factor_of_safety_dry.json", "/factor_of_safety.csv",
                           "/factor_of_safety.json", "/factor_of_safety_slip_surfaces.csv"})
    EXPECT_TRUE(std::filesystem::exists(results + file)) << file;
  const std::string log = read_file(results + "/run.log");
  MPI_Barrier(MPI_COMM_WORLD);
  (void)run(stages, false, results, true);
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string more = read_file(results + "/run.log").substr(log.size());
  EXPECT_EQ(more.find("strength divided by"), std::string::npos) << more;
  EXPECT_NE(more.find("nothing was left to do"), std::string::npos) << more;
}

/// Sand and fill without dilation on soft clay, on which Newton's iterations lead nowhere: the soil creeps to rest.
/// Load steps that become smaller and smaller take 301 iterations here, and 902 in cells of 1 m.
TEST(Stage, of_gravity_without_dilation_takes_few_iterations) {
  Scene scene = read_scene(TALUS_HALVES "/soft_clay.toml");
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  double iterations = 0;
  bool crept = false;
  for (const Event &event : simulation->events()) {
    if (event.kind != std::string(event::equilibrium)) continue;
    crept = event.text.find("the soil crept to rest") != std::string::npos;
    for (const auto &[name, value] : event.values)
      if (name == std::string("iterations")) iterations = value;
  }
  EXPECT_TRUE(crept);
  EXPECT_GT(iterations, 0);
  EXPECT_LE(iterations, 60);
}

}  // namespace
}  // namespace talus
