// The program talus-mesh from outside: exit status, messages, files.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "meshes/mesh_request.h"

namespace talus {
namespace {

struct Answer {
  int status;
  std::string text;
};

class TalusMesh : public ::testing::Test {
 protected:
  const std::filesystem::path folder = std::filesystem::path(P_tmpdir) / ("talus_mesh_" + std::to_string(getpid()));
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::string in_folder(const std::string &name) const { return (folder / name).string(); }

  std::string write(const std::string &name, const std::string &content) const {
    std::ofstream(in_folder(name)) << content;
    return in_folder(name);
  }

  static std::string content(const std::string &file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  static Answer run(const std::string &arguments) {
    Answer answer{-1, ""};
    FILE *pipe = popen((TALUS_MESH " " + arguments + " 2>&1").c_str(), "r");
    if (!pipe) return answer;
    for (int c; (c = std::fgetc(pipe)) != EOF;) answer.text += static_cast<char>(c);
    answer.status = WEXITSTATUS(pclose(pipe));
    return answer;
  }

  static void expect_words(const Answer &answer, const std::vector<std::string> &words) {
    for (const auto &word : words)
      EXPECT_NE(answer.text.find(word), std::string::npos) << word << " is not in: " << answer.text;
  }
};

TEST_F(TalusMesh, MeshesEverySectionOfTheGallery) {
  const std::vector<std::pair<std::string, std::string>> sections{
      {"selborne", "2"}, {"selborne_deck", "2"}, {"column", "0.02"}, {"bar", "0.05"},
      {"box", "0.25"},   {"oedometer", "0.1"},   {"footing", "0.5"}, {"incline_block", "0.25"}};
  for (const auto &[name, size] : sections)
    for (const std::string dimension : {"2", "3"}) {
      const Answer answer = run(TALUS_SECTIONS + name + ".csv -o " + in_folder("m.msh") + " --size " + size +
                                " --dimension " + dimension);
      EXPECT_EQ(answer.status, 0) << name << ": " << answer.text;
      expect_words(answer, {"cells", "smallest altitude", "quality", "region", "group base"});
    }
}

TEST_F(TalusMesh, MakesTheSameMeshEveryTime) {
  const std::string arguments = TALUS_SECTIONS "selborne.csv --size 1 --dimension 3 -o ";
  ASSERT_EQ(run(arguments + in_folder("a.msh")).status, 0);
  ASSERT_EQ(run(arguments + in_folder("b.msh")).status, 0);
  EXPECT_EQ(content(in_folder("a.msh")), content(in_folder("b.msh")));
}

TEST(MeshRequest, ComesOutOfItsDocumentAsItWentIn) {
  MeshRequest request{3, {}};
  MeshSource &mesh = request.mesh;
  mesh.size = 0.1, mesh.layers = 0, mesh.cuts = {0.5, 1};
  mesh.refine = {{.from = {0, 1}, .to = {2, 3}, .size = 0.2}};
  TerrainSource &terrain = mesh.terrain;
  terrain.file = "a \"b\".asc", terrain.window = {1, 2, 3, 4}, terrain.depth_shape = DepthShape::constant;
  terrain.layer = {{.name = "rock", .file = "r.asc"}, {.name = "clay", .file = "c.asc"}};
  terrain.way = {{0, 0}, {1. / 3, 2}};
  terrain.ellipsoid = {true, {1, 2, 3}, {4, 5, 6}, 10 * degree.si, 90 * degree.si};
  const MeshRequest read = mesh_request_in(text_of(request));
  EXPECT_EQ(text_of(read), text_of(request));
  EXPECT_EQ(read.dimension, 3);
  EXPECT_EQ(read.mesh.refine.at(0).to, mesh.refine[0].to);
  EXPECT_EQ(read.mesh.terrain.way, terrain.way);
  EXPECT_EQ(read.mesh.terrain.layer.at(1).name, "clay");
  EXPECT_EQ(read.mesh.terrain.depth_shape, DepthShape::constant);
  EXPECT_EQ(read.mesh.terrain.ellipsoid.dip, 10 * degree.si);
  EXPECT_FALSE(mesh_request_in(text_of({})).mesh.terrain.ellipsoid.given);
}

TEST_F(TalusMesh, TakesARequestInPlaceOfOptions) {
  ASSERT_EQ(
      run(TALUS_SECTIONS "box.csv --size 0.2 --dimension 3 --thickness 0.5 --layers 2 --refine 0 0 0.3 0.3 0.05 -o " +
          in_folder("a.msh"))
          .status,
      0);
  MeshRequest request{3, {}};
  request.mesh.section = TALUS_SECTIONS "box.csv";
  request.mesh.size = 0.2, request.mesh.thickness = 0.5, request.mesh.layers = 2;
  request.mesh.refine = {{.from = {0, 0}, .to = {0.3, 0.3}, .size = 0.05}};
  ASSERT_EQ(run("--request " + write("request.json", text_of(request)) + " -o " + in_folder("b.msh")).status, 0);
  EXPECT_EQ(content(in_folder("a.msh")), content(in_folder("b.msh")));
}

TEST_F(TalusMesh, HasNodesAtTheEndsOfANamedBoundary) {
  const Answer answer = run(TALUS_SECTIONS "footing.csv --size 0.7 -o " + in_folder("m.msh"));
  expect_words(answer, {"group footing: 2 facets, 1 m", "m\n", "group surface"});
}

TEST_F(TalusMesh, RefusesInterfacesThatCrossUnlessEveryPieceHasAName) {
  const std::string crossed =
      "outline,0,0\noutline,4,0\noutline,4,2\noutline,0,2\ninterface0,0,0.5\ninterface0,4,1.5\n"
      "interface1,0,1.5\ninterface1,4,0.5\nregion_a,2,1.8\nregion_b,2,0.2\nregion_c,0.5,1\n";
  const std::string options = " --size 0.5 -o " + in_folder("m.msh");
  const Answer refused = run(write("s.csv", crossed) + options);
  EXPECT_EQ(refused.status, 2);
  expect_words(refused,
               {"s.csv line 7: 'interface1' crosses 'interface0' of line 5 near (2, 1)", "by a point region_NAME"});
  EXPECT_EQ(run(write("s.csv", crossed + "region_d,3.5,1\n") + options).status, 0);
}

TEST_F(TalusMesh, CountsTheCellsOfBoxesBeforeItMakesThem) {
  const std::string square = "outline,0,0\noutline,4,0\noutline,4,2\noutline,0,2\n";
  const std::string options = " --size 0.5 -o " + in_folder("m.msh");
  const Answer of_section = run(write("s.csv", square + "refine_0.00001,1,1\nrefine_0.00001,2,2\n") + options);
  EXPECT_EQ(of_section.status, 2);
  expect_words(of_section, {"about 2.3", "more than 2e+07", "larger cells in the boxes"});
  const Answer of_options = run(write("s.csv", square) + options + " --refine 1 1 2 2 1e-5");
  EXPECT_EQ(of_options.status, 2);
  EXPECT_EQ(run(write("s.csv", square) + options + " --refine 5 5 6 6 1e-5").status, 0);  // outside the section
}

TEST_F(TalusMesh, TakesABoundaryThatEndsInsideTheSection) {
  const std::string square = "outline,0,0\noutline,4,0\noutline,4,2\noutline,0,2\n";
  const std::string source = write("s.csv", square + "b_slip,1,1\nb_slip,3,1\n");
  expect_words(run(source + " --size 0.5 -o " + in_folder("m.msh")), {"group slip: 4 facets, 2 m", "8 m2"});
}

TEST_F(TalusMesh, RefinesBoxesOfTheSectionAndOfTheCommandLine) {
  const std::string coarse = "box.csv --size 0.25 -o ";
  const auto cells = [&](const std::string &options) {
    const std::string text = run(TALUS_SECTIONS + coarse + in_folder("m.msh") + options).text;
    return std::stoi(text.substr(text.find("\ncells ") + 7));
  };
  EXPECT_GT(cells(" --refine 0 0 0.3 0.3 0.05"), 2 * cells(""));
  EXPECT_GT(cells(" --refine 0 0 0.3 0.3 0.05 --refine 0.7 0.7 1 1 0.05"), cells(" --refine 0 0 0.3 0.3 0.05"));
}

// The section of 8 m2 over 1, 2 and 3 m; layered and free, cuts are planes of facets that no group has.
TEST_F(TalusMesh, CutsTheThicknessIntoRegions) {
  const std::string source = write("s.csv", "outline,0,0\noutline,4,0\noutline,4,2\noutline,0,2\nregion_clay,1,1\n");
  for (const std::string layers : {"1", "0"}) {
    const Answer answer = run(source + " --size 0.8 --dimension 3 --thickness 6 --cuts 1 3 --layers " + layers +
                              " -o " + in_folder("m.msh"));
    EXPECT_EQ(answer.status, 0) << answer.text;
    for (const auto &[region, volume] : {std::pair("clay_1: ", "8 m3"), {"clay_2: ", "16 m3"}, {"clay_3: ", "24 m3"}}) {
      const std::size_t at = answer.text.find(region);
      ASSERT_NE(at, std::string::npos) << answer.text;
      EXPECT_NE(answer.text.substr(at, answer.text.find('\n', at) - at).find(volume), std::string::npos) << answer.text;
    }
    expect_words(answer, {"front", "8 m2", "back", "base", "24 m2"});
  }
}

TEST_F(TalusMesh, ComplainsAboutBadInputWithStatus2) {
  const std::string out = " -o " + in_folder("m.msh");
  const std::string bow = write("bow.csv", "outline,0,0\noutline,4,2\noutline,4,0\noutline,0,2\n");
  Answer answer = run(bow + out + " --size 1");
  EXPECT_EQ(answer.status, 2);
  expect_words(answer, {"bow.csv line 3", "crosses itself", "(0, 0)-(4, 2)"});
  EXPECT_EQ(run(in_folder("nowhere.csv") + out + " --size 1").status, 2);
  const std::string box = TALUS_SECTIONS "box.csv";
  for (const std::string wrong :
       {" --size 0", " --size -1", " --size 2", " --size 1e-9", " --size big", "", " --size 1 --dimension 4",
        " --size 1 --refine 0 0 1 1 0", " --size 1 --thickness -1", " --size 1 --layers -1", " --size 1 --cuts 0.5",
        " --size 1 --dimension 3 --thickness 1 --cuts 0.6 0.4", " --size 1 --dimension 3 --thickness 1 --cuts 1"})
    EXPECT_EQ(run(box + out + wrong).status, 2) << wrong;
  EXPECT_EQ(run(box + " --size 1 -o " + in_folder("m.vtk")).status, 2);
  EXPECT_FALSE(std::filesystem::exists(in_folder("m.msh")));
}

TEST_F(TalusMesh, ComplainsAboutPointsOfRegionsThatContradictEachOther) {
  const std::string square = "outline,0,0\noutline,4,0\noutline,4,2\noutline,0,2\n";
  const Answer answer =
      run(write("s.csv", square + "region_clay,1,1\nregion_sand,3,1\n") + " --size 1 -o " + in_folder("m.msh"));
  EXPECT_EQ(answer.status, 2);
  expect_words(answer, {"line 6", "region_sand", "region_clay", "interface"});
  EXPECT_FALSE(std::filesystem::exists(in_folder("m.msh")));
}

TEST_F(TalusMesh, CannotWriteWithStatus1) {
  const Answer answer = run(TALUS_SECTIONS "box.csv --size 0.5 -o " + in_folder("no/such/folder/m.msh"));
  EXPECT_EQ(answer.status, 1);
  expect_words(answer, {"cannot be written"});
}

}  // namespace
}  // namespace talus
