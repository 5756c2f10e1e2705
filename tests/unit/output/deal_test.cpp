// The state of some ranks, dealt out to others: every row comes to who has its cell or point, once, and in order.
#include "output/deal.h"

#include <numeric>

#include "fixtures.h"

namespace talus {
namespace {

constexpr long long cells = 40, points = 23;

/// What a module would store: a row for each thing of this rank, two for the points that 3 divides.
struct Module {
  std::vector<long long> cell, point;
  std::vector<double> stress;
  std::vector<int> place;
  double sum = 0, largest = 0, common = 0;

  void serialize(Archive &archive) {
    archive.serialize("common", common);
    const Archive::Rows of_cells = archive.rows("cells", Belongs::to_cells, cell);
    archive.column(of_cells, "stress", stress, 2);
    archive.sums("sum", sum);
    archive.largest("largest", largest);
    const Archive::Rows of_points = archive.rows("points", Belongs::to_points, point);
    archive.column(of_points, "place", place);
  }
};

/// Cell c is on one of `ranks`, and points on two of them.
bool has_cell(long long c, int rank, int ranks) { return c * c % ranks == rank; }
bool has_point(long long p, int rank, int ranks) { return p % ranks == rank || (p + 1) % ranks == rank; }

Module module_of(int rank, int ranks) {
  Module module;
  for (long long c = 0; c < cells; ++c)
    if (has_cell(c, rank, ranks))
      module.cell.push_back(c), module.stress.insert(module.stress.end(), {c * 10., c * 20.});
  for (long long p = 0; p < points; ++p)
    for (int k = 0; has_point(p, rank, ranks) && k < (p % 3 ? 1 : 2); ++k)
      module.point.push_back(p), module.place.push_back(static_cast<int>(10 * p + k));
  module.sum = rank + 1, module.largest = 5 - rank, module.common = 7;
  return module;
}

/// From `written` ranks to those of the test.
Module dealt_from(int written) {
  const int rank = world_rank(), ranks = world_size();
  std::vector<Archive> parts;
  for (int r = (rank * written + ranks - 1) / ranks; r < ((rank + 1) * written + ranks - 1) / ranks; ++r) {
    Archive archive;
    module_of(r, written).serialize(archive);
    parts.emplace_back(archive.bytes());
  }
  Holdings mine;
  for (long long c = cells - 1; c >= 0; --c)
    if (has_cell(c, rank, ranks)) mine.cells.push_back(c);
  for (long long p = 0; p < points; ++p)
    if (has_point(p, rank, ranks)) mine.points.push_back(p);
  Archive archive = deal(MPI_COMM_WORLD, parts, mine);
  Module module;
  module.serialize(archive);
  return module;
}

TEST(Deal, BringsRowsToWhoHasThem) {
  const Module wanted = module_of(world_rank(), world_size());
  for (const int written : {1, 2, 3, 4, 7}) {
    SCOPED_TRACE(written);
    const Module got = dealt_from(written);
    EXPECT_EQ(got.cell, std::vector(wanted.cell.rbegin(), wanted.cell.rend()));  // as this rank wants them
    for (size_t k = 0; k < got.cell.size(); ++k) {
      EXPECT_EQ(got.stress[2 * k], 10. * got.cell[k]);
      EXPECT_EQ(got.stress[2 * k + 1], 20. * got.cell[k]);
    }
    EXPECT_EQ(got.point, wanted.point);
    EXPECT_EQ(got.place, wanted.place);
    double sum;
    MPI_Allreduce(&got.sum, &sum, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_EQ(sum, written * (written + 1) / 2);
    EXPECT_EQ(got.largest, 5);
    EXPECT_EQ(got.common, 7);
  }
}

/// A vector that no rank has filled stays as it is; one that only some have is a fault.
TEST(Deal, KnowsAbsentColumns) {
  const auto deal_with = [](bool first, bool second) {
    std::vector<Archive> parts;
    for (const bool filled : {first, second}) {
      if (world_rank() > 0) break;
      Archive archive;
      std::vector<long long> owner{filled == first && parts.empty() ? 0 : 1};
      std::vector<double> column(filled ? 1 : 0, 3.);
      archive.column(archive.rows("cells", Belongs::to_cells, owner), "column", column);
      parts.emplace_back(archive.bytes());
    }
    Holdings mine;
    if (world_rank() == 0) mine.cells = {0, 1};
    Archive archive = deal(MPI_COMM_WORLD, parts, mine);
    std::vector<long long> owner;
    std::vector<double> column;
    archive.column(archive.rows("cells", Belongs::to_cells, owner), "column", column);
    return column;
  };
  EXPECT_EQ(deal_with(true, true), std::vector<double>(world_rank() == 0 ? 2 : 0, 3.));
  EXPECT_TRUE(deal_with(false, false).empty());
  EXPECT_THROW(deal_with(true, false), std::runtime_error);
}

TEST(Deal, RefusesWhatNobodyHasAndWhatRanksContradict) {
  const auto deal_with = [](long long cell, double common) {
    std::vector<Archive> parts;
    for (int k = 0; world_rank() == 0 && k < 2; ++k) {
      Archive archive;
      std::vector<long long> owner{cell};
      double value = k ? common : 1;
      archive.rows("cells", Belongs::to_cells, owner);
      archive.serialize("value", value);
      parts.emplace_back(archive.bytes());
    }
    (void)deal(MPI_COMM_WORLD, parts, {world_rank() == 0 ? std::vector<long long>{4} : std::vector<long long>{}, {}});
  };
  EXPECT_NO_THROW(deal_with(4, 1));
  EXPECT_THROW(deal_with(5, 1), std::runtime_error);
  EXPECT_THROW(deal_with(4, 2), std::runtime_error);
}

}  // namespace
}  // namespace talus
