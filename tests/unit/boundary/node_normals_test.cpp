// Normals of a boundary at its nodes: one per node on relief and on curved faces, one per side at a true edge. The
// boundary is the side y = 0 of the unit square or cube, bent to y = profile(x, z).
#include "physics/boundary/node_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "../meshes/box_mesh.h"

namespace talus {
namespace {

constexpr double round_off = 1e-12, degree = M_PI / 180;
constexpr int cells = 12;

using Profile = std::function<double(double x, double z)>;

/// A number between -1 and 1 that looks random, always the same at a place.
double noise(double x, double z) {
  const double s = 43758.5453 * std::sin(12.9898 * x + 78.233 * z);
  return 2 * (s - std::floor(s)) - 1;
}
double flat(double, double) { return 0; }
double kinked(double x, double) { return x < 0.5 ? 0 : std::tan(25 * degree) * (x - 0.5); }
/// A cylinder with 60 facets around it.
double round_valley(double x, double) { return 0.8 - std::sqrt(0.64 - (x - 0.5) * (x - 0.5)); }
/// Neighbouring facets differ by up to 20 degrees.
constexpr double roughness = 0.08 / cells;
Profile rough(const Profile &mean) {
  return [mean](double x, double z) { return mean(x, z) + roughness * noise(x, z); };
}

template <int dim>
using Normals = std::map<Vec<dim>, std::vector<NodeNormal<dim>>>;  ///< by position

template <int dim>
Normals<dim> normals_of(const Profile &profile, MPI_Comm comm = PETSC_COMM_WORLD) {
  test::BoxMesh box(dim, cells);
  for (auto &x : box.node) {
    if (x[1] == 0)  // nodes of the boundary at equal distances, some on the edge
      for (const int d : {0, 2}) x[d] = std::round(x[d] * cells) / cells;
    x[1] += (1 - x[1]) * profile(x[0], x[2]);
  }
  const test::SharedFile file(box);
  const auto mesh = BackgroundMesh<dim>::read(comm, file.name(), {});
  std::vector<NodeNormal<dim>> all;
  EXPECT_EQ(find_node_normals<dim>(mesh, {{0, mesh.facets("base")}}, all), 0);
  Normals<dim> normals;
  for (const NodeNormal<dim> &n : all) normals[mesh.position[n.node]].push_back(n);
  return normals;
}
/// Angle in the plane x, y between a normal and the one of the level base [degrees]; positive: uphill along x.
template <int dim>
double tilt(const NodeNormal<dim> &n) {
  return std::atan2(n.normal[0], -n.normal[1]) / degree;
}
template <int dim>
double off_the_mean(const NodeNormal<dim> &n) {
  return std::acos(std::min(1., -n.normal[1])) / degree;
}

template <class Case>
struct NodeNormals : testing::Test {};
template <int n>
struct Dim {
  static constexpr int dim = n;
};
using Dimensions = testing::Types<Dim<2>, Dim<3>>;
TYPED_TEST_SUITE(NodeNormals, Dimensions, );

TYPED_TEST(NodeNormals, are_exact_on_a_plane) {
  for (const auto &[x, normals] : normals_of<TypeParam::dim>(flat)) {
    ASSERT_EQ(normals.size(), 1u);
    EXPECT_NEAR(normals[0].normal[1], -1, round_off);
  }
}
TYPED_TEST(NodeNormals, are_one_per_node_on_relief_and_near_its_mean_plane) {
  double sum = 0, count = 0;
  for (const auto &[x, normals] : normals_of<TypeParam::dim>(rough(flat))) {
    ASSERT_EQ(normals.size(), 1u) << "x = " << x[0];
    const bool inside = std::abs(x[0] - 0.5) < 0.3;
    sum += inside * std::pow(off_the_mean(normals[0]), 2), count += inside;
  }
  if (count > 0) {
    EXPECT_LT(std::sqrt(sum / count), 1.5);  // of single facets: 5 degrees
  }
}
TYPED_TEST(NodeNormals, are_one_per_node_on_a_curved_face) {
  for (const auto &[x, normals] : normals_of<TypeParam::dim>(round_valley)) {
    ASSERT_EQ(normals.size(), 1u) << "x = " << x[0];
    const bool near_end = std::abs(x[0] - 0.5) > 0.3;
    if (!near_end) {  // where the mean is one-sided
      EXPECT_NEAR(tilt(normals[0]), std::asin((x[0] - 0.5) / 0.8) / degree, 1);
    }
  }
}
TYPED_TEST(NodeNormals, are_those_of_both_sides_at_a_true_edge) {
  for (const auto &[x, normals] : normals_of<TypeParam::dim>(kinked)) {
    const bool at_edge = std::abs(x[0] - 0.5) < 1e-9;
    ASSERT_EQ(normals.size(), at_edge ? 2u : 1u) << "x = " << x[0];
    for (const auto &n : normals)
      EXPECT_LT(std::min(std::abs(tilt(n)), std::abs(tilt(n) - 25)), 1e-6) << "x = " << x[0];
    if (at_edge) {
      EXPECT_NEAR(std::abs(tilt(normals[0]) - tilt(normals[1])), 25, 1e-6);
    }
  }
}
TYPED_TEST(NodeNormals, find_a_true_edge_in_relief) {
  for (const auto &[x, normals] : normals_of<TypeParam::dim>(rough(kinked))) {
    const bool at_edge = std::abs(x[0] - 0.5) < 1e-9;
    if (!at_edge) continue;
    ASSERT_EQ(normals.size(), 2u);
    EXPECT_NEAR(std::abs(tilt(normals[0]) - tilt(normals[1])), 25, 6);
  }
}
/// All facets count, so the patches of all nodes have the area of the boundary.
TYPED_TEST(NodeNormals, share_the_area) {
  constexpr int dim = TypeParam::dim;
  double area = 0;
  for (const auto &[x, normals] : normals_of<dim>(kinked, PETSC_COMM_SELF))
    for (const auto &n : normals) area += n.area;
  EXPECT_NEAR(area, 0.5 + 0.5 / std::cos(25 * degree), 1e-9);
}
TYPED_TEST(NodeNormals, do_not_depend_on_the_partition) {
  constexpr int dim = TypeParam::dim;
  const Normals<dim> whole = normals_of<dim>(rough(kinked), PETSC_COMM_SELF);
  for (const auto &[x, normals] : normals_of<dim>(rough(kinked))) {
    const auto &expected = whole.at(x);
    ASSERT_EQ(normals.size(), expected.size());
    for (size_t i = 0; i < normals.size(); ++i) {
      EXPECT_EQ(normals[i].normal, expected[i].normal);
      EXPECT_EQ(normals[i].area, expected[i].area);
    }
  }
}

}  // namespace
}  // namespace talus
