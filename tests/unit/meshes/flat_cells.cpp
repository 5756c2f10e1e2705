// Cells that lie flat on a surface are taken out, and the surface goes on as that of their neighbours.
#include "meshes/flat_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "meshes/simplex.h"

namespace talus {
namespace {

/// A square of four nodes, of which the third stands `above` its plane, over an apex: two cells hold up the flat one
/// between the diagonals of the square. The fifth node is the apex.
struct Square4 {
  std::vector<Vec<3>> place;
  std::vector<NodeList> volumes{{0, 1, 2, 3, 0, 1, 3, 4, 1, 2, 3, 4}};
  std::vector<NodeList> surfaces{{0, 1, 2, 0, 2, 3}, {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4}};

  explicit Square4(double above) : place{{0, 0, 0}, {1, 0, 0}, {1, 1, above}, {0, 1, 0}, {0.5, 0.5, -1}} {}
  int drop() {
    return drop_flat_cells([&](std::size_t node) { return place[node]; }, volumes, surfaces);
  }
  double volume() const {
    double sum = 0;
    for (const NodeList &cells : volumes)
      for (std::size_t c = 0; c < cells.size(); c += 4)
        sum += std::abs(
            Simplex<3>({place[cells[c]], place[cells[c + 1]], place[cells[c + 2]], place[cells[c + 3]]}).volume);
    return sum;
  }
};

TEST(FlatCells, GiveTheirPlaceOnASurfaceToTheirNeighbours) {
  Square4 square(0.01);
  const double before = square.volume();
  EXPECT_EQ(square.drop(), 1);
  EXPECT_EQ(square.volumes[0], (NodeList{0, 1, 3, 4, 1, 2, 3, 4}));
  EXPECT_EQ(square.surfaces[0].size(), 6u);
  for (const std::size_t node : {0u, 1u, 3u, 2u})
    EXPECT_NE(std::find(square.surfaces[0].begin(), square.surfaces[0].end(), node), square.surfaces[0].end());
  EXPECT_EQ(std::count(square.surfaces[0].begin(), square.surfaces[0].end(), 1u), 2) << "the other diagonal";
  EXPECT_EQ(std::count(square.surfaces[0].begin(), square.surfaces[0].end(), 3u), 2);
  EXPECT_NEAR(square.volume(), before, 0.01 / 6 + 1e-15);
  EXPECT_EQ(square.drop(), 0);
}

TEST(FlatCells, StayWhereTheyAreNoneOrTheSurfaceIsOfTwoVolumes) {
  EXPECT_EQ(Square4(0.5).drop(), 0) << "it has a height";
  Square4 edge(0.01);
  edge.surfaces = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(edge.drop(), 0) << "between two surfaces";
  Square4 border(0.01);
  border.place.push_back({0.5, 0.5, 1});
  border.volumes.push_back({0, 1, 2, 5, 0, 2, 3, 5});
  EXPECT_EQ(border.drop(), 0) << "cells of another volume lie on it";
}

}  // namespace
}  // namespace talus
