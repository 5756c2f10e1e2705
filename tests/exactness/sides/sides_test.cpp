// Sides at which ground goes on, tied and beside columns of free ground: what quasi-static stages hand over to them,
// and that ranks do not matter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

const std::string clay = R"(
gravity = 9.81
[mesh]
size = 1
[body.clay]
region = "clay"
unit_weight = "19 kN/m3"
law = "mohr_coulomb"
young_modulus = "50 MPa"
poisson_ratio = 0.3
cohesion = "15 kPa"
friction_angle = 25
[boundary.base]
kind = "fixed"
[boundary.sides]
group = ["left", "right"]
[quasi_static]
elements = "patches"
tolerance = 1e-12
[[stage]]
name = "weight"
kind = "quasi_static"
duration = 1
reset_displacement = true
[[stage]]
name = "motion"
duration = 10
[output]
history_interval = 0.05
[output.point.left]
position = [0, 4]
[output.point.right]
position = [20, 4]
[output.point.top]
position = [9, 5]
)";
const std::vector<std::string> tied{"mesh.section=mound.csv", "boundary.sides.kind=tied"},
    free_field{"mesh.section=terrace.csv", "boundary.sides.kind=free_field"},
    shaken{"earthquake=[{kind='ricker', amplitude=3, frequency=4}]", "stage.motion.earthquake=true",
           "stage.motion.duration=0.8"},
    in_3d{"dimension=3",
          "mesh.thickness=2",
          "mesh.layers=2",
          "mesh.size=2",
          "boundary.ends.group=['front', 'back']",
          "output.point.left.position=[0, 4, 0.5]",
          "output.point.right.position=[20, 4, 0.5]",
          "output.point.top.position=[9, 4.5, 1]"};

const std::vector<std::string> gravel{
    "phases=saturated",
    "mesh.section=../../../meshes/box.csv",
    "mesh.size=0.25",
    "water={bulk_modulus=1e8, table=[[0, 1.5], [1, 1.5]]}",
    "body.clay={region='soil', porosity=0.4, grain_density=2650, permeability=1e-9, law='linear_elastic', "
    "young_modulus=2e7, poisson_ratio=0.25}",
    "boundary.surface={kind='head', level=1.5}",
    "output.point.left.position=[0.05, 0.2]",
    "output.point.right.position=[0.95, 0.2]",
    "output.point.top.position=[0.5, 0.2]"};

const std::vector<std::string> lasting{"body.clay.permeability=1e-12",
                                       "earthquake=[{kind='sine', amplitude=3, frequency=1, duration=0.8}]"};

std::vector<std::string> operator+(std::vector<std::string> one, const std::vector<std::string> &more) {
  one.insert(one.end(), more.begin(), more.end());
  return one;
}

struct Result {
  Snapshot particles;
  HistoryTable history;
  std::vector<double> field(const char *name) const {
    return std::find_if(particles.columns.begin(), particles.columns.end(),
                        [&](const Column &c) { return c.name == name; })
        ->values;
  }
};

Result run(const std::vector<std::string> &keys, MPI_Comm comm = PETSC_COMM_WORLD) {
  Scene scene = parse_scene(clay, std::string(TALUS_SIDES) + "/scene.toml", keys);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(comm, scene, options);
  simulation->run();
  return {simulation->snapshot(), simulation->history()};
}

double largest(const std::vector<double> &values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  return most;
}

/// What rollers held goes on to be held: after ten seconds of motion under the same weight nothing moves, and stress is
/// what it was after a thousandth of a second.
TEST(Sides, soil_that_stood_between_rollers_stands_on) {
  for (const auto &sides : {tied, free_field}) {
    const Result early = run(sides + std::vector<std::string>{"stage.motion.duration=1e-3"}), late = run(sides);
    const auto before = early.field("stress"), after = late.field("stress");
    ASSERT_EQ(before.size(), after.size());
    std::vector<double> drift;
    for (size_t k = 0; k < before.size(); ++k) drift.push_back(after[k] - before[k]);
    EXPECT_LT(largest(drift), 1e-7 * largest(before)) << sides[1];  // 100 kPa
    EXPECT_LT(largest(late.field("velocity")), 1e-9) << sides[1];   // waves go at 190 m/s
  }
}

/// Opposite sides move alike, whatever the mound between them does.
TEST(Sides, tied_sides_move_alike) {
  const Result mound = run(tied + shaken);
  const auto left = mound.history.column("left_displacement_x_m"),
             right = mound.history.column("right_displacement_x_m"), top = mound.history.column("top_displacement_x_m");
  std::vector<double> apart, other;
  for (size_t k = 0; k < left.size(); ++k) apart.push_back(left[k] - right[k]), other.push_back(left[k] - top[k]);
  EXPECT_LT(largest(apart), 0.05 * largest(left));  // of the particles next to the points
  EXPECT_GT(largest(other), 0.2 * largest(left));
}

/// Level ground under water that is shaken along itself shears: no water has to flow, none is pushed against the sides,
/// and the water above weighs what it does at rest.
TEST(Sides, water_moves_through_tied_sides) {
  const Result ground = run(tied + shaken + gravel);
  for (const std::string place : {"left", "right", "top"}) {
    const auto pressure = ground.history.column(place + "_pore_pressure_Pa"),
               time = ground.history.column("load_time_s");
    std::vector<double> change;
    for (size_t k = 0; k < pressure.size(); ++k)
      if (time[k] > 1) change.push_back(pressure[k] - pressure.back());
    EXPECT_LT(largest(change), 50) << place;  // of 8 kPa; half a kPa where the sides are walls
  }
}

/// A run on several ranks is that on one.
TEST(Sides, do_not_depend_on_ranks) {
  int rank, ranks;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank), MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (ranks == 1) GTEST_SKIP();
  for (const auto &keys : {tied + shaken, free_field + shaken, tied + shaken + gravel + lasting,
                           tied + shaken + in_3d + std::vector<std::string>{"boundary.ends.kind=tied"},
                           free_field + shaken + in_3d + std::vector<std::string>{"boundary.ends.kind=free_field"}}) {
    Result whole;
    for (int r = 0; r < ranks; ++r) {  // one after the other: they share the file of the mesh
      if (r == rank) whole = run(keys, PETSC_COMM_SELF);
      MPI_Barrier(PETSC_COMM_WORLD);
    }
    const Result shared = run(keys);
    std::map<long long, size_t> place;
    for (size_t i = 0; i < whole.particles.id.size(); ++i) place[whole.particles.id[i]] = i;
    for (const char *name : {"position", "velocity", "stress"}) {
      const auto one = whole.field(name), several = shared.field(name);
      const size_t width = one.size() / whole.particles.id.size();
      std::vector<double> apart;
      for (size_t i = 0; i < shared.particles.id.size(); ++i)
        for (size_t k = 0; k < width; ++k)
          apart.push_back(several[i * width + k] - one[place.at(shared.particles.id[i]) * width + k]);
      EXPECT_LT(largest(apart), 1e-9 * largest(one)) << name << ", " << keys[1];
    }
  }
}

}  // namespace
}  // namespace talus
