// Folders of results: one run at a time, nothing replaced unasked, nothing lost when files are damaged.
#include <gtest/gtest.h>

#include "scene.h"

namespace talus {
namespace {

class Results : public testing::Test {
 protected:
  Results() { folder_.write("section.csv", good_section), folder_.write("scene.toml", good_scene); }

  std::vector<std::string> run(const std::vector<std::string> &more, int ranks = 1) const {
    std::vector<std::string> words{"run", "scene.toml", "-o", "results", "--no-pictures"};
    words.insert(words.end(), more.begin(), more.end());
    return talus_words(words, ranks);
  }
  Ending end_of(const std::vector<std::string> &more, int ranks = 1) const {
    return Program(folder_, run(more, ranks)).end();
  }
  void expect(const Ending &ending, int status, const std::vector<std::string> &words) const {
    EXPECT_EQ(ending.status, status);
    for (const std::string &word : words) EXPECT_TRUE(ending.says(word)) << word;
    if (HasFailure()) ADD_FAILURE() << ending.output;
  }
  std::string content(const std::string &file) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / file).rdbuf();
    return text.str();
  }
  /// One that no run has written yet.
  std::string later_snapshot() const {
    int count = 0;
    for ([[maybe_unused]] const auto &file : std::filesystem::directory_iterator(folder_ / "results/run")) ++count;
    char name[32];
    std::snprintf(name, sizeof name, "results/run/%06d.h5", count + 2);
    return folder_ / name;
  }
  void damage(const std::string &file) const { folder_.write(file, "not what it was"); }

  const Folder folder_;
  const std::vector<std::string> endless_{"--set", "stage.0.duration=1000"};
};

TEST_F(Results, AreNotReplacedUnasked) {
  expect(end_of({}), 0, {"results are in results"});
  const std::string history = content("results/history.csv");
  for (int ranks : {1, 2})
    expect(end_of({"--set", "gravity=1"}, ranks), 2, {"results holds the results of a run", "--resume", "--force"});
  EXPECT_EQ(content("results/history.csv"), history);
  expect(end_of({"--force", "--set", "gravity=1"}), 0, {"results are in results"});
  EXPECT_NE(content("results/history.csv"), history);
}

TEST_F(Results, OfRunsAndComparisonsAreNotMixedUnasked) {
  const std::vector<std::string> set{"--set", "stage.0.duration=0.01"},
      compare{"compare", "scene.toml", "--series", "gravity: gravity=1,2", "--no-plot", "-o", "results"};
  EXPECT_EQ(end_of(set).status, 0);
  expect(Program(folder_, talus_words(compare, 1)).end(), 2, {"results holds the results of a run", "-o", "--force"});
  std::filesystem::remove_all(folder_ / "results");
  std::filesystem::create_directories(folder_ / "results/run000");
  folder_.write("results/run000/trial", "a run of a comparison");
  expect(end_of(set), 2, {"results holds the runs of a study or a comparison", "-o", "--force"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results/history.csv"));
  EXPECT_EQ(end_of({"--force", "--set", "stage.0.duration=0.01"}).status, 0);
}

TEST_F(Results, AreOfOneRunAtATime) {
  Program first(folder_, run(endless_));
  ASSERT_TRUE(first.wait_for(folder_ / "results/run/000002.h5")) << first.end().output;
  for (const char *word : {"--force", "--resume"})
    expect(end_of({word, "--set", "stage.0.duration=1000"}), 2, {"another run is writing into results", "-o"});
  first.signal(SIGKILL);
  first.end();
  const std::string next = later_snapshot();
  Program resumed(folder_, run({"--resume", "--set", "stage.0.duration=1000"}));  // a dead run locks nothing
  EXPECT_TRUE(resumed.wait_for(next)) << resumed.end().output;
  resumed.signal(SIGINT);
  expect(resumed.end(), 1, {"interrupted"});
}

TEST_F(Results, OfARunThatDiedAtOnceAreNotResumedFromAnOlderOne) {
  expect(end_of({}), 0, {});
  std::filesystem::create_directory(folder_ / "results/run/mesh.h5.part");  // in the way of the first file
  expect(end_of({"--force"}), 1, {"cannot write results/run/mesh.h5"});
  expect(end_of({"--resume"}), 2, {"results contains no checkpoint", "--force"});
}

TEST_F(Results, HaveAFolderThatHeedsOverrides) {
  folder_.write("slope.toml", good_scene);
  const Ending ending =
      talus(folder_, {"run", "slope.toml", "--no-pictures", "--set", "gravity=5 m/s2", "output.interval=0.02"});
  expect(ending, 0, {"results are in results/slope_gravity=5-m-s2_output.interval=0.02"});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "results/slope_gravity=5-m-s2_output.interval=0.02/run.h5"));
}

TEST_F(Results, GoOnBehindDamagedFiles) {
  Program first(folder_, run(endless_));
  ASSERT_TRUE(first.wait_for(folder_ / "results/run/000004.h5")) << first.end().output;
  first.signal(SIGINT);
  first.end();
  damage("results/run.h5"), damage("results/run/000001.h5");
  std::filesystem::remove(folder_ / "results/history.csv");
  const std::string next = later_snapshot();
  Program resumed(folder_, run({"--resume", "--set", "stage.0.duration=1000"}));
  EXPECT_TRUE(resumed.wait_for(next)) << resumed.end().output;
  resumed.signal(SIGINT);
  expect(resumed.end(), 1,
         {"warning: history.csv was missing", "warning: a damaged snapshot is left out", "run/000001.h5"});
  const Ending read = Program(folder_, {PYTHON, "-c",
                                        "import h5py\nrun = h5py.File('results/run.h5')['snapshots']\n"
                                        "print('read', *[n for n in run if run[n].attrs['step'] >= 0])"})
                          .end();
  expect(read, 0, {"read 000000 000002 000003 000004"});
}

/// A block with cohesion whose parts fly apart: without the cap that it has by default its particles grow with the gaps
/// between them.
TEST_F(Results, SayWhereGapsCountAsSoil) {
  for (const int ranks : {1, 2})
    for (const bool capped : {false, true}) {
      const Ending ending =
          end_of({"--force", "--set", "gravity=0", "body.sand.cohesion=10", "stage.0.duration=0.04",
                  "body.sand.velocity=['10 * x', '0']", "body.sand.volume_cap=" + std::string(capped ? "-1" : "0")},
                 ranks);
      EXPECT_EQ(ending.status, 0) << ending.output;
      EXPECT_EQ(ending.says("warning: body.sand has come apart"), !capped) << ending.output;
    }
}

/// Where pore fluids move there is no cap, which is therefore not recommended.
TEST_F(Results, SayWhereGapsOfWetSoilCount) {
  std::string wet = good_scene;
  const auto change = [&wet](const std::string &from, const std::string &to) {
    wet.replace(wet.find(from), from.size(), to);
  };
  change("gravity = 9.81", "gravity = 0\nphases = \"saturated\"");
  change("density = 2000",
         "porosity = 0.4\ngrain_density = 2600\npermeability = 1e-10\nvelocity = [\"10 * x\", \"0\"]");
  folder_.write("scene.toml", wet + "[water]\ntable = [[0, 0.5], [2, 0.5]]\nbulk_modulus = \"20 kPa\"\n");
  const Ending ending = end_of({});
  expect(ending, 0, {"warning: body.sand has come apart"});
  EXPECT_FALSE(ending.says("volume_cap")) << ending.output;
}

TEST_F(Results, ThatGetNoPicturesSaySo) {
  const Ending ending =
      Program(folder_, {"env", "PYTHONHOME=/nowhere", TALUS, "run", "scene.toml", "-o", "results"}).end();
  expect(ending, 1, {"the results in results are complete, but have no pictures", "talus plot results"});
  EXPECT_FALSE(ending.says("report.html to read"));
}

TEST(Start, NeedsRoomForTemporaryFiles) {
  const Folder folder;
  folder.write("file", "");
  const Ending ending = Program(folder, {"env", "TMPDIR=" + folder / "file", TALUS, "describe"}).end();
  EXPECT_EQ(ending.status, 1);
  EXPECT_TRUE(ending.says("cannot write temporary files in " + folder / "file")) << ending.output;
  EXPECT_TRUE(ending.says("set TMPDIR")) << ending.output;
}

/// Open MPI would make a folder of this name for all programs of a user, and remove it while others start.
TEST(Start, SharesNoFilesWithOtherPrograms) {
  const Folder folder;
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::string shared = "ompi." + std::string(host) + "." + std::to_string(getuid());
  std::filesystem::create_directory(folder / "temporary");
  folder.write("temporary/" + shared, "");
  const Ending ending = Program(folder, {"env", "TMPDIR=" + folder / "temporary", TALUS, "describe", "gravity"}).end();
  EXPECT_EQ(ending.status, 0) << ending.output;
  const std::filesystem::directory_iterator left(folder / "temporary");
  EXPECT_EQ(std::distance(begin(left), end(left)), 1) << "the program leaves nothing behind";
}

/// Of a section that has the same contents and is asked for in the same way, wherever its file is.
TEST(Start, TakesAMeshThatIsKept) {
  const Folder folder;
  folder.write("scene.toml", good_scene), folder.write("section.csv", good_section);
  const auto meshes = [&] {
    std::vector<std::string> names;
    for (const auto &file : std::filesystem::directory_iterator(folder / "kept"))
      names.push_back("kept/" + file.path().filename().string());
    return names;
  };
  const auto status = [&](const std::string &size = "0.25") {
    return Program(folder, {"env", "TALUS_KEPT_MESHES=" + folder / "kept", TALUS, "check", "scene.toml", "--set",
                            "mesh.size=" + size})
        .end()
        .status;
  };
  EXPECT_EQ(status(), 0);
  ASSERT_EQ(meshes().size(), 1u);
  folder.write(meshes()[0], "no mesh");
  EXPECT_EQ(status(), 2) << "it is taken as it is";
  EXPECT_EQ(status("0.2"), 0);
  folder.write("section.csv", good_section + "# another\n");
  EXPECT_EQ(status(), 0);
  EXPECT_EQ(meshes().size(), 3u);
  std::filesystem::remove_all(folder / "kept");
  folder.write("kept", "a file");
  EXPECT_EQ(status(), 0) << "kept nowhere";
}

TEST(Output, MayBeReadInPart) {
  const Folder folder;
  const Ending ending = Program(folder, {"sh", "-c", TALUS " describe | head -1 > /dev/null"}).end();
  EXPECT_EQ(ending.output, "");
}

}  // namespace
}  // namespace talus
