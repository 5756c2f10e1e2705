// Claims of simulation/still_moving.h.
#include "simulation/still_moving.h"

#include <gtest/gtest.h>
#include <petscsys.h>

namespace talus {
namespace {

/// Each rank has 500 particles of 1 m3 and 2000 kg in space. The first 400 have moved by `way`, and of these the first
/// `fast` move with 3 m/s, all others with 0.05 m/s.
std::optional<MotionLeft> left(int fast, double way = 5) {
  Snapshot state;
  Column displacement{"displacement", "m", "", 3, {}}, velocity{"velocity", "m/s", "", 3, {}},
      mass{"mass", "kg", "", 1, {}}, volume{"volume", "m3", "", 1, {}};
  for (int i = 0; i < 500; ++i) {
    state.id.push_back(i);
    displacement.values.insert(displacement.values.end(), {i < 400 ? 0.6 * way : 0, i < 400 ? 0.8 * way : 0, 0});
    velocity.values.insert(velocity.values.end(), {0, i < fast ? -3 : 0.05, 0});
    mass.values.push_back(2000), volume.values.push_back(1);
  }
  state.columns = {displacement, velocity, mass, volume};
  return still_moving(PETSC_COMM_WORLD, state);
}

TEST(StillMoving, BeginsWithAHundredthOfTheMassThatSlid) {
  EXPECT_FALSE(left(4)) << "4 of 400";
  const auto five = left(5);
  ASSERT_TRUE(five);
  EXPECT_DOUBLE_EQ(five->share, 0.0125);
  EXPECT_DOUBLE_EQ(five->speed, 3);  // that 99.9 % have at most
  EXPECT_EQ(five->sentence(), "1.25 % of what slid is faster than 0.1 m/s, at up to 3 m/s");
}

TEST(StillMoving, IsNoSlideBelowATenthOfTheSpacing) {
  EXPECT_FALSE(left(400, 0.09));
  EXPECT_TRUE(left(400, 0.11));
}

TEST(StillMoving, IsThatOfAllRanks) {
  int rank, ranks;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank), MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const auto found = left(rank == 0 ? 400 : 0);
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->share, 1. / ranks);
  EXPECT_DOUBLE_EQ(found->speed, 3);
}

TEST(StillMoving, NeedsParticles) {
  Snapshot none;
  for (const auto &[name, components] : {std::pair{"displacement", 2}, {"velocity", 2}, {"mass", 1}, {"volume", 1}})
    none.columns.push_back({name, "", "", components, {}});
  EXPECT_FALSE(still_moving(PETSC_COMM_WORLD, none));
}

}  // namespace
}  // namespace talus
