// Claims of simulation/unlikely.h about results.
#include "simulation/unlikely.h"

#include <gtest/gtest.h>
#include <petscsys.h>

namespace talus {
namespace {

/// Of 200 particles of equal volume that each rank has of each of two bodies, `sheared` of the first have a plastic
/// strain of 12, on the last rank one of them of 31.
std::vector<std::string> doubts(int sheared) {
  int rank, ranks;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  Snapshot state;
  Column strain{"plastic_strain", "", "", 1, {}}, volume{"volume", "m3", "", 1, {}};
  for (int body = 0; body < 2; ++body)
    for (int i = 0; i < 200; ++i) {
      state.body.push_back(body);
      volume.values.push_back(0.1);
      strain.values.push_back(body == 1 ? 9.9 : i >= sheared ? 0.1 : i == 0 && rank == ranks - 1 ? 31 : 12);
    }
  state.columns = {strain, volume};
  std::vector<BodyReport> bodies(2);
  bodies[0].name = "clay", bodies[1].name = "sand";
  return unlikely_strains(PETSC_COMM_WORLD, bodies, state);
}

TEST(Unlikely, StrainsOfMoreThanAHundredthOfABodyAreDoubted) {
  EXPECT_TRUE(doubts(0).empty());
  EXPECT_TRUE(doubts(1).empty()) << "single particles";
  const std::vector<std::string> found = doubts(6);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].find("3 % of body.clay has a plastic strain above 1000 %, up to 3100 %"), 0u) << found[0];
}

}  // namespace
}  // namespace talus
