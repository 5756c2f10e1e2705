// The shapes of rigid bodies: signed distances, areas and moments of inertia, and what is no shape.
#include "physics/boundary/rigid_shape.h"

#include <gtest/gtest.h>

#include <cmath>

namespace talus {
namespace {

using Corners = std::vector<std::vector<double>>;

/// An L of three unit squares, whose inner corner is at (1, 1).
const Corners angle{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

TEST(RigidShape, distances_are_negative_inside_and_grow_along_the_normal) {
  for (const bool clockwise : {false, true}) {
    const RigidShape<2> shape(clockwise ? Corners(angle.rbegin(), angle.rend()) : angle);
    Vec<2> n;
    EXPECT_NEAR(shape.distance({0.5, -0.25}, n), 0.25, 1e-15);
    EXPECT_NEAR(n[1], -1, 1e-15);
    EXPECT_NEAR(shape.distance({1.5, 0.9}, n), -0.1, 1e-15);
    EXPECT_NEAR(n[1], 1, 1e-15);
    EXPECT_NEAR(shape.distance({2.3, -0.4}, n), 0.5, 1e-15) << "a corner that sticks out";
    EXPECT_NEAR(n[0], 0.6, 1e-15);
    EXPECT_NEAR(shape.distance({0.94, 0.92}, n), -0.1, 1e-15) << "a corner that goes in";
    EXPECT_NEAR(n[0], 0.6, 1e-14);
    EXPECT_NEAR(shape.distance({1, 2}, n), 0, 1e-15);
    EXPECT_NEAR(dot<2>(n, n), 1, 1e-15);
  }
}

TEST(RigidShape, area_and_inertia_of_a_polygon) {
  const RigidShape<2> shape(angle);
  EXPECT_NEAR(shape.volume(), 3, 1e-14);
  EXPECT_NEAR(shape.centre()[0], 2.5 / 3, 1e-14);
  EXPECT_NEAR(shape.centre()[1], 2.5 / 3, 1e-14);
  const double off = 2. / 9 + 2 * 5. / 9;  // squares of the distances of the three squares from the centre, summed
  EXPECT_NEAR(shape.square_radius(), 1. / 6 + off / 3, 1e-14);
}

/// A cube of twelve triangles.
TEST(RigidShape, of_triangles) {
  Corners cube;
  for (int d = 0; d < 3; ++d)
    for (const double side : {0., 1.})
      for (const int half : {0, 1}) {
        std::vector<std::vector<double>> face(3, std::vector<double>(3, side));
        const double square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        for (int k = 0; k < 3; ++k)
          for (int e = 0; e < 2; ++e) face[k][(d + 1 + e) % 3] = square[(k + 2 * half) % 4][e];
        if (side == 0) std::swap(face[1], face[2]);
        cube.insert(cube.end(), face.begin(), face.end());
      }
  const RigidShape<3> shape(cube);
  EXPECT_NEAR(shape.volume(), 1, 1e-14);
  EXPECT_NEAR(shape.centre()[2], 0.5, 1e-14);
  Vec<3> n;
  EXPECT_NEAR(shape.distance({0.3, 0.4, 0.9}, n), -0.1, 1e-14);
  EXPECT_NEAR(n[2], 1, 1e-14);
  EXPECT_NEAR(shape.distance({0.3, 0.4, -2}, n), 2, 1e-14);
  EXPECT_NEAR(n[2], -1, 1e-14);
  EXPECT_NEAR(shape.distance({1.3, 1.4, 0.5}, n), 0.5, 1e-14);
  EXPECT_NEAR(n[0], 0.6, 1e-14);
}

TEST(RigidShape, says_what_is_no_polygon) {
  EXPECT_EQ(problem_of_polygon(angle), "");
  EXPECT_EQ(problem_of_polygon({{0, 0}, {1, 0}, {0, 1}}), "");
  const auto wrong = [](const Corners &corners, const char *what) {
    EXPECT_NE(problem_of_polygon(corners).find(what), std::string::npos) << problem_of_polygon(corners);
  };
  wrong({{0, 0}, {1, 0}}, "at least 3");
  wrong({{0, 0}, {1, 0}, {1}}, "2 coordinates");
  wrong({{0, 0}, {1, 0}, {1, 1}, {0, 0}}, "twice");
  wrong({{0, 0}, {2, 0}, {1, 0}}, "turn back");
  wrong({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, "touch itself");
  wrong({{0, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}}, "touch itself");
}

}  // namespace
}  // namespace talus
