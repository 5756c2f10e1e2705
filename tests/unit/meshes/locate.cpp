#include "meshes/locate.h"

#include <gtest/gtest.h>

#include <random>

#include "box_mesh.h"

namespace talus {
namespace {

using test::BoxMesh;
using test::SharedFile;

template <int dim>
bool holds(const BackgroundMesh<dim> &mesh, int cell, const Point<dim> &x) {
  const auto n = barycentric(mesh.cells[cell], x);
  return *std::min_element(n.begin(), n.end()) >= inside_tolerance;
}

template <int dim>
void walk_between_random_points() {
  const SharedFile file{BoxMesh(dim, dim == 2 ? 20 : 8)};
  const auto mesh = BackgroundMesh<dim>::read(PETSC_COMM_WORLD, file.name(), {});
  int rank, size;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  std::mt19937 random(5);  // the same points on all ranks
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 300; ++i) {
    Vec<dim> x;
    for (double &one : x) one = unit(random);
    // The point starts in the first cell of one rank and is handed from rank to rank until some cell holds it.
    int at[2] = {i % size, 0};  // rank, cell
    int crossings = 0;
    for (bool arrived = false; !arrived; ++crossings) {
      ASSERT_LT(crossings, 100);
      int answer[3] = {at[0], at[1], 0};
      const int here = at[0];
      if (rank == here) {
        Vec<dim> y = x;
        const Located found = walk(mesh, at[1], y);
        EXPECT_EQ(x, y);
        EXPECT_EQ(found.left_by, -1);
        if (found.partition_face >= 0) {
          answer[0] = mesh.partition_faces[found.partition_face].rank;
          answer[1] = mesh.partition_faces[found.partition_face].cell;
        } else {
          answer[1] = found.cell, answer[2] = 1;
          EXPECT_TRUE(holds(mesh, found.cell, x));
        }
      }
      MPI_Bcast(answer, 3, MPI_INT, here, PETSC_COMM_WORLD);
      at[0] = answer[0], at[1] = answer[1], arrived = answer[2];
    }
    const int found = find(mesh, x);
    if (rank == at[0]) {
      EXPECT_EQ(found, at[1]);
    }
    if (found >= 0) {
      EXPECT_TRUE(holds(mesh, found, x));
    }
  }
}

TEST(Walk, ReachesTheCellOfEveryPointOverPartitionFacesIn2D) { walk_between_random_points<2>(); }
TEST(Walk, ReachesTheCellOfEveryPointOverPartitionFacesIn3D) { walk_between_random_points<3>(); }

TEST(Walk, PutsPointsBeyondTheBoundaryBackInside) {
  const SharedFile file{BoxMesh(3, 4)};
  const auto mesh = BackgroundMesh<3>::read(PETSC_COMM_SELF, file.name(), {});
  for (const Vec<3> &outside : {Vec<3>{0.3, -0.1, 0.4}, Vec<3>{1.2, 0.5, 0.5}, Vec<3>{-0.1, 1.2, 2}}) {
    Vec<3> x = outside;
    const Located found = walk(mesh, 0, x);
    ASSERT_GE(found.left_by, 0);
    EXPECT_EQ(mesh.cells[found.cell].neighbour[found.left_by], boundary);
    EXPECT_EQ(found.partition_face, -1);
    EXPECT_TRUE(holds(mesh, found.cell, x));
    for (double one : x) EXPECT_TRUE(0 < one && one < 1);
    EXPECT_EQ(find(mesh, outside), -1);
  }
}

/// A point a little beyond a closed face, here y = 0, stays inside; one far beyond it or beyond another face does not.
TEST(Walk, KeepsPointsInsideClosedFaces) {
  const SharedFile file{BoxMesh(3, 4)};
  auto mesh = BackgroundMesh<3>::read(PETSC_COMM_SELF, file.name(), {});
  mesh.close("base");
  Vec<3> below{0.3, -0.01, 0.4}, above{0.3, 1.01, 0.4};
  const Located found = walk(mesh, 0, below);
  EXPECT_EQ(found.left_by, -1);
  EXPECT_TRUE(holds(mesh, found.cell, below));
  EXPECT_NEAR(below[1], 0, 1e-8);
  EXPECT_GE(walk(mesh, 0, above).left_by, 0);
  Vec<3> far_below{0.3, -0.2, 0.4};  // cells have a size of 1/4
  EXPECT_GE(walk(mesh, 0, far_below).left_by, 0);
}

TEST(Walk, StaysWhereThePointIs) {
  const SharedFile file{BoxMesh(2, 4)};
  const auto mesh = BackgroundMesh<2>::read(PETSC_COMM_SELF, file.name(), {});
  for (int c = 0; c < mesh.cell_count(); ++c) {
    Vec<2> x{};
    for (int i : mesh.cells[c].node)
      for (int d = 0; d < 2; ++d) x[d] += mesh.position[i][d] / 3;
    EXPECT_EQ(walk(mesh, c, x).cell, c);
    EXPECT_EQ(find(mesh, x), c);
  }
}

}  // namespace
}  // namespace talus
