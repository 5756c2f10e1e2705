// Studies by `talus study`: which values run, what a stop, a failed run and more samples do, and what is refused.
#include <gtest/gtest.h>
#include <sys/file.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "csv_table.h"
#include "scene.h"
#include "scene/scene.h"

namespace talus {
namespace {

const std::string good_study = R"(scene = "scene.toml"
samples = 6
measures = ["max:corner_velocity_m_s"]
set = ["stage.fall.duration=0.02"]
[variable.speed]
key = "body.sand.velocity"
kind = "choice"
choices = ['["0", "0"]', '["0.5", "0"]']
[variable.modulus]
key = "body.sand.young_modulus"
unit = "MPa"
kind = "lognormal"
mean = 1
coefficient_of_variation = 0.3
[variable.density]
key = "body.sand.density"
kind = "uniform"
low = 1800
high = 2100
[[correlation]]
between = ["modulus", "density"]
coefficient = 0.5
[criterion.moves]
outcome = "corner_largest_speed_m_s"
above = 0.4
)";

/// One quick run.
const std::string short_study = R"(scene = "scene.toml"
[variable.density]
key = "body.sand.density"
kind = "list"
values = [1800]
)";

class Study : public testing::Test {
 protected:
  Study() {
    folder_.write("section.csv", good_section);
    folder_.write("scene.toml", good_scene + "[output.point.corner]\nposition = [1, 0.5]\n");
    folder_.write("study.toml", good_study);
  }
  std::vector<std::string> words(const std::vector<std::string> &more) const {
    std::vector<std::string> all{"study", "study.toml", "-o", "out", "-j", "2"};
    all.insert(all.end(), more.begin(), more.end());
    return talus_words(all);
  }
  Ending study(const std::vector<std::string> &more = {"--no-plot"}) const {
    return Program(folder_, words(more)).end();
  }
  Ending command(const std::vector<std::string> &words) const { return Program(folder_, talus_words(words)).end(); }
  /// Processes whose command line has this text, in the folder of the test.
  std::vector<pid_t> processes_with(const std::string &text) const {
    std::vector<pid_t> found;
    for (const auto &entry : std::filesystem::directory_iterator("/proc")) {
      std::ifstream file(entry.path() / "cmdline");
      const std::string words{std::istreambuf_iterator<char>(file), {}};
      std::error_code none;
      if (words.find(text) != std::string::npos &&
          std::filesystem::read_symlink(entry.path() / "cwd", none) == folder_.path())
        found.push_back(std::stoi(entry.path().filename().string()));
    }
    return found;
  }
  const Folder folder_;
};

// two speeds for each of six samples; the faster half of the runs meets the criterion
TEST_F(Study, RunsSamplesOverAGrid) {
  const Ending ending = study({});
  ASSERT_EQ(ending.status, 0) << ending.output;
  const auto rows = csv_table(folder_ / "out/study.csv");
  ASSERT_EQ(rows.size(), 12u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].at("failure"), "");
    EXPECT_EQ(rows[i].at("modulus"), rows[i - i % 2].at("modulus")) << "the grid belongs to one sample";
    EXPECT_EQ(rows[i].at("meets_moves"), i % 2 ? "yes" : "no");
    EXPECT_GT(std::stod(rows[i].at("max:corner_velocity_m_s")), i % 2 ? 0.4 : -1e-9);
  }
  // the speed is chosen and has no probability: each has its own, of six samples
  EXPECT_TRUE(
      ending.says("speed = [\"0\", \"0\"]: corner_largest_speed_m_s above 0.4 in 0 of 6 runs, probability 0, "
                  "95 % interval 0 to 0.4593"))
      << ending.output;
  EXPECT_TRUE(ending.says("in 6 of 6 runs, probability 1, 95 % interval 0.5407 to 1")) << ending.output;
  EXPECT_FALSE(ending.says("of 12 runs, probability")) << ending.output;
  for (const char *picture : {"tornado.png", "scatter.png", "exceedance.png"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / ("out/" + std::string(picture)))) << picture;
}

/// A misspelt measure is refused before anything runs, and every column that a run has is a measure.
TEST_F(Study, KnowsTheColumnsOfItsRunsBeforehand) {
  const auto measured = [&](const std::string &measures) {
    return study({"--no-plot", "--set", "measures=[" + measures + "]", "--set", "samples=1"});
  };
  const Ending ending = measured("\"max:cornr_velocity_m_s\"");
  EXPECT_EQ(ending.status, 2);
  EXPECT_TRUE(ending.says("history.csv has no column cornr_velocity_m_s; did you mean `corner_velocity_m_s`?"))
      << ending.output;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  ASSERT_EQ(measured("\"corner_x_m\"").status, 0);
  std::string all;
  const auto history = csv_table(folder_ / "out/run00000/history.csv");
  ASSERT_FALSE(history.empty());
  for (const auto &[name, value] : history.front())
    if (name != "stage") all += (all.empty() ? "\"" : ", \"") + name + "\"";
  EXPECT_NE(all.find("\"dissipated_J\""), std::string::npos) << all;
  const Ending every = measured(all);
  EXPECT_EQ(every.status, 0) << every.output;
}

TEST_F(Study, StopsAtASignalAndGoesOn) {
  {
    Program program(folder_, words({"--no-plot"}));
    ASSERT_TRUE(program.wait_for(folder_ / "out/run00002/trial"));
    program.signal(SIGTERM);
    const Ending ending = program.end();
    EXPECT_EQ(ending.status, 1) << ending.output;
    EXPECT_TRUE(ending.says("the same command continues with the missing runs")) << ending.output;
  }
  const auto some = csv_table(folder_ / "out/study.csv").size();
  EXPECT_TRUE(some >= 3 && some < 12) << "a table of what was done";
  const auto written = std::filesystem::last_write_time(folder_ / "out/run00000/history.csv");
  const Ending ending = study();
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says(" of 12 runs were completed before")) << ending.output;
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "out/run00000/history.csv"), written);
  EXPECT_EQ(csv_table(folder_ / "out/study.csv").size(), 12u);
  // more samples continue the study, other values are not taken for them
  EXPECT_TRUE(study({"--no-plot", "--set", "samples=7"}).says("12 of 14 runs were completed before"));
  const Ending fewer = study({"--no-plot", "--set", "samples=3"});
  EXPECT_EQ(fewer.status, 2);
  EXPECT_TRUE(fewer.says("out holds more runs of this study than the 6 that are asked for")) << fewer.output;
  EXPECT_EQ(csv_table(folder_ / "out/study.csv").size(), 14u) << "the table is what it was";
  const Ending other = study({"--no-plot", "--set", "samples=7", "--set", "seed=2"});
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(other.says("or give --force to replace it")) << other.output;
}

/// Runs of a study that was killed end too: nobody writes into their folders any more.
TEST_F(Study, TakesItsRunsAlongWhenItIsKilled) {
  Program program(folder_, words({"--no-plot", "--set", "set=[\"stage.fall.duration=1000\"]"}));
  for (const char *run : {"out/run00000", "out/run00001"})  // two at a time
    ASSERT_TRUE(program.wait_for(folder_ / (std::string(run) + "/history.csv"))) << program.end().output;
  program.signal(SIGKILL);
  program.end();
  for (const char *run : {"out/run00000", "out/run00001"}) {
    const int file = open((folder_ / (std::string(run) + "/.lock")).c_str(), O_RDWR);
    ASSERT_GE(file, 0);
    bool free = false;
    for (int i = 0; i < 1000 && !free; ++i) {
      free = flock(file, LOCK_EX | LOCK_NB) == 0;
      if (!free) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    close(file);
    EXPECT_TRUE(free) << run << " goes on ten seconds after its study was killed";
  }
}

/// Also where they do not ask for signals: 40 000 cells are made, read and searched for neighbours before the first
/// step.
TEST_F(Study, TakesItsRunsAlongBeforeTheirFirstStep) {
  Program program(folder_, words({"--no-plot", "--set", "set=[\"mesh.size=0.005\"]"}));
  ASSERT_TRUE(program.wait_for(folder_ / "out/run00000/screen")) << program.end().output;
  const auto runs = [&] { return processes_with("out/run00000").size(); };
  for (int i = 0; i < 1000 && runs() == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::seconds(1));  // it has begun to listen to signals
  ASSERT_GT(runs(), 0u);
  program.signal(SIGKILL);
  program.end();
  for (int i = 0; i < 90 && runs() > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(runs(), 0u) << "nine seconds after its study was killed";
}

TEST_F(Study, EntersRunsThatFail) {
  folder_.write("study.toml", changed(good_study, "[\"0.5\", \"0\"]", "[\"400\", \"0\"]"));
  const Ending ending = study();
  EXPECT_EQ(ending.status, 0) << ending.output;
  const auto rows = csv_table(folder_ / "out/study.csv");
  ASSERT_EQ(rows.size(), 12u);
  EXPECT_NE(rows[1].at("failure").find("left the mesh"), std::string::npos) << rows[1].at("failure");
  EXPECT_EQ(rows[1].at("meets_moves"), "");
  // Clopper and Pearson with none of 6 and, unknown counted as met, 6 of 6
  EXPECT_TRUE(ending.says("in 0 of 6 runs, probability 0, 95 % interval 0 to 0.4593")) << ending.output;
  EXPECT_TRUE(ending.says("in 0 of 0 runs, probability unknown, 95 % interval 0 to 1; unknown in 6 runs"))
      << ending.output;
}

TEST_F(Study, RepeatsRunsThatFailedOnlyWhereForced) {
  folder_.write("study.toml", R"toml(scene = "scene.toml"
[variable.speed]
key = "body.sand.velocity"
kind = "choice"
choices = ['["0", "0"]', '["400", "0"]']
)toml");
  EXPECT_EQ(study().status, 0);
  EXPECT_TRUE(study().says("2 of 2 runs were completed before"));
  EXPECT_TRUE(study({"--no-plot", "--force"}).says("1 of 2 runs were completed before"));
}

/// What ends a run from outside says nothing about its scene: the same command repeats it, and no table has it.
TEST_F(Study, RepeatsRunsThatWereKilled) {
  folder_.write("study.toml", "set = [\"stage.fall.duration=0.2\"]\n" + changed(short_study, "1800", "1800, 2000"));
  for (const auto &[signal, force] : {std::pair{SIGKILL, false}, {SIGTERM, true}}) {
    const std::string out = force ? "forced" : "out";
    std::vector<std::string> words{"study", "study.toml", "-o", out, "-j", "1", "--no-plot"};
    Program program(folder_, talus_words(words));
    ASSERT_TRUE(program.wait_for(folder_ / (out + "/run00001/history.csv"))) << program.end().output;
    const std::vector<pid_t> run = processes_with(out + "/run00001");
    ASSERT_EQ(run.size(), 1u);
    kill(run.front(), signal);
    const Ending ending = program.end();
    EXPECT_EQ(ending.status, 1) << ending.output;
    EXPECT_TRUE(ending.says("1 of 2 runs were ended from outside")) << ending.output;
    EXPECT_EQ(csv_table(folder_ / (out + "/study.csv")).size(), 1u);
    if (force) words.push_back("--force");
    const Ending again = command(words);
    EXPECT_EQ(again.status, 0) << again.output;
    EXPECT_TRUE(again.says("1 of 2 runs were completed before")) << again.output;
    const auto rows = csv_table(folder_ / (out + "/study.csv"));
    ASSERT_EQ(rows.size(), 2u);
    for (const Row &row : rows) EXPECT_EQ(row.at("failure"), "");
  }
}

/// A run depends on the files that its scene names, in studies and comparisons alike.
TEST_F(Study, RepeatsRunsWhoseFilesHaveChanged) {
  const auto grid = [](const std::string &value) {
    return "ncols 2\nnrows 2\nxllcorner -10\nyllcorner -10\ncellsize 20\n" + value + " " + value + "\n" + value + " " +
           value + "\n";
  };
  folder_.write("push.asc", grid("1"));
  folder_.write("scene.toml", changed(good_scene, "cohesion", "velocity = [\"push(x, 0)\", \"0\"]\ncohesion") +
                                  "[grids]\npush = \"push.asc\"\n");
  folder_.write("study.toml", short_study);
  const std::pair<std::vector<std::string>, std::string> commands[] = {
      {{"study", "study.toml", "-o", "out", "--no-plot"}, "out/study.csv"},
      {{"compare", "scene.toml", "-o", "compared", "--no-plot", "--series", "sand: body.sand.density=1800"},
       "compared/study.csv"}};
  const auto moved = [&](const std::string &table) {
    return std::stod(csv_table(folder_ / table).back().at("largest_displacement_m"));
  };
  for (const auto &[words, table] : commands) {
    folder_.write("push.asc", grid("1"));
    ASSERT_EQ(command(words).status, 0);
    const double before = moved(table);
    folder_.write("push.asc", grid("2"));
    const Ending ending = command(words);
    EXPECT_TRUE(ending.says("push.asc has changed; runs to repeat: 1")) << ending.output;
    EXPECT_FALSE(ending.says("completed before")) << ending.output;
    EXPECT_GT(moved(table), 1.5 * before) << table;
  }
  folder_.write("section.csv", changed(good_section, "region_air,1.5,0.5", "region_air,1.6,0.5"));
  EXPECT_TRUE(command(commands[0].first).says("section.csv has changed; runs to repeat: 1"));
}

/// The lock of a program that was killed is gone with it, though its file stays.
TEST_F(Study, KeepsASecondOneOutOfItsFolder) {
  folder_.write("study.toml", short_study);
  std::filesystem::create_directories(folder_ / "out");
  const int file = open((folder_ / "out/.lock").c_str(), O_RDWR | O_CREAT, 0666);
  ASSERT_EQ(flock(file, LOCK_EX), 0);
  const Ending second = study();
  EXPECT_EQ(second.status, 2);
  EXPECT_TRUE(second.says("is writing into out; wait for its end, or choose another folder with -o")) << second.output;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/run00000"));
  close(file);
  EXPECT_EQ(study().status, 0);
}

/// Soil that left, and warnings, are columns of each run and a sentence of the summary.
TEST_F(Study, TellsOfSoilThatLeftTheMesh) {
  folder_.write("study.toml", R"toml(scene = "scene.toml"
set = ["mesh.leaving_particles=remove"]
[variable.speed]
key = "body.sand.velocity"
kind = "choice"
choices = ['["0", "0"]', '["0", "100 * max(0, x - 0.8)"]']
)toml");
  ;
  const Ending ending = study();
  ASSERT_EQ(ending.status, 0) << ending.output;
  const auto rows = csv_table(folder_ / "out/study.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(std::stod(rows[0].at("escaped_mass_kg")), 0);
  const double gone = std::stod(rows[1].at("escaped_mass_kg")), share = std::stod(rows[1].at("escaped_share"));
  EXPECT_GT(gone, 10);
  EXPECT_NEAR(share, gone / 1000, 1e-3 * share) << "of a block of 1000 kg/m";
  EXPECT_TRUE(ending.says("soil left the mesh in 1 of 2 runs (at most ")) << ending.output;
  EXPECT_TRUE(ending.says("% of it, run00001), and ")) << ending.output;
  for (const Row &row : rows)
    EXPECT_EQ(std::stoi(row.at("warning_count")),
              row.at("warnings").empty() ? 0 : 1 + std::ranges::count(row.at("warnings"), '|'));
}

/// The library is not looked for, so that it need not be there.
TEST_F(Study, LoadsNoLibraryWhereThatIsForbidden) {
  folder_.write("scene.toml", changed(good_scene,
                                      "law = \"mohr_coulomb\"\nyoung_modulus = \"1 MPa\"\npoisson_ratio = "
                                      "0.3\ncohesion = 0\nfriction_angle = 30\n",
                                      "law = \"umat\"\nlibrary = \"none.so\"\n"));
  folder_.write("study.toml", short_study);
  for (const std::vector<std::string> &words :
       {std::vector<std::string>{"study", "study.toml"},
        {"compare", "scene.toml", "--series", "sand: body.sand.density=1800,2000"},
        {"converge", "scene.toml"}}) {
    std::vector<std::string> forbidden = words;
    forbidden.insert(forbidden.end(), {"-o", "out", "--no-umat"});
    const Ending ending = command(forbidden);
    EXPECT_EQ(ending.status, 2);
    EXPECT_TRUE(ending.says("body.sand.law = \"umat\" must not be a UMAT with --no-umat")) << ending.output;
  }
}

TEST_F(Study, ComputesFactorsOfSafety) {
  folder_.write("study.toml", R"(scene = "scene.toml"
runs = "factor_of_safety"
set = ["stage.fall.kind=quasi_static", "body.sand.cohesion=8 kPa", "body.sand.friction_angle=0"]
[variable.density]
key = "body.sand.density"
kind = "list"
values = [1000, 2000]
)");
  const Ending ending = study();
  ASSERT_EQ(ending.status, 0) << ending.output;
  const auto rows = csv_table(folder_ / "out/study.csv");
  ASSERT_EQ(rows.size(), 2u);
  // F of soil without friction is proportional to 1 / density; the search for it stops within 0.006
  const double light = std::stod(rows[0].at("factor_of_safety")), heavy = std::stod(rows[1].at("factor_of_safety"));
  EXPECT_NEAR(light / heavy, 2, 0.02);
}

// every complaint names the file, the line, the key and what is wrong
TEST_F(Study, RefusesWhatItCannotDo) {
  for (const auto &[from, to, said] :
       {std::array<std::string, 3>{"samples = 6\n", "", "study.toml: samples is missing"},
        {"samples = 6", "samples = -1", "study.toml line 2: samples = -1 (number of samples"},
        {"mean = 1\n", "", "study.toml line 9: variable.modulus needs mean"},
        {"mean = 1\n", "mean = -1\n", "line 13: variable.modulus.mean = -1 must be above 0"},
        {"unit = \"MPa\"", "unit = \"MPq\"", "MPq"},
        {"high = 2100", "high = 1700", "low"},
        {"kind = \"choice\"\nchoices = ['[\"0\", \"0\"]', '[\"0.5\", \"0\"]']",
         "kind = \"choice\"\nchoices = ['4', '8 kPa']",
         "line 8: variable.speed.choices = [\"4\", \"8 kPa\"] has numbers without a unit and in kPa"},
        {"\"body.sand.velocity\"\nkind = \"choice\"\nchoices = ['[\"0\", \"0\"]', '[\"0.5\", \"0\"]']",
         "\"body.sand.material\"\nkind = \"choice\"\nchoices = ['loose_sand', 'dense_sand']",
         "varies body.sand.material, and the scene states friction_angle, young_modulus of this body"},
        {"\"lognormal\"", "\"lognormel\"", "did you mean `lognormal`"},
        {"sand.young_modulus", "sand.young_module", "young_module"},
        {"coefficient = 0.5", "coefficient = 2", "must be a number from -0.999 to 0.999"},
        {"[\"modulus\", \"density\"]", "[\"modulus\", \"densty\"]", "did you mean `density`"},
        {"\"corner_largest_speed_m_s\"", "\"corner_speed\"", "criterion.moves.outcome"},
        {"above = 0.4", "above = 0.4\nbelow = 1", "needs one of below and above"},
        {"high = 2100", "high = 2e9", "body.sand.density=1"},
        {"\"body.sand.density\"", "\"body.sand.young_modulus\"",
         "variable.density.key = \"body.sand.young_modulus\" gives values to body.sand.young_modulus and to "
         "body.sand.young_modulus, of which one would replace the other"},
        {"\"body.sand.density\"", "[\"stage.0.duration\", \"stage.fall.duration\"]",
         "gives values to stage.0.duration and to stage.fall.duration, of which one would replace the other"},
        {"\"body.sand.density\"", "\"body.sand\"", "gives values to body.sand.velocity and to body.sand, of which"},
        {"max:corner_velocity", "corner_velocity@now", "must be COLUMN, COLUMN@TIME or max:COLUMN"},
        {"scene.toml", "scen.toml", "study.toml line 1: scene"}}) {
    folder_.write("study.toml", changed(good_study, from, to));
    const Ending ending = study();
    EXPECT_EQ(ending.status, 2) << said;
    EXPECT_TRUE(ending.says(said)) << "expected: " << said << "\n" << ending.output;
  }
}

}  // namespace
}  // namespace talus
