// Claims of output/events.h.
#include "output/events.h"

#include <gtest/gtest.h>

#include <limits>

#include "fixtures.h"

namespace talus {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

const std::vector<Event> story{
    {event::body, "sand: 1 m3", {{"volume_m3", 1}, {"mass_kg", 1 / 3.}}, false, 0, 0, ""},
    {event::warning, "a \"quoted\" \\ text,\nof two lines", {}, true, 0.1, 2e5, "fall, or slide"},
    {event::failure, "gone \xff", {{"share", NAN}, {"ratio", inf}}, false, 1e-300, -1, "fall"}};

void expect_same(const std::vector<Event> &found, const std::vector<Event> &wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].kind, wanted[k].kind);
    EXPECT_EQ(found[k].stage, wanted[k].stage);
    EXPECT_EQ(found[k].warning, wanted[k].warning);
    EXPECT_EQ(found[k].time, wanted[k].time);
    EXPECT_EQ(found[k].load_time, wanted[k].load_time);
    ASSERT_EQ(found[k].values.size(), wanted[k].values.size());
    for (std::size_t i = 0; i < found[k].values.size(); ++i) {
      const auto &[name, value] = wanted[k].values[i];
      EXPECT_EQ(found[k].values[i].first, name);
      if (std::isfinite(value))
        EXPECT_EQ(found[k].values[i].second, value) << name;
      else
        EXPECT_TRUE(std::isnan(found[k].values[i].second)) << name;
    }
  }
}

TEST(Events, ComeBackFromTheirLines) {
  const std::string lines = to_lines(story);
  EXPECT_EQ(std::ranges::count(lines, '\n'), 3);
  const std::vector<Event> found = events_in(lines);
  expect_same(found, story);
  EXPECT_EQ(found[1].text, story[1].text);
  EXPECT_EQ(to_lines(found), lines) << "as a checkpoint keeps them";
  EXPECT_EQ(events_in(lines.substr(0, lines.size() - 1)).size(), 2u) << "a line that was cut off";
}

TEST(Events, AreInTheFileAtOnce) {
  const SharedFolder folder;
  EXPECT_TRUE(read_events(folder / "").empty());
  MPI_Barrier(MPI_COMM_WORLD);  // the first rank writes
  EventFile file(MPI_COMM_WORLD, folder / "", {story[0]});
  MPI_Barrier(MPI_COMM_WORLD);
  expect_same(read_events(folder / ""), {story[0]});
  MPI_Barrier(MPI_COMM_WORLD);
  file.add(story[1]);
  MPI_Barrier(MPI_COMM_WORLD);
  expect_same(read_events(folder / ""), {story[0], story[1]});
  file.complete(story);
  expect_same(read_events(folder / ""), {story[0], story[1]});  // nothing was lost, and nothing is written twice
}

TEST(Events, InADamagedFileAreRefusedWithItsName) {
  const SharedFolder folder;
  if (world_rank() == 0) std::ofstream(folder / "events.jsonl") << "{\"kind\": 1}\n";
  MPI_Barrier(MPI_COMM_WORLD);
  try {
    read_events(folder / "");
    FAIL();
  } catch (const std::runtime_error &error) {
    EXPECT_NE(std::string(error.what()).find("events.jsonl is damaged"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace talus
