// A run that has ended, or was interrupted, and is resumed with a changed scene: what may change goes on, what cannot
// be resumed is refused and left as it is.
#include <gtest/gtest.h>

#include "tests/exactness/bad_input/scene.h"

namespace talus {
namespace {

/// A short run that has ended.
class EndedRun : public testing::Test {
 protected:
  EndedRun() {
    folder_.write("section.csv", good_section), folder_.write("scene.toml", good_scene);
    EXPECT_EQ(run({}).status, 0);
  }
  Ending run(const std::vector<std::string> &more, int ranks = 1) {
    std::vector<std::string> words{"run", "scene.toml", "-o", "results", "--no-pictures"};
    words.insert(words.end(), more.begin(), more.end());
    return talus(folder_, words, ranks);
  }
  /// Bad input, and nothing of the results is touched.
  void expect_refused(const Ending &ending, const std::vector<std::string> &words) {
    EXPECT_EQ(ending.status, 2);
    for (const std::string &word : words) EXPECT_TRUE(ending.says(word)) << word;
    EXPECT_EQ(ending.count("talus: "), 1);
    EXPECT_FALSE(ending.says("PETSC ERROR"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "results/run/000005.h5"));
    if (HasFailure()) ADD_FAILURE() << ending.output;
  }
  std::string state() const {
    std::string last;
    for (const auto &file : std::filesystem::directory_iterator(folder_ / "results/checkpoint"))
      if (file.path().extension() == ".0") last = std::max(last, file.path().filename().string());
    return "results/checkpoint/" + last;
  }
  std::string content(const std::string &name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name, std::ios::binary).rdbuf();
    return text.str();
  }

  const Folder folder_;
};

TEST_F(EndedRun, GoesOnWithALongerStage) {
  const std::string history = content("results/history.csv");
  const Ending nothing_left = run({"--resume"});
  EXPECT_EQ(nothing_left.status, 0);
  EXPECT_TRUE(nothing_left.says("t = 0.05 of 0.05 s")) << nothing_left.output;
  EXPECT_TRUE(nothing_left.says("nothing was left to do: the run had reached its end")) << nothing_left.output;
  EXPECT_EQ(content("results/history.csv"), history);
  const Ending ending = run({"--resume", "--set", "stage.0.duration=0.08", "--set", "output.interval=0.02"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_FALSE(ending.says("nothing was left to do")) << ending.output;
  const std::string longer = content("results/history.csv");
  EXPECT_EQ(longer.compare(0, history.size(), history), 0);
  EXPECT_NE(longer.find("\n0.08,"), std::string::npos);
}

TEST_F(EndedRun, SaysThatItsStageHadLastedLonger) {
  const Ending ending = run({"--resume", "--set", "stage.0.duration=0.03"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("nothing was left to do: the last stage had lasted longer than its duration is now"));
  EXPECT_FALSE(ending.says("reached its duration")) << ending.output;
}

/// Loads come in shares of the duration of a stage by finite elements: it is not prolonged, and says so.
TEST_F(EndedRun, IsNotProlongedByElements) {
  const std::vector<std::string> elements{"--set", "stage.0.kind=quasi_static", "--set", "gravity=0"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), elements.begin(), elements.end());
    return run(more);
  };
  ASSERT_EQ(with({"--force"}).status, 0);
  const Ending ending = with({"--resume", "--set", "stage.0.duration=0.3"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("add a stage to go on from here")) << ending.output;
}

/// Soil at rest waits for a load that the longer duration brings.
TEST_F(EndedRun, WaitsForALoadWithALongerStage) {
  const std::vector<std::string> late{"--set", "stage.0.until=rest",
                                      "--set", "gravity=0",
                                      "--set", "functions.pull=[[0, 0], [2, 0], [3, 1]]",
                                      "--set", "body.sand.body_acceleration=[\"pull(t)\", \"0\"]"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), late.begin(), late.end());
    return run(more);
  };
  const Ending early = with({"--force", "--set", "stage.0.duration=1.5"});
  ASSERT_TRUE(early.says("came to rest")) << early.output;
  const Ending ending = with({"--resume", "--set", "stage.0.duration=2.3"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("goes on: body.sand.body_acceleration changes until t = 2.3 s")) << ending.output;
}

/// As the log advises where a run ends because motion creates energy.
TEST_F(EndedRun, GoesOnInShorterSteps) {
  const auto steps = [this] {  // the second number of the last row
    std::istringstream rows(content("results/history.csv"));
    std::string row, last;
    while (std::getline(rows, row)) last = row;
    return std::stod(last.substr(last.find(',') + 1));
  };
  const double before = steps();
  const Ending ending = run({"--resume", "--set", "stage.0.duration=0.1", "--set", "integrator.fraction=0.2"});
  ASSERT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("since then the scene has another integrator.fraction")) << ending.output;
  EXPECT_NEAR((steps() - before) / before, 0.6 / 0.2, 0.5);
}

TEST_F(EndedRun, IsNotResumedWithAnotherSoil) {
  expect_refused(run({"--resume", "--set", "body.sand.friction_angle=31"}),
                 {"body.sand.friction_angle = 31", "--resume"});
}

TEST_F(EndedRun, IsNotResumedWithAnotherMesh) {
  folder_.write("section.csv", changed(good_section, "interface0,1,0\n", "interface0,1.1,0\n"));
  expect_refused(run({"--resume"}), {"mesh"});
}

/// The newest checkpoint is damaged in many ways: the run goes on from the one before it and says so.
TEST_F(EndedRun, IsResumedFromTheCheckpointBeforeADamagedOne) {
  const std::string name = state(), whole = content(name), header = content("results/checkpoint/header");
  std::string damaged = whole;
  damaged[damaged.size() / 2] ^= 1;
  const auto expect_older = [&](const std::string &cause) {
    std::filesystem::copy(folder_ / "results", folder_ / "copy", std::filesystem::copy_options::recursive);
    const Ending ending = run({"--resume"});
    EXPECT_EQ(ending.status, 0) << ending.output;
    EXPECT_TRUE(ending.says("warning: ") && ending.says(cause) && ending.says("from the checkpoint before it"))
        << cause << "\n"
        << ending.output;
    EXPECT_TRUE(ending.says("resumed at t = 0.04 s")) << ending.output;
    EXPECT_TRUE(ending.says("t = 0.05 of 0.05 s")) << ending.output;
    EXPECT_GT(state(), name) << "numbers are not used twice";
    std::filesystem::remove_all(folder_ / "results");
    std::filesystem::rename(folder_ / "copy", folder_ / "results");
  };
  folder_.write(name, damaged);
  expect_older(name + " is damaged");
  folder_.write(name, whole.substr(0, whole.size() - 100));
  expect_older(name + " is damaged");
  folder_.write(name, "");
  expect_older(name + " is no checkpoint");
  std::filesystem::remove(folder_ / name);
  expect_older("cannot read " + name);
  folder_.write(name, whole), folder_.write("results/checkpoint/header", "?");
  expect_older("results/checkpoint/header is no checkpoint");
  folder_.write("results/checkpoint/header", header);
  EXPECT_FALSE(run({"--resume"}).says("warning"));
}

TEST_F(EndedRun, IsNotResumedWhereAllCheckpointsAreDamaged) {
  const std::string name = state();
  for (const auto &file : std::filesystem::directory_iterator(folder_ / "results/checkpoint"))
    if (file.path().extension() == ".0") folder_.write("results/checkpoint/" + file.path().filename().string(), "");
  expect_refused(run({"--resume"}), {name + " is no checkpoint"});
  std::filesystem::remove_all(folder_ / "results/checkpoint");
  expect_refused(run({"--resume"}), {"results contains no checkpoint"});
}

/// A snapshot that the disk does not give back is named, and its file stays.
TEST_F(EndedRun, KeepsALastSnapshotThatCannotBeRead) {
  folder_.write("results/run/000005.h5", "damaged");
  const Ending ending = run({"--resume", "--set", "stage.0.duration=0.08"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(
      ending.says("warning: a damaged snapshot is left out of run.h5 and run.xdmf: cannot open "
                  "results/run/000005.h5"))
      << ending.output;
  EXPECT_EQ(content("results/run/000005.h5"), "damaged");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "results/run/000008.h5"));
}

TEST_F(EndedRun, OutlivesAFullDisk) {
  const std::string name = state();
  std::vector<std::string> words{"run",           "scene.toml", "-o",    "results",
                                 "--no-pictures", "--resume",   "--set", "stage.0.duration=1000"};
  Program program(folder_, talus_words(words));
  ASSERT_TRUE(program.wait_for(folder_ / "results/run/000006.h5")) << program.end().output;
  program.limit_files(2000);
  const Ending full = program.end();
  EXPECT_EQ(full.status, 1);
  EXPECT_TRUE(full.says("File too large") && full.says("--resume goes on from t = ")) << full.output;
  const Ending ending = run({"--resume", "--set", "stage.0.duration=0.2"});
  EXPECT_EQ(ending.status, 0) << ending.output;
}

}  // namespace
}  // namespace talus
