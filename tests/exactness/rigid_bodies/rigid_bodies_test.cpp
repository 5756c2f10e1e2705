// Rigid bodies that soil meets: nothing of the momentum of a pair is lost, bodies fall, slide, stick, tip over and rest
// as rigid bodies do, on one rank and on two.
#include "physics/boundary/rigid_bodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/temporary_folder.h"
#include "look_ahead/soil.h"
#include "simulation.h"
#include "solvers/euler.h"

namespace talus {
namespace {

/// A bed of elastic soil, 2 m wide and 1 m deep, below 1 m of air, with a rigid body, whose keys are `rigid`.
std::string scene_of(const std::string &rigid, const std::string &more = "") {
  std::string text = "gravity = 9.81\n[mesh]\nsection = \"";
  text += TALUS_MESHES;
  text += R"toml(/bed.csv"
size = 0.2
[body.soil]
region = "soil"
density = 2000
law = "linear_elastic"
young_modulus = "2 MPa"
poisson_ratio = 0.3
stress = ["-8408.6 * (1 - y)", "-19620 * (1 - y)", "-8408.6 * (1 - y)", "0"]
[boundary.base]
kind = "fixed"
[boundary.left]
kind = "roller"
[boundary.right]
kind = "roller"
)toml";
  text += more;
  text += "[rigid.block]\n";
  text += rigid;
  return text + "[output]\ninterval = 0\nhistory_interval = 0.01\n";
}

const std::string stage = "[[stage]]\nduration = ";
const std::string block = "polygon = [[0.7, 1], [1.3, 1], [1.3, 1.4], [0.7, 1.4]]\ndensity = 1500\n";

/// The history of a scene once it has run.
HistoryTable run(const std::string &text, RunOptions options = {}, MPI_Comm comm = PETSC_COMM_WORLD) {
  const Scene scene = parse_scene(text, "rigid");
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(comm, scene, options);
  simulation->run();
  return simulation->history();
}

/// What soil and body have lost of momentum together [kg m/s], and of angular momentum [kg m2/s], in one contact.
Vec<3> lost(Soil<2> &soil, RigidBodies<2> &rigid, std::vector<Vec<2>> &v) {
  const FilledGrid<2> &grid = soil.motion->grid();
  const double mass = 1500 * 0.24, inertia = mass * (0.36 + 0.16) / 12, step = 1e-3;
  std::vector<RigidBodies<2>::Report> before, after;
  Vec<3> sum{};
  const auto add = [&](double sign) {
    for (int i = 0; i < grid.node_count(); ++i) {
      if (!soil.mesh.counted[grid.mesh_node[i]]) continue;
      const Vec<2> x = grid.position[i], p{sign * grid.mass[i] * v[i][0], sign * grid.mass[i] * v[i][1]};
      sum[0] += p[0], sum[1] += p[1], sum[2] += x[0] * p[1] - x[1] * p[0];
    }
  };
  EXPECT_EQ(rigid.take_reports(before), 0);
  add(1);
  EXPECT_EQ(soil.conditions.resolve(0, step, grid, v.data()), 0);
  add(-1);
  EXPECT_EQ(rigid.take_reports(after), 0);
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  Vec<3> change;
  for (int f = 0; f < 3; ++f) change[f] = after[0].velocity[f] - before[0].velocity[f];
  const auto &x = after[0].place;
  EXPECT_GT(std::abs(change[1]), 1e-3) << "they have met";
  return {sum[0] - mass * change[0], sum[1] - mass * change[1],
          sum[2] - inertia * change[2] - mass * (x[0] * change[1] - x[1] * change[0])};
}

/// A body that falls on uneven soil and slides: each impulse is one between both.
TEST(RigidBodies, momentum_and_angular_momentum_of_the_pair_are_exact) {
  std::string text =
      scene_of(block + "initial_velocity = [0.5, -2]\nfriction_angle = 30\nadhesion = 100\n", stage + "1\n");
  text.replace(text.find("kind = \"fixed\""), 14, "kind = \"friction\"\nfriction_angle = 0");
  Soil<2> soil(text, 0);
  auto owned = std::make_unique<RigidBodies<2>>(soil.mesh, soil.bodies, soil.scene.rigid);
  RigidBodies<2> &rigid = *owned;
  soil.conditions.take_rigid_bodies(std::move(owned));
  soil.conditions.bases().set_friction_delay(0.01);
  ASSERT_EQ(soil.motion->begin(0), 0);
  const FilledGrid<2> &grid = soil.motion->grid();
  std::vector<Vec<2>> v(soil.motion->capacity() / 2);
  for (int i = 0; i < grid.node_count(); ++i) {
    const Vec<2> &x = grid.position[i];
    v[i] = {0, x[1] > 0.99 ? std::cos(7 * x[0]) : 0.1};  // away from the base and off the sides
  }
  for (const double one : lost(soil, rigid, v)) EXPECT_NEAR(one, 0, 1e-12 * 1500 * 0.24 * 2);
}

/// The area on which a plate adheres is that of the soil below it, however many particles it has; the ends of the plate
/// are known to half a cell.
TEST(RigidBodies, adhere_by_area) {
  for (const std::string particles : {"3", "12"}) {
    std::string text = scene_of(
        "polygon = [[0.3, 1], [1.7, 1], [1.7, 1.2], [0.3, 1.2]]\nmass = 560\nrotation = 0\nforce = [10000, 0]\n"
        "friction_angle = 0\nadhesion = 2000\n",
        stage + "0.1\ndamping = 0.3\n");
    text.insert(text.find("law ="), "particles_per_cell = " + particles + "\n");
    const HistoryTable history = run(text);
    EXPECT_NEAR(history.column("block_force_x_N").back(), -2800, 0.05 * 2800) << particles;
  }
}

TEST(RigidBodies, fall_freely) {
  const HistoryTable history =
      run(scene_of("polygon = [[0.7, 1.3], [1.3, 1.3], [1.3, 1.7]]\nmass = 70\nfriction_angle = 0\n"
                   "initial_velocity = [0.5, 0]\n",
                   stage + "0.2\n"));
  const auto x = history.column("block_x_m"), y = history.column("block_y_m"),
             turned = history.column("block_rotation_deg");
  EXPECT_NEAR(x.back() - x.front(), 0.1, 1e-12);
  EXPECT_NEAR(y.back() - y.front(), -9.81 * 0.04 / 2, 0.003);  // the last step counts twice
  EXPECT_EQ(turned.back(), 0);
  EXPECT_NEAR(history.column("block_velocity_y_m_s").back(), -9.81 * 0.2, 1e-12);
}

TEST(RigidBodies, rest_on_soil_with_their_weight) {
  const HistoryTable history = run(scene_of(block + "friction_angle = 20\n", stage + "1\ndamping = 0.5\n"));
  const double weight = 1500 * 0.24 * 9.81;
  EXPECT_NEAR(history.column("block_force_y_N").back(), weight, 1e-3 * weight);
  EXPECT_NEAR(history.column("block_force_x_N").back(), 0, 1e-3 * weight);
  EXPECT_NEAR(history.column("block_moment_N_m").back(), 0, 2e-3 * weight);
  EXPECT_NEAR(history.column("block_velocity_y_m_s").back(), 0, 1e-4);
  EXPECT_NEAR(history.column("block_velocity_x_m_s").back(), 0, 1e-4);
}

/// The scene on a slope, with stiffer soil.
std::string on_slope(double degrees, const std::string &rigid, const std::string &more) {
  const double slope = degrees * std::acos(-1.) / 180;
  std::string text = scene_of(rigid, more), gravity = "gravity = [" + std::to_string(9.81 * std::sin(slope)) + ", " +
                                                      std::to_string(-9.81 * std::cos(slope)) + "]";
  text.replace(text.find("gravity = 9.81"), 14, gravity);
  return text.replace(text.find("\"2 MPa\""), 7, "\"20 MPa\"");
}

TEST(RigidBodies, slide_with_their_friction_and_stick_below_it) {
  const std::string slider =
      "polygon = [[0.2, 1], [1.2, 1], [1.2, 1.5], [0.2, 1.5]]\ndensity = 1500\nfriction_angle = 20\n";
  const HistoryTable slides = run(on_slope(30, slider, stage + "0.4\n")),
                     sticks = run(on_slope(15, slider, stage + "0.4\ndamping = 0.5\n"));
  const auto v = slides.column("block_velocity_x_m_s");
  const double gained = (v.back() - v[v.size() / 2]) / 0.2;
  EXPECT_NEAR(gained, 9.81 * (0.5 - std::tan(std::acos(-1.) / 9) * std::sqrt(0.75)), 0.03 * 9.81 / 2);
  EXPECT_NEAR(sticks.column("block_velocity_x_m_s").back(), 0, 2e-3);
}

/// A wall that turns about its foot as it is drawn away, and a block that falls beside it on soil that bears little.
const std::string busy =
    "polygon = [[0.7, 1.05], [1.2, 1.05], [1.3, 1.4]]\ndensity = 1500\nfriction_angle = 20\n"
    "initial_velocity = [0.5, -1]\n"
    "[rigid.wall]\npolygon = [[1.4, 1], [1.5, 1], [1.5, 1.6], [1.4, 1.6]]\nfriction_angle = 30\n"
    "adhesion = 500\ncentre = [1.4, 1]\nvelocity = ['0.3 * t', '-0.2']\nrotation = -1\n";

/// The columns of the bodies in the last row of a history.
std::vector<double> last_row(const HistoryTable &history) {
  std::vector<double> row;
  for (size_t k = 0; k < history.names.size(); ++k)
    if (history.names[k].starts_with("block_") || history.names[k].starts_with("wall_"))
      row.push_back(history.rows.back()[k]);
  return row;
}

TEST(RigidBodies, move_alike_on_all_numbers_of_ranks) {
  const std::string text = scene_of(busy, stage + "0.2\n");
  const auto alone = last_row(run(text, {}, PETSC_COMM_SELF)), together = last_row(run(text));
  ASSERT_EQ(alone.size(), 18u);
  for (size_t k = 0; k < alone.size(); ++k) EXPECT_NEAR(together[k], alone[k], 1e-6 * std::max(1., std::abs(alone[k])));
}

TEST(RigidBodies, go_on_from_a_checkpoint_bit_for_bit) {
  TemporaryFolder folder;
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  ASSERT_TRUE(rank > 0 || folder.make());
  char path[4096] = "";
  std::strncpy(path, folder.path().c_str(), sizeof path - 1);
  MPI_Bcast(path, sizeof path, MPI_CHAR, 0, PETSC_COMM_WORLD);
  RunOptions options;
  options.directory = std::string(path) + "/run";
  const std::string half = stage + "0.1\n", both = scene_of(busy, half + half);
  run(scene_of(busy, half), options);
  options.resume = true;
  const auto resumed = last_row(run(both, options)), whole = last_row(run(both));
  EXPECT_EQ(resumed, whole);
}

}  // namespace
}  // namespace talus
