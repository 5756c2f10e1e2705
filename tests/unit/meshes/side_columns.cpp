#include "meshes/side_columns.h"

#include <gtest/gtest.h>

#include "box_mesh.h"
#include "meshes/background_mesh.h"

namespace talus {
namespace {

using test::BoxMesh;
using test::SharedFile;

/// A column below the base of the box, since the box has groups there, and ties through it.
template <int dim>
void column_below() {
  constexpr int n = 4;
  const SharedFile file{BoxMesh(dim, n)};
  const auto plain = BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file.name(), {});
  auto mesh = BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file.name(), {}, {}, 0, {}, {"base"});
  const double facets = test::sum(static_cast<double>(plain.facets("base").size()));
  EXPECT_EQ(test::sum(mesh.cell_count()), test::sum(plain.cell_count()) + dim * facets);
  double volume = 0, lowest = 0;
  for (int c = 0; c < mesh.cell_count(); ++c) volume += mesh.volume[c];
  for (const Vec<dim> &x : mesh.position) lowest = std::min(lowest, x[1]);
  MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
  const double thickness = -lowest / 2;  // as far away as thick
  EXPECT_NEAR(thickness, 1. / n, 0.1 / n);
  EXPECT_NEAR(test::sum(volume), 1 + thickness, 1e-12);
  double area[2] = {0, 0};  // of the faces that look up and down
  std::vector<FaceNode<dim>> faces[2];
  for (const Facet<dim> &f : mesh.facets(column_of("base"))) area[f.normal[1] < 0] += f.area;
  EXPECT_NEAR(test::sum(area[0]), 1, 1e-12);
  EXPECT_NEAR(test::sum(area[1]), 1, 1e-12);
  for (const int c : mesh.region("lower"))
    for (const int node : mesh.cells[c].node) EXPECT_LE(mesh.position[node][1], 0.5 + 1e-12);
  EXPECT_NEAR(test::sum(static_cast<double>(mesh.region("lower").size())),
              test::sum(static_cast<double>(plain.region("lower").size())) + dim * facets, 0.5);

  Vec<dim> normal;
  std::string fault;
  for (const FaceNode<dim> &node : nodes_of_planes<dim>(mesh, mesh.facets(column_of("base")), normal, fault))
    faces[node.side > 0].push_back(node);
  const auto pairs = opposite_nodes<dim>(faces[0], faces[1], normal, 1e-6, fault);
  EXPECT_EQ(fault, "");
  EXPECT_EQ(pairs.size(), faces[0].size());
  mesh.tie(pairs);
  std::vector<double> height;  // of a node and its partner: the middle of the column twice, on all ranks
  for (const Vec<dim> &x : mesh.position) height.push_back(x[1]);
  ASSERT_EQ(mesh.ties.sum(height.data(), 1), 0);
  double counted = 0;
  for (int i = 0; i < mesh.node_count(); ++i) {
    counted += mesh.counted[i];
    if (mesh.position[i][1] < -thickness / 2) {
      EXPECT_NEAR(height[i], -3 * thickness, 1e-12);
    }
  }
  EXPECT_EQ(test::sum(counted), std::pow(n + 1, dim) + static_cast<double>(pairs.size()));
}

TEST(SideColumns, StandBesideAPlaneAndCanBeTied) {
  column_below<2>();
  column_below<3>();
}

TEST(SideColumns, NodesWithoutAPartnerAreNamed) {
  const std::vector<FaceNode<2>> one{{0, {0, 0}, 1}, {1, {0, 1}, 1}}, other{{2, {3, 0}, -1}, {3, {3, 1.5}, -1}};
  std::string fault;
  opposite_nodes<2>(one, other, {1, 0}, 1e-3, fault);
  EXPECT_NE(fault.find("a node at (0, 1) m without a partner"), std::string::npos) << fault;
}

}  // namespace
}  // namespace talus
