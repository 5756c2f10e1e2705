// A law as a UMAT gives the answer of the same law built in, over a whole run: to 2e-13 at its end where 1e-10 is
// claimed, which leaves room for round-off that softening soil on the move enlarges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

/// The slope of the guide, coarse: it yields under its own weight, softens, slides by 4.8 m and comes to rest.
/// With a cap of volumes, which the built-in law has by default and a UMAT has not.
std::string scene_of(const std::string &law) {
  return R"(dimension = 2
gravity = 9.81
[mesh]
section = "slope.csv"
size = 0.8
[body.clay]
region = "clay"
density = 1900
young_modulus = "8 MPa"
poisson_ratio = 0.3
volume_cap = 1
)" + law +
         R"(
[boundary.base]
kind = "fixed"
[boundary.left]
kind = "roller"
[boundary.right]
kind = "roller"
[[stage]]
duration = 10
damping = 0.05
)";
}

/// At the end of its 10 s, or after so many steps.
Snapshot after(MPI_Comm comm, const std::string &law, int steps = 0) {
  Scene scene = parse_scene(scene_of(law), std::string(TALUS_GUIDE) + "/scene.toml");
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(comm, scene, options);
  for (int i = 0; i < steps; ++i) simulation->single_step();
  if (steps == 0) simulation->run();
  return simulation->snapshot();
}

const Column &column(const Snapshot &s, std::string_view name) {
  return *std::find_if(s.columns.begin(), s.columns.end(), [&](const Column &c) { return c.name == name; });
}

void expect_the_same(const Snapshot &a, const Snapshot &b, const std::string &name) {
  std::map<long long, std::size_t> place;
  for (std::size_t i = 0; i < b.id.size(); ++i) place[b.id[i]] = i;
  const Column &x = column(a, name), &y = column(b, name);
  ASSERT_EQ(a.id.size(), b.id.size());
  double largest = 0, scale = 1e-300;
  for (double value : x.values) scale = std::max(scale, std::abs(value));
  for (std::size_t i = 0; i < a.id.size(); ++i)
    for (int k = 0; k < x.components; ++k)
      largest =
          std::max(largest, std::abs(x.values[i * x.components + k] - y.values[place.at(a.id[i]) * x.components + k]));
  EXPECT_LT(largest / scale, 1e-10) << name;
  if (name != "velocity") {
    EXPECT_GT(scale, 1e-3) << name;
  }
}

const std::string umats = UMATS;

TEST(UmatRun, linear_elasticity_in_cpp_is_the_built_in_one) {
  const auto built_in = after(PETSC_COMM_WORLD, "law = \"linear_elastic\"", 100);
  const auto own =
      after(PETSC_COMM_WORLD,
            "law = \"umat\"\nlibrary = \"" + umats + "/umat_linear_elastic.so\"\nprops = [\"8 MPa\", 0.3]", 100);
  for (const char *field : {"position", "velocity", "stress"}) expect_the_same(built_in, own, field);
}

#ifdef UMAT_FORTRAN
TEST(UmatRun, mohr_coulomb_in_fortran_is_the_built_in_one_from_the_first_step_to_rest) {
  const auto built_in = after(PETSC_COMM_WORLD,
                              "law = \"mohr_coulomb\"\ncohesion = \"6 kPa\"\nfriction_angle = 20\ndilation_angle = 5\n"
                              "residual_cohesion = \"2 kPa\"\nresidual_friction_angle = 14\nshape_factor = 30");
  const auto own = after(
      PETSC_COMM_WORLD, "law = \"umat\"\nlibrary = \"" + umats +
                            "/umat_mohr_coulomb.so\"\n"
                            "state = [\"plastic_strain\", \"dilation\"]\n"
                            "props = [\"8 MPa\", 0.3, \"6 kPa\", \"20 deg\", \"5 deg\", \"2 kPa\", \"14 deg\", 30, 0]");
  const Column &moved = column(built_in, "displacement");
  double most = *std::max_element(moved.values.begin(), moved.values.end());
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_GT(most, 4);
  for (const char *field : {"position", "velocity", "stress", "plastic_strain", "dilation"})
    expect_the_same(built_in, own, field);
}
#endif

}  // namespace
}  // namespace talus
