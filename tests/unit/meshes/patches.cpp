#include "meshes/patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace talus {
namespace {

/// A strip of n squares in a row, each cut into two triangles: cells 2i and 2i + 1 are the halves of square i.
struct Strip {
  std::vector<std::array<int, 3>> node, neighbour;
  explicit Strip(int n) {
    for (int i = 0; i < n; ++i) {
      node.push_back(
          {2 * i, 2 * i + 2, 2 * i + 1});  // opposite to them: the other half, the square before, the outside
      neighbour.push_back({2 * i + 1, i > 0 ? 2 * i - 1 : -1, -1});
      node.push_back({2 * i + 3, 2 * i + 1, 2 * i + 2});
      neighbour.push_back({2 * i, i + 1 < n ? 2 * i + 2 : -1, -1});
    }
  }
};

std::vector<int> sizes(const std::vector<int> &patch) {
  std::vector<int> size(*std::max_element(patch.begin(), patch.end()) + 1, 0);
  for (int p : patch) ++size[p];
  return size;
}

TEST(Patches, CoverAStripInPairs) {
  const Strip strip(6);
  const auto patch = make_patches<2>(strip.node, strip.neighbour, std::vector<int>(12, 0), 2);
  EXPECT_EQ(sizes(patch), std::vector<int>(6, 2));
}

TEST(Patches, AreConnected) {
  const Strip strip(10);
  for (int size : {2, 3, 4, 8}) {
    const auto patch = make_patches<2>(strip.node, strip.neighbour, std::vector<int>(20, 0), size);
    std::map<int, std::vector<int>> cells;  // of a strip, a patch is connected when its cells follow one another
    for (int c = 0; c < 20; ++c) cells[patch[c]].push_back(c);
    for (const auto &[p, members] : cells)
      EXPECT_EQ(members.back() - members.front() + 1, static_cast<int>(members.size()));
  }
}

TEST(Patches, NeverHoldTwoKinds) {
  const Strip strip(9);
  std::vector<int> kind(18, 0);
  for (int c = 7; c < 12; ++c) kind[c] = 1;
  for (int size : {2, 4, 8}) {
    const auto patch = make_patches<2>(strip.node, strip.neighbour, kind, size);
    std::map<int, std::set<int>> kinds;
    for (int c = 0; c < 18; ++c) kinds[patch[c]].insert(kind[c]);
    for (const auto &[p, held] : kinds) EXPECT_EQ(held.size(), 1u);
  }
}

TEST(Patches, FragmentsJoinTheirNeighbours) {
  const Strip strip(9);
  const auto size = sizes(make_patches<2>(strip.node, strip.neighbour, std::vector<int>(18, 0), 8));
  for (int one : size) EXPECT_GE(one, 4);
}

TEST(Patches, OfOneCellAreTheCells) {
  const Strip strip(3);
  EXPECT_EQ(make_patches<2>(strip.node, strip.neighbour, std::vector<int>(6, 0), 1),
            (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

}  // namespace
}  // namespace talus
