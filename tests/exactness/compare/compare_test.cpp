// A matrix of runs by `talus compare`: which runs, side by side, gone on with after an interrupt, against which
// reference, into which files.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "csv_table.h"
#include "scene.h"

namespace talus {
namespace {

double number(const Row &row, const std::string &key) { return std::stod(row.at(key)); }

class Compare : public testing::Test {
 protected:
  Compare() {
    folder_.write("section.csv", good_section);
    folder_.write("scene.toml", changed(good_scene, "density = 2000", "porosity = 0.4\ngrain_density = 3333") +
                                    "[output.point.corner]\nposition = [1, 0.5]\n");
  }
  std::vector<std::string> words(const std::vector<std::string> &more) const {
    std::vector<std::string> all{"compare",    "scene.toml", "-o", "out",      "--measure",
                                 "corner_x_m", "-j",         "2",  "--no-plot"};
    all.insert(all.end(), more.begin(), more.end());
    return talus_words(all);
  }
  nlohmann::json reference() const {
    std::ifstream file(folder_ / "out/study.json");
    return nlohmann::json::parse(file).at("reference");
  }
  Ending compare(const std::vector<std::string> &more) const { return Program(folder_, words(more)).end(); }
  const Folder folder_;
};

// integrator and its step or tolerance, mesh size, particles per cell, transfer, dimension and phase model
TEST_F(Compare, VariesWhatASceneSays) {
  const Ending ending = compare({"--series", "euler: integrator.fraction=0.8,0.4,0.2", "--series",
                                 "arkode: integrator.kind=arkode; integrator.velocity_tolerance=1e-2,1e-4", "--series",
                                 "petsc: integrator.kind=petsc", "--series",
                                 "mesh: body.sand.particles_per_cell=3,6; mesh.size=0.25,0.17", "--series",
                                 "transfer: transfer.velocity=flip,pic", "--series",
                                 "water: water.table=[[0, 0], [2, 0]]; phases=drained", "--series",
                                 "slice: dimension=3; output.point.corner.position=[1, 0.5, 0.1]; "
                                 "boundary.front.kind=roller; boundary.back.kind=roller"});
  ASSERT_EQ(ending.status, 0) << ending.output;
  const auto rows = csv_table(folder_ / "out/study.csv");
  ASSERT_EQ(rows.size(), 14u);
  for (const Row &row : rows) {
    EXPECT_NEAR(number(row, "corner_x_m"), 1, 0.1)
        << row.at("overrides");  // the particle nearest to the corner, cells of 0.25 m
    for (const char *key : {"processor_s", "wall_s", "steps"}) EXPECT_GT(number(row, key), 0) << key;
    EXPECT_EQ(row.at("failure"), "");
  }
  EXPECT_EQ(rows[0].at("value"), "0.8");
  EXPECT_EQ(rows[9].at("overrides"), "body.sand.particles_per_cell=6 mesh.size=0.17");
  EXPECT_GT(number(rows[3], "evaluations"), 3.9 * number(rows[3], "steps")) << "order 3 has four stages";
  // nothing on the front is beaten in time and error at once, and something is on it
  int front = 0;
  for (const Row &row : rows)
    if (row.at("pareto") == "1") {
      ++front;
      for (const Row &other : rows)
        EXPECT_FALSE(number(other, "processor_s") < number(row, "processor_s") &&
                     number(other, "error") < number(row, "error"));
    }
  EXPECT_GT(front, 0);
  // progress, with what is left
  EXPECT_TRUE(ending.says("14 of 14: ") && ending.says(" s left")) << ending.output;
  // without a reference the series that converges best is taken to its limit, or its finest run, with what is uncertain
  // about it
  EXPECT_GT(reference().at("uncertainty").get<double>(), 0);
}

TEST_F(Compare, GoesOnWhereItStopped) {
  const std::vector<std::string> matrix{"--set", "stage.fall.duration=0.3", "--series",
                                        "euler: integrator.fraction=0.8,0.4,0.1,0.05"};
  {
    Program program(folder_, words(matrix));
    ASSERT_TRUE(program.wait_for(folder_ / "out/run00001/trial"));
    program.signal(SIGINT);
    const Ending ending = program.end();
    EXPECT_EQ(ending.status, 1) << ending.output;
    EXPECT_TRUE(ending.says("the same command continues with the missing runs")) << ending.output;
  }
  const auto written = std::filesystem::last_write_time(folder_ / "out/run00001/history.csv");
  const Ending ending = compare(matrix);
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says(" of 4 runs were completed before")) << ending.output;
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "out/run00001/history.csv"), written);
  EXPECT_EQ(csv_table(folder_ / "out/study.csv").size(), 4u);
  std::vector<std::string> others = matrix;
  others[1] = "stage.fall.duration=0.01";
  EXPECT_FALSE(compare(others).says("there already")) << "runs of another scene do not count";
}

TEST_F(Compare, TellsOfRunsThatFail) {
  const Ending ending =
      compare({"--exact", "1", "--series", "fast: body.sand.velocity=[\"0\", \"0\"],[\"400\", \"0\"]"});
  EXPECT_EQ(ending.status, 1) << ending.output;
  const auto rows = csv_table(folder_ / "out/study.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("failure"), "");
  EXPECT_NE(rows[1].at("failure").find("left the mesh"), std::string::npos) << rows[1].at("failure");
  EXPECT_EQ(rows[1].at("pareto"), "0");
  EXPECT_NEAR(number(rows[0], "error"), std::abs(number(rows[0], "corner_x_m") - 1), 1e-9);
}

TEST_F(Compare, TakesFiniteElementsForTheTruth) {
  folder_.write("scene.toml", changed(changed(good_scene, "law = \"mohr_coulomb\"", "law = \"linear_elastic\""),
                                      "cohesion = 0\nfriction_angle = 30\n", "") +
                                  "[output.point.corner]\nposition = [1, 0.5]\n");
  const Ending ending = compare({"--series", "euler: integrator.fraction=0.8,0.4", "--reference",
                                 "finite elements: stage.fall.kind=quasi_static"});
  ASSERT_EQ(ending.status, 0) << ending.output;
  EXPECT_EQ(reference().at("origin"), "finite elements");
  const auto rows = csv_table(folder_ / "out/study.csv");
  ASSERT_EQ(rows.size(), 2u);
  for (const Row &row : rows)
    EXPECT_NEAR(number(row, "error"), std::abs(number(row, "corner_x_m") - reference().at("value").get<double>()),
                1e-9);
}

TEST_F(Compare, RefusesWhatItCannotRun) {
  for (const auto &[more, said] :
       {std::pair{std::vector<std::string>{"--series", "euler: integrator.fractoin=1"}, "integrator.fractoin"},
        {{"--series", "euler:", "--series", "law: body.sand.frictoin_angle=30"}, "body.sand.frictoin_angle"},
        {{"--series", "euler:", "--series", "base: boundary.base.frictoin_angle=30"}, "boundary.base.frictoin_angle"},
        {{"--series", "order: integrator.kind=arkode; integrator.order=3,9"}, "2 to 5"},
        {{"--series", "stiff: body.sand.young_modulus=1 MPa", "--series", "x: body.sand.young_modulus=9e5"},
         "body.sand.young_modulus has numbers without a unit and in MPa: give all of them one unit, or none"},
        {{"--series", "twice: stage.0.duration=0.1; stage.fall.duration=0.2"},
         "gives values to stage.0.duration and to stage.fall.duration, of which one would replace the other"},
        {{"--series", "euler:", "--exact", "one"}, "--exact = one"},
        {{"--series", "euler:", "--exact", "1", "--reference", "fem: stage.fall.kind=quasi_static"},
         "--exact excludes --reference"},
        {{"--series", "euler:", "--reference", "two: mesh.size=0.2,0.1"}, "must be one run"}}) {
    const Ending ending = compare(more);
    EXPECT_EQ(ending.status, 2) << said;
    EXPECT_TRUE(ending.says(said)) << ending.output;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out")) << "before anything runs";
  }
}

/// The columns follow from the points and boundaries of the scene: nothing is run in vain.
TEST_F(Compare, RefusesAMisspeltColumnBeforeAnythingRuns) {
  const Ending ending = Program(folder_, talus_words({"compare", "scene.toml", "-o", "out", "--measure",
                                                      "max:cornr_x_m", "--no-plot", "--set", "stage.fall.duration=10",
                                                      "--series", "euler: integrator.fraction=0.4,0.2"}))
                            .end();
  EXPECT_EQ(ending.status, 2) << ending.output;
  EXPECT_TRUE(ending.says("history.csv has no column cornr_x_m; did you mean `corner_x_m`?")) << ending.output;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

/// Without a measure the outcomes of all runs stand against the last key: a faster body goes further.
TEST_F(Compare, ChartsOutcomesAgainstAKey) {
  const auto sweep = [&](const std::vector<std::string> &more) {
    std::vector<std::string> all{
        "compare", "scene.toml", "-o",       "sweep",
        "-j",      "2",          "--series", "down: body.sand.velocity=[\"0\", \"0\"],[\"0\", \"-0.5 m/s\"]"};
    all.insert(all.end(), more.begin(), more.end());
    return Program(folder_, talus_words(all)).end();
  };
  const Ending ending = sweep({});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("study.csv, study.json and pictures are in sweep")) << ending.output;
  const auto rows = csv_table(folder_ / "sweep/study.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("key"), "body.sand.velocity");
  EXPECT_EQ(rows[1].at("value"), "[0, -0.5 m/s]");
  EXPECT_EQ(rows[0].at("fails"), "False");
  EXPECT_GT(number(rows[1], "largest_displacement_m"), number(rows[0], "largest_displacement_m"));
  EXPECT_GT(number(rows[1], "corner_largest_speed_m_s"), 0.4);
  const Ending typed = Program(folder_, talus_words({"compare", "scene.toml", "-o", "typed", "--no-plot", "--series",
                                                     "stiff: body.sand.young_modulus=1 MPa,2 MPa", "--series",
                                                     "soft: body.sand.young_modulus=0.7 MPa"}))
                           .end();
  EXPECT_EQ(typed.status, 0) << typed.output;
  const auto with_unit = csv_table(folder_ / "typed/study.csv");
  ASSERT_EQ(with_unit.size(), 3u);
  EXPECT_EQ(with_unit[1].at("value"), "2") << "a number in the unit that was typed";
  EXPECT_EQ(with_unit[2].at("value"), "0.7");
  for (const Row &row : with_unit) EXPECT_EQ(row.at("unit"), "MPa") << "series on one axis have one unit";
  EXPECT_TRUE(sweep({"--no-plot"}).says("2 of 2 runs were completed before")) << "goes on where it was stopped";
  EXPECT_TRUE(sweep({"--exact", "1"}).says("--exact requires --measure"));
  // other values are not taken for them, and replace them only when that is asked for
  const Ending other = sweep({"--no-plot", "--set", "stage.fall.duration=0.1"});
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(other.says("or give --force to replace it")) << other.output;
  const Ending replaced = sweep({"--no-plot", "--set", "stage.fall.duration=0.1", "--force"});
  EXPECT_EQ(replaced.status, 0) << replaced.output;
  EXPECT_FALSE(replaced.says("completed before")) << replaced.output;
}

}  // namespace
}  // namespace talus
