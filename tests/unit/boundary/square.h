#pragma once
/// The unit square of soil on which the tests of boundary kinds act.
#include <gtest/gtest.h>

#include "../meshes/box_mesh.h"
#include "physics/boundary/conditions.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {

/// One saturated body in the unit square, all of whose cells are filled; every node has a mass of 1 kg.
struct Square1m {
  using Source = Conditions<2>::Source;

  explicit Square1m(std::vector<Source> of, const test::BoxMesh &box = test::BoxMesh(2, 4))
      : scene(parse_host_scene(text, "square")),
        file(box),
        mesh(BackgroundMesh<2>::read(PETSC_COMM_WORLD, file.name(), {})),
        sources(std::move(of)),
        grid(mesh),
        filling(mesh.cell_count(), 1.),
        impedance(mesh.cell_count(), {1e3, 1e2}) {
    EXPECT_EQ(conditions.setup(mesh, sources), 0);
    for (int c = 0; c < mesh.cell_count(); ++c) grid.enter_cell(c);
    grid.complete();
    for (int i = 0; i < grid.node_count(); ++i) grid.mass[i] = 1;
    EXPECT_EQ(conditions.begin(grid, impedance, filling), 0);
  }
  bool at_base(int node) const { return grid.position[node][1] == 0; }
  double base_nodes() const {
    double count = 0;
    for (int i = 0; i < grid.node_count(); ++i) count += at_base(i) && mesh.owned[grid.mesh_node[i]];
    return test::sum(count);
  }
  Vec<2> impulse() {
    std::vector<Vec<2>> all;
    EXPECT_EQ(conditions.take_impulses(PETSC_COMM_WORLD, all), 0);
    return all[0];
  }

  static constexpr const char *text = R"(
phases = "saturated"
gravity = 0
[body.soil]
region = ["lower", "upper"]
porosity = 0.4
grain_density = 2650
hydraulic_conductivity = "1e-3 m/s"
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.25
[[stage]]
name = "only"
duration = 1
)";
  Scene scene;
  test::SharedFile file;
  BackgroundMesh<2> mesh;
  std::vector<Source> sources;
  Conditions<2> conditions;
  FilledGrid<2> grid;
  std::vector<double> filling;
  std::vector<std::array<double, 2>> impedance;
};

}  // namespace talus
