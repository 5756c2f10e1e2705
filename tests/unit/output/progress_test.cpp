// Claims of output/progress.h, with a clock that the test turns.
#include "output/progress.h"

#include <algorithm>
#include <stdexcept>

#include "fixtures.h"

namespace talus {
namespace {

long long lines_of(const std::string &text) { return std::count(text.begin(), text.end(), '\n'); }

/// `seconds` of a run with 100 steps of 1000 particles a second, each of 1 ms simulated time.
struct Spoken {
  std::string screen, log;
  long long looks = 0;
};
Spoken spoken(const SharedFolder &folder, int seconds) {
  Spoken spoken;
  double now = 0;
  std::FILE *screen = std::fopen((folder / ("screen" + std::to_string(world_rank()))).c_str(), "w+");
  {
    Progress progress(MPI_COMM_WORLD, folder / "run.log", 1000, false, screen, [&] {
      ++spoken.looks;
      return now;
    });
    progress.stage("slide");
    for (int n = 1; n <= 100 * seconds; ++n) {
      now += 0.01;
      progress.step(1e-3 * n, n, 1000, 300);
    }
    progress.note("the slope failed");
    progress.finish();
  }
  std::fclose(screen);
  spoken.screen = content(folder / ("screen" + std::to_string(world_rank())));
  spoken.log = content(folder / "run.log");
  return spoken;
}

TEST(Progress, tells_rate_and_remaining_time_now_and_then) {
  const SharedFolder folder;
  const Spoken said = spoken(folder, 60);
  if (world_rank()) {
    EXPECT_TRUE(said.screen.empty());
    return;
  }
  EXPECT_EQ(lines_of(said.screen), 8) << said.screen;  // at 2, 12, 22, 32, 42, 52 s; the note; the end
  EXPECT_NE(said.screen.find("slide  t = 1.215 of 1000 s  step 1215  "), std::string::npos) << said.screen;
  EXPECT_NE(said.screen.find("100 k particles/s, 30 k cells/s"), std::string::npos) << said.screen;
  EXPECT_NE(said.screen.find("at this rate 2 h 46 min left"), std::string::npos) << said.screen;
  EXPECT_NE(said.screen.find("the slope failed\n"), std::string::npos);
  EXPECT_EQ(lines_of(said.log), 4) << said.log;  // the stage, at 2 s, the note, the end
  EXPECT_EQ(said.log.substr(said.log.find("the slope failed")).find("left"), std::string::npos)
      << "after the end nothing is left";
  EXPECT_NE(said.log.find("slide  t = 6 of 1000 s  step 6000  done in 1 min 00 s"), std::string::npos) << said.log;
}

/// A run may go on from beyond its end, where its stages have become shorter.
TEST(Progress, resumes_beyond_the_end) {
  const SharedFolder folder;
  std::FILE *screen = std::fopen((folder / ("screen" + std::to_string(world_rank()))).c_str(), "w+");
  {
    Progress progress(MPI_COMM_WORLD, folder / "run.log", 9, false, screen);
    progress.resume(13.05, 100);
    progress.finish();
  }
  std::fclose(screen);
  if (world_rank()) return;
  const std::string said = content(folder / "screen0");
  EXPECT_NE(said.find("t = 13.05 of 13.05 s"), std::string::npos) << said;
}

/// What the screen of this rank shows of `run`(progress, clock).
template <class Run>
std::string said_of(const SharedFolder &folder, double total, Run run) {
  const std::string path = folder / ("screen" + std::to_string(world_rank()));
  std::FILE *screen = std::fopen(path.c_str(), "w+");
  double now = 0;
  {
    Progress progress(MPI_COMM_WORLD, folder / "run.log", total, false, screen, [&] { return now; });
    run(progress, now);
  }
  std::fclose(screen);
  return content(path);
}

/// Time of equilibria is no measure of work, and the rate of one stage is none of the next.
TEST(Progress, says_what_is_left_only_where_all_that_is_left_moves) {
  const SharedFolder folder;
  const std::string said = said_of(folder, 100, [](Progress &progress, double &now) {
    progress.stage("gravity", false);
    for (int n = 1; n <= 20; ++n) now += 5, progress.step(1e-2 * n, n, 1000, 300);
    progress.stage("slide");
    for (int n = 1; n <= 20; ++n) now += 5, progress.step(0.2 + n, 20 + n, 1000, 300);
  });
  if (world_rank()) return;
  const std::string gravity = said.substr(0, said.find("slide  t")),
                    slide = said.substr(gravity.size(), said.find('\n', gravity.size()) - gravity.size());
  EXPECT_GT(lines_of(gravity), 2) << said;
  EXPECT_EQ(gravity.find("left"), std::string::npos) << said;
  EXPECT_EQ(gravity.find("updates"), std::string::npos) << said;
  EXPECT_NE(slide.find("at this rate 8 min"), std::string::npos)
      << slide << "\n5 s for each of the 99 s, not of gravity";
}

TEST(Progress, says_that_little_is_left) {
  const SharedFolder folder;
  const std::string said = said_of(folder, 1, [](Progress &progress, double &now) {
    progress.stage("slide");
    for (int n = 1; n <= 95; ++n) now += 0.025, progress.step(0.01 * n, n, 1000, 300);
  });
  if (world_rank()) return;
  EXPECT_NE(said.find("at this rate less than 1 s left"), std::string::npos) << said;
}

/// Steps that write results may take a thousand times as long as the first ones.
TEST(Progress, is_told_also_where_the_first_step_is_quick) {
  const SharedFolder folder;
  const std::string said = said_of(folder, 1000, [](Progress &progress, double &now) {
    progress.stage("slide");
    for (int n = 1; n <= 1000; ++n) now += n == 1 ? 1e-6 : 0.05, progress.step(n, n, 1000, 300);
  });
  if (world_rank()) return;
  EXPECT_EQ(lines_of(said), 5) << said;  // at 2, 12, ... 42 s
}

/// One equilibrium of a large model may take an hour.
TEST(Progress, tells_of_iterations_between_two_steps) {
  const SharedFolder folder;
  const std::string said = said_of(folder, 1, [](Progress &progress, double &now) {
    progress.stage("gravity", false);
    for (int k = 1; k <= 100; ++k) now += 1, progress.seeking("gravity  iteration " + std::to_string(k));
  });
  if (world_rank()) return;
  const std::string log = content(folder / "run.log");
  EXPECT_EQ(lines_of(said), 10) << said;  // at 2, 12, ... 92 s
  EXPECT_NE(said.find("gravity  iteration 92\n"), std::string::npos) << said;
  EXPECT_EQ(lines_of(log), 3) << log;  // the stage, at 2 s and at 62 s
}

TEST(Progress, reads_the_clock_seldom) {
  const SharedFolder folder;
  const Spoken said = spoken(folder, 60);
  if (world_rank() == 0) {
    EXPECT_LT(said.looks, 700);
    EXPECT_GT(said.looks, 500);
  }
}

TEST(Progress, complains_about_a_log_that_cannot_be) {
  const SharedFolder folder;
  EXPECT_THROW(Progress(MPI_COMM_WORLD, folder / "missing/run.log", 1), std::runtime_error);
}

/// A full disk: the run goes on, but does not end as if nothing were missing.
TEST(Progress, complains_at_the_end_about_lines_that_were_lost) {
  const SharedFolder folder;
  std::FILE *screen = std::fopen((folder / ("screen" + std::to_string(world_rank()))).c_str(), "w+");
  {
    Progress progress(MPI_COMM_WORLD, "/dev/full", 1, false, screen);
    progress.stage("slide");
    progress.note("the slope failed");
    try {
      progress.finish();
      ADD_FAILURE() << "no complaint";
    } catch (const std::runtime_error &error) {
      EXPECT_NE(std::string(error.what()).find("/dev/full lacks lines: No space left"), std::string::npos)
          << error.what();
    }
  }
  std::fclose(screen);
  const std::string said = content(folder / ("screen" + std::to_string(world_rank())));
  if (world_rank() == 0) {
    EXPECT_EQ(lines_of(said.substr(0, said.find("the slope failed"))), 1) << said;
    EXPECT_NE(said.find("warning: cannot write /dev/full: No space left"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace talus
