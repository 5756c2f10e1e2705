// A granular column runs out over a base with friction and comes to rest. Its front is one particle thick: contact must
// not lift what lies on the base (docs/theory, section 6), so nothing is ever above the column's first height.
#include <gtest/gtest.h>

#include <algorithm>

#include "scene/reader.h"
#include "simulation.h"

namespace talus {
namespace {

const std::string column = std::string(TALUS_GALLERY) + "/column/scene.toml";
constexpr double height = 0.1;

void expect_rest(std::vector<std::string> overrides) {
  for (const char *more : {"boundary.base.kind=friction", "boundary.base.friction_angle=19.8", "stage.0.until=rest",
                           "stage.0.rest_speed=0.005", "stage.0.duration=3", "output.interval=0"})
    overrides.emplace_back(more);
  Scene scene = read_scene(column, overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const long long particles = simulation->particles();
  double highest = 0;
  simulation->run();  // ends with an error if a particle leaves the mesh
  const Snapshot end = simulation->snapshot();
  const Column &position = end.columns.front();
  for (size_t i = 0; i < end.id.size(); ++i) highest = std::max(highest, position.values[i * position.components + 1]);
  long long count = static_cast<long long>(end.id.size());
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_LONG_LONG, MPI_SUM, PETSC_COMM_WORLD);
  EXPECT_EQ(count, particles);
  EXPECT_LE(highest, height);
  ASSERT_EQ(simulation->events().size(), 1u);
  EXPECT_NE(simulation->events()[0].text.find("came to rest"), std::string::npos) << simulation->events()[0].text;
}

TEST(FrictionalBase, column_comes_to_rest_on_it) { expect_rest({"mesh.size=0.01"}); }
TEST(FrictionalBase, column_comes_to_rest_on_it_in_3d) {
  const std::string k0 = "\"-9.81 * 2650 * (0.1 - y) * 0.3 / 0.7\"";
  expect_rest({"mesh.size=0.0125", "dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller",
               "output.point.corner.position=[0.2, 0.1, 0.006]",
               "body.bars.stress=[" + k0 + ", \"-9.81 * 2650 * (0.1 - y)\", " + k0 + ", \"0\", \"0\", \"0\"]"});
}

}  // namespace
}  // namespace talus
