#include "meshes/halo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "box_mesh.h"
#include "meshes/background_mesh.h"

namespace talus {
namespace {

using test::BoxMesh;
using test::SharedFile;

/// A value that depends on the place, awkwardly for floating point, and on the rank, by a power of two: that product is
/// exact, so that a fused multiply-add in the claim cannot differ from the sum.
double value(const Vec<3> &x, int k, int rank) {
  return std::ldexp(std::sin(100 * x[0] + 10 * x[1] + x[2] + k), 17 * (rank % 3));
}

std::vector<double> records(const BackgroundMesh<3> &mesh, int rank, int width) {
  std::vector<double> values;
  for (const auto &x : mesh.position)
    for (int k = 0; k < width; ++k) values.push_back(value(x, k, rank));
  return values;
}

TEST(Halo, SumsAreRightAndTheSameToTheBitOnAllRanks) {
  const SharedFile file{BoxMesh(3, 6)};
  auto mesh = BackgroundMesh<3>::read(PETSC_COMM_WORLD, file.name(), {});
  int rank, size;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  for (int width : {4, 1, 7}) {
    auto values = records(mesh, rank, width);
    ASSERT_EQ(mesh.halo.sum(values.data(), width), 0);

    // Every rank sends place and sum of all its nodes; who else holds the place must have the same bits.
    std::vector<double> mine, all;
    for (int i = 0; i < mesh.node_count(); ++i) {
      mine.insert(mine.end(), mesh.position[i].begin(), mesh.position[i].end());
      mine.insert(mine.end(), values.begin() + i * width, values.begin() + (i + 1) * width);
    }
    int count = static_cast<int>(mine.size());
    std::vector<int> counts(size), first(size + 1, 0);
    MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, PETSC_COMM_WORLD);
    for (int r = 0; r < size; ++r) first[r + 1] = first[r] + counts[r];
    all.resize(first[size]);
    MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), first.data(), MPI_DOUBLE,
                   PETSC_COMM_WORLD);
    std::map<Vec<3>, std::vector<int>> holders;  // ranks, ascending
    std::map<Vec<3>, const double *> sums;
    for (int r = 0; r < size; ++r)
      for (int at = first[r]; at < first[r + 1]; at += 3 + width) {
        const Vec<3> x{all[at], all[at + 1], all[at + 2]};
        holders[x].push_back(r);
        const double *here = sums.try_emplace(x, &all[at + 3]).first->second;
        EXPECT_EQ(std::memcmp(here, &all[at + 3], width * sizeof(double)), 0);
      }
    for (const auto &[x, ranks] : holders)
      for (int k = 0; k < width; ++k) {
        double expected = 0;
        for (int r : ranks) expected += value(x, k, r);
        EXPECT_EQ(sums[x][k], expected);
      }
    if (size > 1) {
      EXPECT_FALSE(mesh.halo.empty());
    }
  }
}

TEST(Halo, EveryNodeIsOwnedOnce) {
  const SharedFile file{BoxMesh(3, 5)};
  auto mesh = BackgroundMesh<3>::read(PETSC_COMM_WORLD, file.name(), {});
  std::vector<double> owners(mesh.owned.begin(), mesh.owned.end());
  ASSERT_EQ(mesh.halo.sum(owners.data(), 1), 0);
  for (double count : owners) EXPECT_EQ(count, 1);
}

}  // namespace
}  // namespace talus
