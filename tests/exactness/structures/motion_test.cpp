// Bars in motion: what a nail holds of a block that slides away, what tears and what is drawn out, and that ranks and
// resumed runs agree.
#include <cstring>

#include "base/temporary_folder.h"
#include "solved.h"

namespace talus {
namespace {

/// A block that is drawn to the right on a smooth base, and an anchor from it into a block that stands.
std::string blocks(const std::string &anchor) {
  return std::string("[mesh]\nsection = \"") + TALUS_BLOCKS + R"("
size = 0.25
[body.left]
region = "left"
density = 2000
law = "linear_elastic"
young_modulus = "20 MPa"
poisson_ratio = 0.3
[body.right]
region = "right"
density = 2000
law = "linear_elastic"
young_modulus = "20 MPa"
poisson_ratio = 0.3
body_acceleration = ["2", "0"]
[boundary.base]
kind = "roller"
[boundary.left]
kind = "fixed"
[structure.anchor]
kind = "anchor"
points = [[2.4, 0.45], [0.2, 0.45]]
spacing = 1
tensile_capacity = 1e5
axial_stiffness = 2e6
free_length = 1.6
)" + anchor +
         R"(
[output]
interval = 0
history_interval = 0.02
[output.point.block]
position = [2.5, 0.5]
[[stage]]
name = "slide"
duration = 1
)";
}
const std::string held_by = "bond_strength = 4000\n";  // 0.6 m of it: 2400 N of the 4000 N that drive the block

double slope(const HistoryTable &history, const std::string &column, double from, double to) {
  const std::vector<double> time = history.column("time_s"), value = history.column(column);
  double t = 0, v = 0, tt = 0, tv = 0, n = 0;
  for (size_t k = 0; k < time.size(); ++k)
    if (time[k] >= from && time[k] <= to)
      t += time[k], v += value[k], tt += time[k] * time[k], tv += time[k] * value[k], n += 1;
  return (tv - t * v / n) / (tt - t * t / n);
}

/// The bond times the length that is still in the ground, and the block feels just this.
TEST(BarsInMotion, a_nail_holds_its_pull_out_force) {
  const Solved solved = solve(blocks(held_by));
  const std::vector<double> time = solved.history.column("time_s"),
                            force = solved.history.column("anchor_head_force_N"),
                            slip = solved.history.column("anchor_bond_slip_m"),
                            speed = solved.history.column("block_velocity_m_s");
  double impulse = 0, speed_before = 0;
  for (size_t k = 1; k < time.size(); ++k) {
    if (time[k] < 0.4) continue;
    EXPECT_NEAR(force[k], 4000 * (0.6 + slip[k]), 0.002 * 2400) << time[k];  // slip of one step, and of an elastic bar
    if (impulse == 0) speed_before = speed[k - 1];
    impulse += (4000 - (force[k] + force[k - 1]) / 2) * (time[k] - time[k - 1]);
  }
  EXPECT_NEAR(2000 * (speed.back() - speed_before) / impulse, 1, 0.01);
  EXPECT_LT(slip.back(), -0.1);
}

TEST(BarsInMotion, an_anchor_that_bears_more_than_the_load_holds_the_block) {
  const Solved solved = solve(blocks("bond_strength = 40000\n"), {"stage.slide.damping=0.5", "stage.slide.duration=3"});
  EXPECT_NEAR(solved.history.column("anchor_head_force_N").back() / 4000, 1, 0.01);
  EXPECT_LT(std::abs(solved.history.column("block_velocity_m_s").back()), 1e-3);
}

TEST(BarsInMotion, what_tore_bears_nothing) {
  const Solved solved =
      solve(blocks("bond_strength = 40000\nrupture_strain = 0.02\n"), {"structure.anchor.tensile_capacity=1500"});
  const std::vector<double> force = solved.history.column("anchor_head_force_N");
  EXPECT_NEAR(*std::max_element(force.begin(), force.end()), 1500, 1e-6);
  EXPECT_EQ(force.back(), 0);
  EXPECT_NEAR(slope(solved.history, "block_velocity_m_s", 0.7, 1) / 2, 1, 0.01);
}

TEST(BarsInMotion, all_ranks_give_the_same) {
  const std::string text = blocks("diameter = 0.1\nbond_adhesion = 3e3\nbond_friction_angle = 20\n");
  const std::vector<std::string> set{"stage.slide.duration=0.2"};
  const Solved together = solve(text, set), alone = solve(text, set, PETSC_COMM_SELF);
  for (const char *column : {"anchor_axial_force_N", "anchor_bond_slip_m", "block_velocity_m_s"}) {
    const double one = alone.history.column(column).back();
    EXPECT_NEAR(together.history.column(column).back(), one, 1e-7 * std::abs(one)) << column;
    EXPECT_NE(one, 0) << column;
  }
}

/// Motion takes over what finite elements with the same shape functions have found: nothing swings.
TEST(BarsInMotion, goes_on_from_finite_elements) {
  const Solved solved = solve("gravity = 10\n" + box + R"(density = 2000
[boundary.base]
kind = "fixed"
[quasi_static]
elements = "patches"
[structure.anchor]
kind = "anchor"
points = [[0.5, 1], [0.5, 0.2]]
spacing = 1
axial_stiffness = 1e7
tensile_capacity = 1e6
free_length = 0.4
prestress = 5000
diameter = 0.1
bond_adhesion = 6e4
bond_friction_angle = 20
[output]
interval = 0
history_interval = 0.02
[[stage]]
kind = "quasi_static"
duration = 1
[[stage]]
kind = "quasi_static"
duration = 1
add = "anchor"
[[stage]]
name = "on"
duration = 0.2
)");
  const std::vector<double> force = solved.history.column("anchor_head_force_N"),
                            time = solved.history.column("time_s");
  for (size_t k = 0; k < time.size(); ++k)
    if (time[k] > 2) {
      EXPECT_NEAR(force[k] / 5000, 1, 1e-3) << time[k];
    }
  EXPECT_GT(time.back(), 2.1);
}

/// A run that goes on from its checkpoint is the run that was not interrupted, to the bit.
TEST(BarsInMotion, resumed_runs_keep_what_slipped) {
  TemporaryFolder folder;
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  ASSERT_TRUE(rank > 0 || folder.make());
  char path[4096] = "";
  std::strncpy(path, folder.path().c_str(), sizeof path - 1);
  MPI_Bcast(path, sizeof path, MPI_CHAR, 0, PETSC_COMM_WORLD);
  RunOptions options;
  options.directory = std::string(path) + "/run", options.pictures = options.screen = false;
  const auto history = [](const std::string &text, const RunOptions &with) {
    const Scene scene = parse_scene(text, "blocks");
    const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, with);
    simulation->run();
    return simulation->history();
  };
  const std::string more = "[[stage]]\nname = \"on\"\nduration = 0.2\n";
  std::string half = blocks(held_by);
  half.replace(half.rfind("duration = 1"), 12, "duration = 0.3");
  history(half, options);
  RunOptions none;
  none.pictures = none.screen = false;
  const HistoryTable whole = history(half + more, none);
  options.resume = true;
  const HistoryTable resumed = history(half + more, options);
  for (const char *column : {"anchor_axial_force_N", "anchor_bond_slip_m", "block_velocity_m_s"})
    EXPECT_EQ(resumed.column(column).back(), whole.column(column).back()) << column;
}

}  // namespace
}  // namespace talus
