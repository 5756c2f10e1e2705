// Sand that dilates as it slumps, or comes apart: its volume is the same whether the stage softens or not and after a
// reset, without what opens, and the step follows its density. The sand is a column of 2 m x 1 m on a rough floor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

/// The scene of a column whose sand has these keys, its stages and the size of its cells [m].
Scene scene_of(const std::string &sand, const std::string &stages, double size = 0.125) {
  return parse_scene("dimension = 2\ngravity = 9.81\n[mesh]\nsection = \"dam.csv\"\nsize = " + std::to_string(size) +
                         "\n[body.soil]\nregion = \"soil\"\ndensity = 1800\nlaw = \"mohr_coulomb\"\nyoung_modulus = "
                         "\"2 MPa\"\npoisson_ratio = 0.3\ncohesion = 0\nfriction_angle = 33\n" +
                         sand +
                         "\n[boundary.base]\nkind = \"fixed\"\n[boundary.left]\nkind = \"roller\"\n[boundary.right]\n"
                         "kind = \"roller\"\n" +
                         stages + "[output]\nhistory_interval = 0.005\n",
                     std::string(TALUS_MESHES) + "/scene.toml");
}

struct Outcome {
  double growth;                       ///< volume of all soil over that at the start
  double dilation;                     ///< its largest
  double shortest_step, longest_step;  ///< [s]
  HistoryTable history;
};

Outcome outcome_of(const Scene &scene) {
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const double mass = simulation->mass(), start = mass / 1800;
  simulation->run();
  const Snapshot now = simulation->snapshot();
  double volume = 0, most = 0;
  for (const double v : std::ranges::find(now.columns, "volume", &Column::name)->values) volume += v;
  for (const double d : std::ranges::find(now.columns, "dilation", &Column::name)->values) most = std::max(most, d);
  MPI_Allreduce(MPI_IN_PLACE, &volume, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  const auto number = [&](const char *name) {
    return std::ranges::find(now.numbers, name, &std::pair<std::string, double>::first)->second;
  };
  return {volume / start, most, number("shortest_step_s"), number("longest_step_s"), simulation->history()};
}

/// Energy that has been created [J]: by how much what was dissipated falls again.
double created(const Outcome &outcome) {
  double most = 0, created = 0;
  for (const double dissipated : outcome.history.column("dissipated_J"))
    most = std::max(most, dissipated), created = std::max(created, most - dissipated);
  return created;
}

std::string stage(double duration, const std::string &keys) {
  return "[[stage]]\nduration = " + std::to_string(duration) + "\n" + keys + "\n";
}

/// Strength is constant here, so that a stage that does not soften moves soil alike.
TEST(Dilation, counts_in_stages_that_do_not_soften) {
  const Outcome softens = outcome_of(scene_of("dilation_angle = 10", stage(0.6, ""))),
                keeps = outcome_of(scene_of("dilation_angle = 10", stage(0.6, "softening = false")));
  EXPECT_GT(softens.growth, 1.05);
  EXPECT_NEAR(keeps.growth, softens.growth, 1e-9);
  EXPECT_NEAR(keeps.dilation, softens.dilation, 1e-9);
}

TEST(Dilation, stays_at_a_reset) {
  const Outcome reset =
      outcome_of(scene_of("dilation_angle = 10", stage(0.6, "reset_displacement = true") + stage(0.001, "")));
  EXPECT_GT(reset.growth, 1.05);
  EXPECT_GT(reset.dilation, 0.05);
}

/// 0 degrees: 0.995, soil in its own weight. Dilation that ends after a plastic strain of a fifth, by which it has
/// dilated by tan(10) / 10 or so.
TEST(Dilation, ends_where_the_law_says) {
  EXPECT_NEAR(outcome_of(scene_of("dilation_angle = 0", stage(0.6, ""))).growth, 1, 0.01);
  const Outcome ends =
      outcome_of(scene_of("dilation_angle = 10\nresidual_dilation_angle = 0\nshape_factor = 10", stage(0.6, "")));
  EXPECT_LT(ends.growth, 1.05);
  EXPECT_LT(ends.dilation, 0.1);
}

/// Soil that grows under constant mass is as light as its volume is large. With steps of the density at the start 24 J
/// are created of the 1.1 kJ that gravity has brought (and without end at 30 degrees), with its own 0.04 J.
TEST(Dilation, does_not_outgrow_the_step) {
  const Outcome grown = outcome_of(scene_of("dilation_angle = 25", stage(0.8, ""), 0.0625));
  EXPECT_GT(grown.dilation, 1);
  EXPECT_LT(created(grown), 5);
}

/// Sand without a cap that is thrown apart and falls back in a box, in cells of this size [m].
Outcome thrown_apart(double size) {
  return outcome_of(
      scene_of("dilation_angle = 0\nvolume_cap = 0\nvelocity = [\"y > 0.5 ? 1.5*x : 0\", \"x\"]\n[boundary.surface]\n"
               "kind = \"roller\"",
               stage(1, ""), size));
}

/// Without a cap soil between whose pieces gaps count is as light. Its shortest step is 0.23 of the first one, and 0.93
/// where steps only follow the cells as they deform.
TEST(Dilation, steps_follow_gaps_without_a_cap) {
  const Outcome apart = thrown_apart(0.125);
  EXPECT_GT(apart.growth, 1.1);
  EXPECT_LT(apart.shortest_step, 0.5 * apart.longest_step);
}

/// Elastic energy is that of the volumes over which stress does work. If it were that of the particles, who have gaps
/// that their cells have no room for, 31 to 800 J of the 4 kJ that gravity brings would be created on two of these
/// meshes or more; so it is at most 0.4 J. On one mesh of twenty, of sizes in between, the motion itself creates energy
/// (docs/theory/README.md, section 3).
TEST(Dilation, elastic_energy_is_that_of_the_work_in_gaps) {
  for (const double size : {0.105, 0.115, 0.125, 0.14}) EXPECT_LT(created(thrown_apart(size)), 1) << size;
}

}  // namespace
}  // namespace talus
