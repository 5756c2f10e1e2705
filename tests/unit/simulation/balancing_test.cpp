// When ranks that wait for each other divide the mesh anew, and what counts as work.
#include "simulation/balancing.h"

#include <gtest/gtest.h>

#include "scene/transfer_source.h"
#include "simulation/work.h"

namespace talus {
namespace {

constexpr double mean = 1e5;
constexpr long long cells = 1000;
constexpr double cost = 200. * cells + 6 * mean;  // about, of a new partition

/// Two ranks whose imbalance after k remaps, of one step each, is `imbalance(k)`: the number of remaps after which the
/// mesh is divided in another way, 0 if not within 2000.
template <class Imbalance>
int remaps_before(const PartitionForecast &forecast, double steps, Imbalance imbalance,
                  BalanceRanks when = BalanceRanks::when_it_pays) {
  Balancing balancing(when, 2, cells, true);
  for (int k = 1; k <= 2000; ++k) {
    balancing.step(imbalance(k) * mean), balancing.remap(2 * mean);
    if (balancing.due() && balancing.worth(forecast, steps - k)) return k;
  }
  return 0;
}

const auto constant = [](double value) { return [value](int) { return value; }; };
constexpr double long_run = 1e6;

/// A tenth is lost at once and will be for long, and no soil crosses the new cut: there is nothing to wait for but to
/// know it.
TEST(Balancing, FollowsSoonOnAnImbalanceThatStays) {
  const int remaps = remaps_before({1, 0}, long_run, constant(1.1));
  EXPECT_GT(remaps, 0);
  EXPECT_LE(remaps * 0.1 * mean, 0.5 * cost);
}

/// Soil that goes on to cross the cuts is divided anew again and again: sum of losses and costs is least where what
/// was lost since is the cost of a partition.
TEST(Balancing, WaitsAsLongAsLossesGrowBackAgain) {
  const double growth = 5e-4;  // of the imbalance, per remap
  const int remaps = remaps_before({1, growth * mean}, long_run, [&](int k) { return 1 + growth * k; });
  const double lost = growth * mean * remaps * remaps / 2;
  EXPECT_NEAR(lost, cost, 0.5 * cost) << remaps << " remaps";
}

TEST(Balancing, IsNotWorthItNearTheEnd) {
  const double loss = 0.1 * mean;
  EXPECT_EQ(remaps_before({1, 0}, cost / loss, constant(1.1)), 0) << "all that is left to lose is its cost";
  EXPECT_GT(remaps_before({1, 0}, 10 * cost / loss, constant(1.1)), 0);
}

TEST(Balancing, NeedsAPartitionThatIsBetter) {
  EXPECT_EQ(remaps_before({1.09, 0}, long_run, constant(1.1)), 0);
  EXPECT_EQ(remaps_before({1, 0}, long_run, constant(1.04)), 0) << "patches stay whole";
  EXPECT_EQ(remaps_before({1, 0}, long_run, constant(2), BalanceRanks::never), 0);
  EXPECT_EQ(remaps_before({1.09, 0}, 0, constant(1.), BalanceRanks::always), 1);
}

/// An imbalance that comes and goes with the sorts of particles counts by its mean.
TEST(Balancing, SmoothsWhatComesAndGoes) {
  Balancing balancing(BalanceRanks::when_it_pays, 2, cells, true);
  for (int k = 0; k < 400; ++k) balancing.step((k % 20 == 0 ? 1 : 1.2) * mean), balancing.remap(2 * mean);
  EXPECT_NEAR(balancing.smoothed(), 1.19, 0.01);
}

/// A particle that changes cell is as much work as seven that stay, in a remap; steps between remaps are of cells.
TEST(Work, CountsWhatSoilThatFlowsCosts) {
  const WorkRates rates{Transfer{}};
  const WorkCounts still{.particles = 800, .runs = 100, .cells = 100};
  WorkCounts flowing = still;
  flowing.movers = 100;
  EXPECT_NEAR(rates.of(flowing, 1) - rates.of(still, 1), 700, 1e-9);
  EXPECT_NEAR(rates.of(flowing, 10) - rates.of(still, 10), 70, 1e-9);
  flowing.runs = 300;
  EXPECT_GT(rates.of(flowing, 3), 1.2 * rates.of(still, 3));
  WorkCounts crowded = still;
  crowded.particles *= 2;
  EXPECT_NEAR(rates.of(crowded, 1e9), rates.of(still, 1e9), 1e-3) << "their stress is that of the cell";
  Transfer own;
  own.average_stress = false;
  EXPECT_GT(WorkRates{own}.of(crowded, 1e9), 1.5 * WorkRates{own}.of(still, 1e9));
  const double part = WorkRates::without_round_off(rates.of(still, 7));
  EXPECT_EQ(part * 16, std::floor(part * 16));
  EXPECT_NEAR(part, rates.of(still, 7), 1. / 16);
}

}  // namespace
}  // namespace talus
