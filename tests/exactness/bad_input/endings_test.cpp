// Runs that cannot go on: status 1, one message that says where and when, and all snapshots written before can be read.
#include <gtest/gtest.h>

#include "scene.h"

namespace talus {
namespace {

/// Reads every dataset of every snapshot through run.h5, as a script would; returns how many snapshots there are.
int snapshots_read_by_h5py(const Folder &folder, const std::string &results) {
  const std::string script =
      "import h5py, numpy\n"
      "run = h5py.File('" +
      results +
      "/run.h5')\n"
      "for snapshot in run['snapshots'].values():\n"
      "    assert all(numpy.isfinite(values[...]).all() for values in snapshot.values())\n"
      "print('snapshots', len(run['snapshots']))\n";
  const Ending ending = Program(folder, {PYTHON, "-c", script}).end();
  EXPECT_EQ(ending.status, 0) << ending.output;
  const std::size_t at = ending.output.rfind("snapshots ");
  return at == std::string::npos ? 0 : std::stoi(ending.output.substr(at + 10));
}

std::string log_of(const Folder &folder) {
  std::ostringstream text;
  text << std::ifstream(folder / "results/run.log").rdbuf();
  return text.str();
}

class RunThatEnds : public testing::Test {
 protected:
  RunThatEnds() { folder_.write("section.csv", good_section); }

  std::vector<std::string> run(const std::string &scene, int ranks = 1, const std::string &results = "results") {
    folder_.write("scene.toml", scene);
    return talus_words({"run", "scene.toml", "-o", results, "--no-pictures", "--force"}, ranks);
  }
  /// Status 1 and one message with these words; snapshots written before can be read.
  void expect(const Ending &ending, const std::vector<std::string> &words, int least_snapshots) {
    EXPECT_EQ(ending.status, 1);
    for (const std::string &word : words) EXPECT_TRUE(ending.says(word)) << word;
    EXPECT_EQ(ending.count("talus: "), 1) << "one message";
    EXPECT_FALSE(ending.says("PETSC ERROR"));
    if (least_snapshots) {
      EXPECT_GE(snapshots_read_by_h5py(folder_, "results"), least_snapshots);
    }
    if (HasFailure()) ADD_FAILURE() << ending.output;
  }

  /// The last event says how the run ended, and no other does; each is a line.
  void expect_events() {
    const Ending ending = Program(folder_, {PYTHON, "-c", R"(
import json
events = [json.loads(line) for line in open('results/events.jsonl')]
assert events[0]['kind'] == 'body' and events[0]['values']['particles'] > 50, events[0]
kinds = [event['kind'] for event in events]
assert kinds[-1] == 'broke_off' and kinds.count('broke_off') == 1 and kinds.count('steps') == 1 and 'end' not in kinds, kinds
last = events[-1]
assert last['stage'] == 'fall' and last['time_s'] > 0 and 'left the mesh near (2, 0.' in last['text'], last
print('as it was')
)"})
                              .end();
    EXPECT_TRUE(ending.says("as it was")) << ending.output;
  }

  const Folder folder_;
  const std::string thrown_ = changed(good_scene, "density = 2000", "density = 2000\nvelocity = [\"40\", \"5\"]");
  const std::string endless_ = changed(changed(good_scene, "duration = 0.05", "duration = 1000"), "interval = 0.01",
                                       "interval = 0.05\nhistory_interval = 0.05");
};

/// The report is made from what there is, on two ranks too, and the status stays 1.
TEST_F(RunThatEnds, WithAReportThatSaysHow) {
  folder_.write("scene.toml", thrown_);
  for (const int ranks : {1, 2}) {
    const Ending ending = talus(
        folder_, {"run", "scene.toml", "-o", "results", "--force", "--set", "output.picture=['velocity']"}, ranks);
    EXPECT_EQ(ending.status, 1);
    EXPECT_TRUE(ending.says("report.html there shows how far it came")) << ending.output;
    std::ostringstream report;
    report << std::ifstream(folder_ / "results/report.html").rdbuf();
    EXPECT_NE(report.str().find("The run broke off:</strong> a particle left the mesh near (2, 0."), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "results/pictures/velocity.png"));
  }
}

TEST_F(RunThatEnds, BecauseAParticleLeftTheMesh) {
  expect(Program(folder_, run(thrown_)).end(),
         {"left the mesh near (2, 0.", "mesh.leaving_particles = \"remove\"", "t = 0.0", "stage fall",
          "snapshots up to step", "are in results"},
         3);
  expect_events();
}

TEST_F(RunThatEnds, BecauseAParticleLeftTheMeshOnTwoRanks) {
  expect(Program(folder_, run(thrown_, 2)).end(), {"left the mesh near (2, 0.", "t = 0.0", "stage fall"}, 3);
  expect_events();
}

/// Soil that has come apart on its way out has volume that is not soil, and the log says so at this end too.
TEST_F(RunThatEnds, BecauseSoilThatHasComeApartLeftTheMesh) {
  const std::string apart =
      changed(good_scene, "density = 2000", "density = 2000\nvolume_cap = 0\nvelocity = [\"60*x\", \"20*y\"]");
  for (const int ranks : {1, 2})
    expect(Program(folder_, run(apart, ranks)).end(),
           {"left the mesh near (", "body.sand has come apart, and the gaps between its pieces count as soil"}, 1);
}

TEST_F(RunThatEnds, BecauseALoadIsNoNumber) {
  const std::string scene =
      changed(good_scene, "density = 2000", "density = 2000\nbody_acceleration = [\"sqrt(0.025 - t)\", \"0\"]");
  expect(Program(folder_, run(scene)).end(),
         {"body.sand.body_acceleration", "is no number at t = 0.02", "snapshots up to step"}, 3);
}

TEST_F(RunThatEnds, BecauseAFixedStepBecameTooLong) {
  folder_.write("section.csv", good_section + std::string("refine_0.03,1.2,0\nrefine_0.03,2,1\n"));
  const std::string scene = changed(changed(good_scene, "density = 2000", "density = 2000\nvelocity = [\"10\", \"2\"]"),
                                    "[output]", "[integrator]\nstep = 0.0012\n[output]");
  expect(Program(folder_, run(scene)).end(),
         {"the soil has come to cells with a critical step of", "integrator.step = 0.0012", "t = "}, 1);
}

TEST_F(RunThatEnds, BecauseSpeedIsAbsurd) {
  const std::string scene = changed(good_scene, "density = 2000", "density = 2000\nvelocity = [\"1e200\", \"0\"]");
  expect(Program(folder_, run(scene)).end(), {"the velocity is not finite near (", "step 1,"}, 1);
}

TEST_F(RunThatEnds, BecauseNoStepKeepsTheTolerance) {
  const std::string scene = changed(
      good_scene, "[output]", "[integrator]\nkind = \"arkode\"\nvelocity_tolerance = 1e-12\nfloor = 0.05\n[output]");
  for (const int ranks : {1, 2})
    expect(Program(folder_, run(scene, ranks)).end(),
           {"integrator.velocity_tolerance", "integrator.floor", "largest near (", ", at particle ", " of body.sand",
            "t = "},
           1);
}

TEST_F(RunThatEnds, BecauseSoilHasNoSupport) {
  const std::string scene = changed(changed(good_scene, "kind = \"fixed\"", "kind = \"roller\""), "name = \"fall\"",
                                    "kind = \"quasi_static\"");
  folder_.write("scene.toml", changed(scene, "[boundary.left]\nkind = \"roller\"\n", ""));
  expect(Program(folder_, talus_words({"solve", "scene.toml", "-o", "results", "--no-pictures", "--force"})).end(),
         {"free to move as a whole", "can move along x", "snapshots up to step 0"}, 1);
}

TEST_F(RunThatEnds, BecauseSoilDoesNotStand) {
  const std::string solved =
      changed(changed(good_scene, "name = \"fall\"", "name = \"weight\"\nkind = \"quasi_static\"\nload_steps = 10"),
              "interval = 0.01", "interval = 0.005");
  for (const char *cohesion :
       {"0", "\"1 kPa\""}) {  // at once, or under a part of the weight: the last state that had an equilibrium is kept
    folder_.write("scene.toml", changed(solved, "cohesion = 0", "cohesion = " + std::string(cohesion)));
    expect(Program(folder_, talus_words({"solve", "scene.toml", "-o", "results", "--no-pictures", "--force"})).end(),
           {"no equilibrium beyond", "% of the loads", "stage weight", "snapshots up to step", "are in results"},
           *cohesion == '0' ? 1 : 3);
  }
  const Ending last =
      Program(folder_, {PYTHON, "-c",
                        "import h5py\nrun = h5py.File('results/run.h5')['snapshots']\nend = run[sorted(run)[-1]]\n"
                        "print('kept', 0 < end.attrs['time'] < 0.05, abs(end['stress'][...]).max() > 1e3)"})
          .end();
  EXPECT_TRUE(last.says("kept True True")) << last.output;
}

TEST_F(RunThatEnds, BecauseALayerIsOneElementThick) {
  folder_.write("section.csv",
                changed(good_section, "interface0,0,0.5\ninterface0,1,0.5\ninterface0,1,0\nregion_sand,0.5,0.25",
                        "interface0,0,0.1\ninterface0,2,0.1\nregion_sand,0.5,0.05"));
  const std::string scene = changed(changed(good_scene, "name = \"fall\"", "kind = \"quasi_static\""), "[output]",
                                    "[quasi_static]\nelements = \"linear\"\n[output]");
  folder_.write("scene.toml", scene);
  for (const bool linear : {true, false}) {
    const Ending told = talus(folder_, {"check", "scene.toml", "--set",
                                        std::string("quasi_static.elements=") + (linear ? "linear" : "quadratic")});
    EXPECT_EQ(told.says("body.sand is one element across: stage.0 will end the run"), linear) << told.output;
  }
  expect(Program(folder_, talus_words({"solve", "scene.toml", "-o", "results", "--no-pictures", "--force"})).end(),
         {"body.sand is one element across", "refine the mesh there, or set quasi_static.elements = \"quadratic\"",
          "snapshots up to step 0"},
         1);
}

/// Elements of first order lock, and their factors are too large: they are never those of a factor of safety.
TEST_F(RunThatEnds, WithTheFactorOfElementsOfSecondOrder) {
  folder_.write("scene.toml", changed(changed(good_scene, "name = \"fall\"", "kind = \"quasi_static\""),
                                      "cohesion = 0\nfriction_angle = 30", "cohesion = \"4 kPa\"\nfriction_angle = 0"));
  const auto factor = [&](const std::vector<std::string> &set) {
    std::vector<std::string> words{"solve", "scene.toml", "--factor-of-safety", "--no-pictures", "--force"};
    words.insert(words.end(), set.begin(), set.end());
    const Ending ending = talus(folder_, words);
    EXPECT_EQ(ending.status, 0) << ending.output;
    const std::size_t at = ending.output.find("factor of safety ", ending.output.rfind("\nfactor of safety"));
    return ending.output.substr(at, ending.output.find(':', at) - at);
  };
  EXPECT_EQ(factor({"--set", "quasi_static.elements=patches"}), factor({}));
}

/// Linear systems that are not solved leave the trials to damped motion, which finds the same factor.
TEST_F(RunThatEnds, WithTheSameFactorOfSafetyByDampedMotion) {
  folder_.write("scene.toml", changed(changed(good_scene, "name = \"fall\"", "kind = \"quasi_static\""),
                                      "cohesion = 0\nfriction_angle = 30", "cohesion = \"4 kPa\"\nfriction_angle = 0"));
  const std::vector<std::string> solve =
      talus_words({"solve", "scene.toml", "--factor-of-safety", "-o", "results", "--no-pictures", "--force"});
  const auto with = [&](const std::vector<std::string> &before, const std::vector<std::string> &after) {
    std::vector<std::string> words = before;
    words.insert(words.end(), solve.begin(), solve.end());
    words.insert(words.end(), after.begin(), after.end());
    return Program(folder_, words).end();
  };
  const Ending exact = with({}, {});
  EXPECT_EQ(exact.status, 0) << exact.output;
  EXPECT_EQ(exact.count("between"), 0) << exact.output;
  std::filesystem::rename(folder_ / "results/factor_of_safety.json", folder_ / "exact.json");

  const Ending moved =
      with({"env", "PETSC_OPTIONS=-talus_ksp_max_it 6"}, {"--set", "quasi_static.linear_solver=iterative"});
  EXPECT_EQ(moved.status, 0) << moved.output;
  EXPECT_TRUE(moved.says(" steps of damped motion, ")) << moved.output;
  const Ending read = Program(folder_, {PYTHON, "-c",
                                        "import json\nexact, moved = (json.load(open(f))['factor_of_safety'] for f in "
                                        "('exact.json', 'results/factor_of_safety.json'))\n"
                                        "print('decided', exact['decided'], moved['decided'])\n"
                                        "print('same', abs(moved['value'] / exact['value'] - 1) < 0.005)\n"})
                          .end();
  for (const char *words : {"decided True True", "same True"})
    EXPECT_TRUE(read.says(words)) << words << "\n" << read.output;
}

TEST_F(RunThatEnds, BecauseResultsHaveNoPlace) {
  expect(Program(folder_, run(good_scene, 1, "scene.toml/results")).end(), {"scene.toml/results", "Not a directory"},
         0);
  expect(Program(folder_, run(good_scene, 1, "/proc/results")).end(), {"/proc/results"}, 0);
  expect(Program(folder_, run(good_scene, 2, "scene.toml/results")).end(), {"scene.toml/results"}, 0);
}

/// The second rank cannot read its scene; the first would wait for it in the first exchange. A shell chooses the scene
/// by rank, since mpirun of Debian 13 (Open MPI 5.0.7) crashes where ranks have command lines of their own.
TEST_F(RunThatEnds, BecauseOneRankFailsAlone) {
  folder_.write("scene.toml", good_scene), folder_.write("other.toml", "[mesh");
  const auto started = std::chrono::steady_clock::now();
  const Ending ending = Program(folder_, {MPIEXEC, "--allow-run-as-root", "--oversubscribe", "-n", "2", "sh", "-c",
                                          "[ $OMPI_COMM_WORLD_RANK = 0 ] && exec " TALUS
                                          " check scene.toml; exec " TALUS " check other.toml"})
                            .end();
  EXPECT_EQ(ending.status, 2) << ending.output;
  EXPECT_TRUE(ending.says("talus: rank 1 alone: other.toml line 1")) << ending.output;
  EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(100));
}

#ifndef __SANITIZE_ADDRESS__  // which takes more than the limit for itself
/// 900 MB of addresses, of which the program takes a third before it reads the scene.
TEST_F(RunThatEnds, BecauseTheMemoryEnds) {
  std::vector<std::string> words = run(changed(good_scene, "size = 0.25", "size = 0.05\nhalvings = 4"));
  words.insert(words.begin(), {"sh", "-c", "ulimit -v 900000 && exec \"$0\" \"$@\""});
  expect(Program(folder_, words).end(), {"the memory of this machine, or a limit of it (ulimit -v), does not suffice"},
         0);
}
#endif

TEST_F(RunThatEnds, BecauseTheDiskIsFull) {
  Program program(folder_, run(endless_));
  ASSERT_TRUE(program.wait_for(folder_ / "results/run/000003.h5")) << program.end().output;
  program.limit_files(2000);
  expect(program.end(), {"cannot write results/", "File too large", "snapshots up to step"}, 3);
}

TEST_F(RunThatEnds, ByInterrupt) {
  for (int signal : {SIGINT, SIGTERM}) {
    Program program(folder_, run(endless_));
    ASSERT_TRUE(program.wait_for(folder_ / "results/run/000001.h5")) << program.end().output;
    program.signal(signal);
    expect(program.end(), {"interrupted (t = ", "stage fall", "snapshots up to step"}, 3);
    std::filesystem::remove_all(folder_ / "results");
  }
}

/// mpirun kills ranks a second after it is terminated, in which they do not come to an end on a busy machine: it waits
/// longer here.
TEST_F(RunThatEnds, ByTerminationOfTwoRanks) {
  std::vector<std::string> words = run(endless_, 2);
  words.insert(words.begin(),
               {"env", "OMPI_MCA_odls_base_sigkill_timeout=10", "PRTE_MCA_odls_base_sigkill_timeout=10"});
  Program program(folder_, words);
  ASSERT_TRUE(program.wait_for(folder_ / "results/run/000001.h5")) << program.end().output;
  program.signal(SIGTERM);
  EXPECT_NE(program.end().status, 0);  // mpirun's own, and what the ranks still say may not pass it: the log has it
  EXPECT_NE(log_of(folder_).find("interrupted (t = "), std::string::npos) << log_of(folder_);
  EXPECT_GE(snapshots_read_by_h5py(folder_, "results"), 3);
}

}  // namespace
}  // namespace talus
