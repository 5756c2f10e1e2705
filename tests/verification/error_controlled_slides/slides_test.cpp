// Slides through their run-out under error control, with cells that empty, light nodes and soil that softens, in the
// plane and in 3D: the step does not collapse. Whole runs are in docs/gallery/integrators (slides.py); these are
// coarse.
#include <gtest/gtest.h>

#include <map>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

struct Outcome {
  std::map<std::string, double> numbers;
  long long steps;
  double time, moved;  ///< moved: of the followed point [m]
};

Outcome run(const std::string &file, std::vector<std::string> overrides, const std::string &point) {
  overrides.insert(overrides.end(), {"integrator.kind=arkode", "output.interval=0"});
  Scene scene = read_scene(file, overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  const Snapshot end = simulation->snapshot();
  return {{end.numbers.begin(), end.numbers.end()},
          simulation->steps(),
          simulation->time(),
          simulation->history().column(point + "_displacement_m").back()};
}

/// Steps are as many as the longest would need, within a factor that outputs and cells that shrink explain; next to
/// none is rejected.
void expect_steps_to_hold(const Outcome &o) {
  EXPECT_LT(o.steps, 1.6 * o.time / o.numbers.at("longest_step_s"));
  EXPECT_LE(o.numbers.at("rejections") + o.numbers.at("inversions"), 0.02 * o.steps);
  EXPECT_GT(o.numbers.at("steps_bounded_by_stability") + o.numbers.at("steps_bounded_by_outputs"), 0.95 * o.steps);
  EXPECT_GT(o.numbers.at("shortest_step_s"), 1e-3 * o.numbers.at("longest_step_s"));
}

const std::string column = TALUS_GALLERY "/column/scene.toml", slope = TALUS_GUIDE "/slope.toml";

TEST(ErrorControl, carries_a_column_through_its_collapse) {
  for (const char *order : {"integrator.order=3", "integrator.order=4"}) {
    const Outcome o = run(column, {"mesh.size=0.02", "stage.0.duration=0.5", order}, "corner");
    EXPECT_GT(o.moved, 0.1);
    expect_steps_to_hold(o);
  }
}

TEST(ErrorControl, carries_a_column_of_tetrahedra_through_its_collapse) {
  const std::string k0 = "\"-9.81 * 2650 * (0.1 - y) * 0.3 / 0.7\"";
  const Outcome o =
      run(column,
          {"mesh.size=0.03", "dimension=3", "mesh.layers=0", "mesh.thickness=0.06", "stage.0.duration=0.4",
           "boundary.front.kind=roller", "boundary.back.kind=roller", "output.point.corner.position=[0.2, 0.1, 0]",
           "body.bars.stress=[" + k0 + ", \"-9.81 * 2650 * (0.1 - y)\", " + k0 + ", \"0\", \"0\", \"0\"]"},
          "corner");
  EXPECT_GT(o.moved, 0.1);
  expect_steps_to_hold(o);
}

TEST(ErrorControl, carries_a_softening_slope_from_gravity_to_its_runout) {
  const Outcome o = run(slope, {"mesh.size=1", "body.clay.cohesion=5e3", "stage.slide.duration=4"}, "crest");
  EXPECT_GT(o.moved, 0.3);
  expect_steps_to_hold(o);
}

}  // namespace
}  // namespace talus
