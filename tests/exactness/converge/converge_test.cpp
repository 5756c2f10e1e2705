// `talus converge` as a user calls it: which runs, continued after an interrupt, and the verdict on scenes whose answer
// is known.
#include <gtest/gtest.h>

#include "scene.h"

namespace talus {
namespace {

/// Elastic soil that slides without friction or gravity at a speed [m/s]: where the speed is the same everywhere, all
/// meshes move alike.
std::string gliding(const std::string &speed) {
  std::string scene = changed(good_scene, "law = \"mohr_coulomb\"", "law = \"linear_elastic\"");
  scene = changed(scene, "cohesion = 0\nfriction_angle = 30\n", "velocity = [\"" + speed + "\", \"0\"]\n");
  scene = changed(changed(scene, "gravity = 9.81\n", ""), "kind = \"fixed\"", "kind = \"roller\"");
  return changed(scene, "[boundary.left]\nkind = \"roller\"\n", "");
}

std::string content(const std::string &path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class Converge : public testing::Test {
 protected:
  Converge() { folder_.write("section.csv", good_section); }
  Ending converge(const std::string &scene, std::vector<std::string> more) const {
    folder_.write("scene.toml", scene);
    return Program(folder_, words(more)).end();
  }
  std::vector<std::string> words(const std::vector<std::string> &more) const {
    std::vector<std::string> all{"converge", "scene.toml", "-o", "out", "-j", "2"};
    all.insert(all.end(), more.begin(), more.end());
    return talus_words(all);
  }
  const Folder folder_;
};

TEST_F(Converge, SaysThatCellsDoNotDecideWhereAllMeshesMoveAlike) {
  const Ending ending = converge(gliding("4"), {});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("The largest displacement is 0.2 to 0.2 m")) << ending.output;
  EXPECT_TRUE(ending.says("the cell size does not decide it within 5 %")) << ending.output;
  EXPECT_FALSE(ending.says("decides")) << ending.output;
  // the scene's size times and over the root of two
  for (const char *run : {"run_0.3536", "run_0.25", "run_0.1768"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder_ / ("out/" + std::string(run) + "/history.csv"))) << run;
  EXPECT_EQ(content(folder_ / "out/outcomes.png").substr(1, 3), "PNG");
  EXPECT_NE(content(folder_ / "out/study.csv").find("largest_displacement_m"), std::string::npos);
  EXPECT_NE(content(folder_ / "out/study.json").find("\"decides\": false"), std::string::npos);
}

// only the last centimetres before the free face move: cells of 0.35 m hardly have a particle there
TEST_F(Converge, SaysThatCellsDecideWhereTheyDoNotResolveTheMotion) {
  const Ending ending = converge(gliding("max(0, 40 * (x - 0.95))"), {"--values", "0.35,0.25,0.12", "--no-plot"});
  EXPECT_EQ(ending.status, 1) << ending.output;
  EXPECT_TRUE(ending.says("the cell size decides it")) << ending.output;
  EXPECT_NE(content(folder_ / "out/study.json").find("\"decides\": true"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/outcomes.png"));
}

TEST_F(Converge, RefinesStepsAndParticlesToo) {
  Ending ending = converge(gliding("4"), {"--by", "steps", "--no-plot"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("integrator.fraction=0.4243") && ending.says("the time step does not decide it"))
      << ending.output;
  ending = converge(gliding("4"), {"--by", "particles", "--no-plot"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("body.sand.particles_per_cell=12")) << ending.output;
}

TEST_F(Converge, ContinuesAndRunsAnotherSceneAnew) {
  folder_.write("scene.toml", gliding("4"));
  {
    Program program(folder_, words({"--no-plot"}));
    ASSERT_TRUE(program.wait_for(folder_ / "out/run_0.3536/trial"));
    program.signal(SIGINT);
    EXPECT_EQ(program.end().status, 1);
  }
  const auto written = std::filesystem::last_write_time(folder_ / "out/run_0.3536/history.csv");
  EXPECT_EQ(converge(gliding("4"), {"--no-plot"}).status, 0);
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "out/run_0.3536/history.csv"), written);
  const Ending refused = converge(gliding("2"), {"--no-plot"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(refused.says("or give --force to replace it")) << refused.output;
  const Ending other = converge(gliding("2"), {"--no-plot", "--force"});
  EXPECT_FALSE(other.says("completed before")) << "the text of the scene has changed: " << other.output;
  EXPECT_TRUE(other.says("The largest displacement is 0.1 to 0.1 m")) << other.output;
}

TEST_F(Converge, RefusesWhatShowsNothing) {
  EXPECT_EQ(converge(gliding("4"), {"--values", "0.3,0.2"}).status, 2);
  EXPECT_EQ(converge(gliding("4"), {"--values", "0.3,0.2,0.3"}).status, 2);
  EXPECT_EQ(converge(gliding("4"), {"--by", "colour"}).status, 2);
  folder_.write("two.msh", good_mesh);
  const Ending ending =
      converge(changed(gliding("4"), "section = \"section.csv\"\nsize = 0.25", "file = \"two.msh\""), {});
  EXPECT_EQ(ending.status, 2);
  EXPECT_TRUE(ending.says("needs a scene with mesh.section")) << ending.output;
}

}  // namespace
}  // namespace talus
