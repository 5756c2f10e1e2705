// Rigid bodies that soil meets: nothing of the momentum of a pair is lost, bodies fall, slide, stick, tip over and rest
// as rigid bodies do, on one rank and on two.
#include "physics/boundary/rigid_bodies.h"

#include <gtest/gtest.h>

#include <cmath>

#include "look_ahead/soil.h"
#include "simulation.h"
#include "solvers/euler.h"

namespace talus {
namespace {

/// A bed of elastic soil, 2 m wide and 1 m deep, below 1 m of air, with a rigid body, whose keys are `rigid`.
std::string scene_of(const std::string &rigid, const std::string &more = "") {
  return std::string("gravity = 9.81\n[mesh]\nsection = \"") + TALUS_MESHES +
         "/bed.csv\"\nsize = 0.2\n[body.soil]\nregion = \"soil\"\ndensity = 2000\nlaw = \"linear_elastic\"\n"
         "young_modulus = \"2 MPa\"\npoisson_ratio = 0.3\n"
         "stress = [\"-8408.6 * (1 - y)\", \"-19620 * (1 - y)\", \"-8408.6 * (1 - y)\", \"0\"]\n"
         "[boundary.base]\nkind = \"fixed\"\n[boundary.left]\nkind = \"roller\"\n[boundary.right]\nkind = "
         "\"roller\"\n" +
         more + "[rigid.block]\n" + rigid + "[output]\ninterval = 0\nhistory_interval = 0.01\n";
}

const std::string stage = "[[stage]]\nduration = ";
const std::string block = "polygon = [[0.7, 1], [1.3, 1], [1.3, 1.4], [0.7, 1.4]]\ndensity = 1500\n";

/// The history of a scene once it has run.
HistoryTable run(const std::string &text) {
  const Scene scene = parse_scene(text, "rigid");
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
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
  for (int round = 0; round < 3; ++round)
    for (const double one : lost(soil, rigid, v)) EXPECT_NEAR(one, 0, 1e-12 * 1500 * 0.24 * 2);
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

}  // namespace
}  // namespace talus
