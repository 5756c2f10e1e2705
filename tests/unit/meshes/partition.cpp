#include "meshes/partition.h"

#include <gtest/gtest.h>

#include <cmath>

namespace talus {
namespace {

/// Square patches of 1 m, `length` along x and `height` along y; those from `filled` on along x weigh nothing.
struct Bar {
  std::vector<Vec<2>> centre;
  std::vector<std::vector<int>> touching;
  PatchLoad<2> load;

  Bar(int length, int height, int filled) {
    for (int i = 0; i < length; ++i)
      for (int j = 0; j < height; ++j) {
        centre.push_back({i + 0.5, j + 0.5});
        load.weight.push_back(i < filled ? 10 : 1e-3);
        touching.emplace_back();
        if (i > 0) touching.back().push_back((i - 1) * height + j);
        if (i + 1 < length) touching.back().push_back((i + 1) * height + j);
        if (j > 0) touching.back().push_back(i * height + j - 1);
        if (j + 1 < height) touching.back().push_back(i * height + j + 1);
      }
    load.partition_cost = 1e4;
  }
  template <class Velocity>
  void move(Velocity velocity) {
    for (const Vec<2> &x : centre) load.way.push_back(velocity(x));
  }
  Cut cut() { return find_cuts<2>(centre, load, touching, 2, &forecast).front(); }
  PartitionForecast forecast;  // of the last cut
};

TEST(Partition, CutsTheFewestFacesOfSoilAtRest) {
  Bar bar(12, 4, 12);
  const Cut of_bar = bar.cut();
  EXPECT_EQ(of_bar.axis, 0);
  EXPECT_EQ(of_bar.place, 6.5);  // centre of the first patch above
  EXPECT_EQ(Bar(12, 4, 2).cut().axis, 1) << "faces in the air cost nothing: 2 are cut for 4";
}

TEST(Partition, CutsAlongTheWayOfSoilThatSlides) {
  Bar bar(12, 4, 12);
  bar.move([](const Vec<2> &) { return Vec<2>{1e-3, 0}; });
  EXPECT_EQ(bar.cut().axis, 1);
  EXPECT_EQ(bar.cut().place, 2.5);
  EXPECT_EQ(bar.forecast.imbalance, 1);
  EXPECT_EQ(bar.forecast.crossing, 0);
}

/// Soil that flows askew is cut where less of it crosses: of a column of twelve patches, with a weight of 10 each, a
/// thousandth in each step.
TEST(Partition, TellsWhatWillCrossItsCuts) {
  Bar bar(24, 12, 24);
  bar.move([](const Vec<2> &) { return Vec<2>{1e-3, 4e-3}; });
  EXPECT_EQ(bar.cut().axis, 0);
  EXPECT_NEAR(bar.forecast.crossing, 0.12, 0.02) << "whole patches cross, over a tenth of the length of the bar";
  Bar uneven(11, 1, 11);
  uneven.cut();
  EXPECT_DOUBLE_EQ(uneven.forecast.imbalance, 6 / 5.5);
}

TEST(Partition, CutsAcrossSoilThatFlowsToBothSides) {
  Bar bar(12, 4, 12);
  bar.move([](const Vec<2> &x) { return Vec<2>{1e-3 * (x[0] - 6), 0}; });
  EXPECT_EQ(bar.cut().axis, 0) << "what lies on either side of the cut stays there";
}

TEST(Partition, TakesFewerFacesWhereMotionIsSlow) {
  // 4 faces for 12: 8 times 0.3 is saved in a step; at 1e-9 m a step motion costs sqrt(2 * 1e4 * 4e-8) = 0.03
  Bar bar(12, 4, 12);
  bar.move([](const Vec<2> &) { return Vec<2>{1e-9, 0}; });
  EXPECT_EQ(bar.cut().axis, 0);
}

TEST(Partition, SharesEqually) {
  Bar bar(12, 4, 12);
  bar.move([](const Vec<2> &x) { return Vec<2>{1e-3, 1e-3 * x[0]}; });
  const Cuts cuts = find_cuts<2>(bar.centre, bar.load, bar.touching, 4, &bar.forecast);
  ASSERT_EQ(cuts.size(), 3u);
  std::vector<int> patches(4, 0);
  for (const int rank : ranks_by_cuts<2>(bar.centre, cuts)) ++patches[rank];
  EXPECT_EQ(patches, std::vector<int>(4, 12));
}

}  // namespace
}  // namespace talus
