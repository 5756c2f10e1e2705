// Which way is up: the same soil, its axes turned about x from y up to z up, behaves the same number by number. What
// takes another axis for the vertical anywhere (water table, overburden, stress at rest, open water, gravity) shows at
// once, since no value of these soils is the same along y and z. Columns of soil above a place
// stand a billionth of the width beside it (simulation/overburden.cpp), on the other side with the axes turned: 1e-8 of
// the largest value is asked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"
#include "tests/unit/meshes/box_mesh.h"

namespace talus {
namespace {

/// A hill of 1 m x 1 m whose ground falls along x by a half of its height, less so along the other level axis.
test::BoxMesh hill() {
  test::BoxMesh mesh(3, 4);
  for (auto &x : mesh.node) x[1] *= 1 - 0.4 * x[0] - 0.1 * x[2];
  return mesh;
}

/// y becomes z, and z becomes -y.
test::BoxMesh turned(test::BoxMesh mesh) {
  for (auto &x : mesh.node) x = {x[0], -x[2], x[1]};
  return mesh;
}

const std::string soil = R"(
dimension = 3
gravity = 10
[body.soil]
region = ["lower", "upper"]
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = "20 kPa"
friction_angle = 30
[boundary.base]
kind = "fixed"
)";
const std::string pores = R"(
porosity = 0.4
grain_density = 2600
permeability = 1e-11
)";

std::string with_keys(const std::string &keys) {
  std::string text = soil;
  return text.insert(text.find("[body.soil]\n") + 12, keys);
}

enum class Until { end, steps };

Snapshot run(MPI_Comm comm, const test::BoxMesh &mesh, const std::string &text, std::vector<std::string> overrides,
             Until until) {
  test::SharedFile file(mesh);
  overrides.push_back("mesh.file=" + file.name());
  Scene scene = parse_scene(text, "vertical.toml", overrides);
  RunOptions options;
  options.pictures = options.screen = false, options.gauss_points = until == Until::end;
  const auto simulation = make_simulation(comm, scene, options);
  if (until == Until::end) simulation->run();
  for (int i = 0; i < 40 && until == Until::steps; ++i) simulation->single_step();
  return simulation->snapshot();
}

const Column *column(const Snapshot &points, const std::string &name) {
  const auto at =
      std::find_if(points.columns.begin(), points.columns.end(), [&](const Column &c) { return c.name == name; });
  return at == points.columns.end() ? nullptr : &*at;
}

/// A vector or tensor (xx, yy, zz, xy, yz, xz) of y up as it reads with z up.
std::vector<double> turned(const double *v, int components) {
  if (components == 3) return {v[0], -v[2], v[1]};
  if (components == 6) return {v[0], v[2], v[1], -v[5], -v[4], v[3]};
  return {v[0]};
}

/// Runs the hill with y up on one rank and with z up on all; `fields` must exist, not vanish, and be the same.
void expect_the_same(const std::string &text, const std::vector<std::string> &fields, Until until) {
  const Snapshot y = run(PETSC_COMM_SELF, hill(), text, {}, until),
                 z = run(PETSC_COMM_WORLD, turned(hill()), text, {"up=z"}, until);
  ASSERT_EQ(test::sum(static_cast<double>(z.id.size())), static_cast<double>(y.id.size()));
  std::map<long long, size_t> place;
  for (size_t i = 0; i < y.id.size(); ++i) place[y.id[i]] = i;
  for (const std::string &name : fields) {
    const Column *a = column(y, name), *b = column(z, name);
    ASSERT_TRUE(a && b) << name;
    double scale = 0, largest = 0;
    for (const double value : a->values) scale = std::max(scale, std::abs(value));
    ASSERT_GT(scale, 0) << name;
    for (size_t i = 0; i < z.id.size(); ++i) {
      const std::vector<double> expected = turned(&a->values[place.at(z.id[i]) * a->components], a->components);
      for (int k = 0; k < a->components; ++k)
        largest = std::max(largest, std::abs(b->values[i * b->components + k] - expected[k]));
    }
    EXPECT_LT(largest / scale, 1e-8) << name;
  }
}

const std::string at_rest = "[[stage]]\nkind = \"quasi_static\"\nduration = 1\ninitial_stress = \"k0\"\n";
// The iteration for the frequency of the mesh starts from a noise that knows x, y and z apart.
const std::string in_motion = "[integrator]\nkind = \"euler\"\nomega_max = \"cells\"\n[[stage]]\nduration = 1\n";
const std::vector<std::string> of_statics{"position", "stress", "displacement"},
    of_motion{"position", "stress", "velocity"};

std::vector<std::string> with_pressure(std::vector<std::string> fields) {
  fields.push_back("pore_pressure");
  return fields;
}

TEST(Vertical, stress_at_rest_is_the_same) {
  expect_the_same(with_keys("density = 2000\nk0 = 0.6\n") + at_rest, of_statics, Until::end);
}

/// The table lies in part above the ground, which bears the open water.
TEST(Vertical, water_tables_are_the_same) {
  expect_the_same("phases = \"drained\"" + with_keys("saturated_unit_weight = 20e3\nunit_weight = 18e3\n") + at_rest +
                      "[water]\ntable = [[0, 0.7], [1, 0.8]]\n",
                  with_pressure(of_statics), Until::end);
}
TEST(Vertical, water_tables_of_one_soil_are_the_same) {
  expect_the_same("phases = \"drained\"" + with_keys("density = 2000\nwater_table = [[0, 0.5], [1, 0.3]]\n") + at_rest +
                      "[water]\n",
                  with_pressure(of_statics), Until::end);
}
TEST(Vertical, pore_pressure_ratios_are_the_same) {
  expect_the_same(
      "phases = \"drained\"" + with_keys("density = 2000\npore_pressure_ratio = 0.3\n") + at_rest + "[water]\n",
      with_pressure(of_statics), Until::end);
}
TEST(Vertical, motion_below_a_water_table_is_the_same) {
  expect_the_same("phases = \"drained\"" + with_keys("saturated_unit_weight = 20e3\nunit_weight = 18e3\n") + in_motion +
                      "[water]\ntable = [[0, 0.7], [1, 0.8]]\n",
                  with_pressure(of_motion), Until::steps);
}

/// Water enters where the ground lies below the level of open water, and leaves above it.
const std::string open_water = "[boundary.top]\nkind = \"head\"\nlevel = 0.7\n[water]\ntable = [[0, 0.7]]\n";
TEST(Vertical, seepage_is_the_same) {
  expect_the_same("phases = \"saturated\"" + with_keys(pores) +
                      "[[stage]]\nkind = \"seepage\"\nsteady = true\nduration = 1\n" + at_rest + open_water,
                  with_pressure(of_statics), Until::end);
}
TEST(Vertical, motion_with_pore_water_is_the_same) {
  expect_the_same("phases = \"saturated\"" + with_keys(pores) + in_motion + open_water, with_pressure(of_motion),
                  Until::steps);
}
TEST(Vertical, motion_with_suction_is_the_same) {
  expect_the_same("phases = \"unsaturated\"" + with_keys(pores) + in_motion + open_water +
                      "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = 5000\nshape = 0.5\n",
                  with_pressure(of_motion), Until::steps);
}

}  // namespace
}  // namespace talus
