// Claims of output/history.h.
#include "output/history.h"

#include <stdexcept>

#include "fixtures.h"

namespace talus {
namespace {

const std::vector<std::string> names{"crest_displacement_m", "kinetic_J"};

void write_four_rows(const std::string &path) {
  History history(MPI_COMM_WORLD, path, names);
  for (int n = 0; n < 4; ++n) history.row(0.1 * n, 10 * n, n < 2 ? "gravity" : "slide", {1. * n, 0.5});
}

TEST(History, is_a_csv_table) {
  const SharedFolder folder;
  write_four_rows(folder / "history.csv");
  if (world_rank()) return;
  EXPECT_EQ(content(folder / "history.csv"),
            "time_s,step,stage,crest_displacement_m,kinetic_J\n0,0,gravity,0,0.5\n0.1,10,gravity,1,0.5\n"
            "0.2,20,slide,2,0.5\n0.3,30,slide,3,0.5\n");
}

TEST(History, quotes_stage_names_that_need_it) {
  const SharedFolder folder;
  History history(MPI_COMM_WORLD, folder / "history.csv", std::vector<std::string>{});
  history.row(1, 2, "dig, then \"wait\"", {});
  if (world_rank()) return;
  EXPECT_EQ(content(folder / "history.csv"), "time_s,step,stage\n1,2,\"dig, then \"\"wait\"\"\"\n");
}

TEST(History, quotes_names_with_commas) {
  const SharedFolder folder;
  const std::string path = folder / "history.csv";
  { History(MPI_COMM_WORLD, path, {"a, \"b\"_m"}).row(1, 2, "s", {3}); }
  History::append(MPI_COMM_WORLD, path, {"a, \"b\"_m"}, 5);
  if (world_rank()) return;
  EXPECT_EQ(content(path), "time_s,step,stage,\"a, \"\"b\"\"_m\"\n1,2,s,3\n");
}

TEST(History, of_a_resumed_run_drops_what_came_later) {
  const SharedFolder folder;
  const std::string path = folder / "history.csv";
  write_four_rows(path);
  if (world_rank() == 0) std::ofstream(path, std::ios::app) << "0.4,4";  // the run died in this line
  MPI_Barrier(MPI_COMM_WORLD);
  History history = History::append(MPI_COMM_WORLD, path, names, 0.1 * 2);
  history.row(0.25, 25, "slide", {7, 8});
  if (world_rank()) return;
  EXPECT_EQ(content(path),
            "time_s,step,stage,crest_displacement_m,kinetic_J\n0,0,gravity,0,0.5\n0.1,10,gravity,1,0.5\n"
            "0.2,20,slide,2,0.5\n0.25,25,slide,7,8\n");
}

TEST(History, drops_a_line_that_was_cut_off) {
  const SharedFolder folder;
  const std::string path = folder / "history.csv";
  if (world_rank() == 0) std::ofstream(path) << "time_s,step,stage,a_m\n0,0,s,1\n0.1,1,s,2";
  MPI_Barrier(MPI_COMM_WORLD);
  History::append(MPI_COMM_WORLD, path, {"a_m"}, 5);
  if (world_rank()) return;
  EXPECT_EQ(content(path), "time_s,step,stage,a_m\n0,0,s,1\n");
}

/// A run knows the time of its last row; a table that ends before it has lost rows.
TEST(History, tells_that_rows_are_missing) {
  const SharedFolder folder;
  const std::string path = folder / "history.csv";
  const auto gap_at = [&](double time) {
    write_four_rows(path);
    MPI_Barrier(MPI_COMM_WORLD);
    const bool gap = History::append(MPI_COMM_WORLD, path, names, time).has_gap();
    MPI_Barrier(MPI_COMM_WORLD);
    return gap;
  };
  const bool whole = gap_at(0.1 * 3), later = gap_at(0.2), cut = gap_at(0.4);
  const bool none = History::append(MPI_COMM_WORLD, folder / "none.csv", names, 0.1).has_gap();
  if (world_rank()) return;
  EXPECT_FALSE(whole);
  EXPECT_FALSE(later) << "rows after the checkpoint do not matter";
  EXPECT_TRUE(cut);
  EXPECT_TRUE(none);
}

/// Rows that cannot be read are not rows that were never written: the table stays as it is.
TEST(History, is_not_cut_where_reading_fails) {
  EXPECT_THROW(History::append(MPI_COMM_WORLD, "/proc/self/mem", {"a_m"}, 5), std::runtime_error);
}

TEST(History, is_started_where_there_is_none) {
  const SharedFolder folder;
  History::append(MPI_COMM_WORLD, folder / "history.csv", {"a_m"}, 5);
  if (world_rank()) return;
  EXPECT_EQ(content(folder / "history.csv"), "time_s,step,stage,a_m\n");
}

TEST(History, refuses_what_does_not_fit) {
  const SharedFolder folder;
  write_four_rows(folder / "history.csv");
  EXPECT_THROW(History::append(MPI_COMM_WORLD, folder / "history.csv", {"other_m"}, 5), std::runtime_error);
  EXPECT_THROW(History(MPI_COMM_WORLD, folder / "missing/history.csv", names), std::runtime_error);
  History history(MPI_COMM_WORLD, folder / "history.csv", names);
  EXPECT_THROW(history.row(0, 0, "slide", {1}), std::runtime_error);
}

}  // namespace
}  // namespace talus
