// The program in the face of a UMAT that is not there, is no UMAT, or goes wrong: status 2 before the run, status 1
// with the place in it.
#include <gtest/gtest.h>

#include "bad_input/program.h"
#include "bad_input/scene.h"

namespace talus {
namespace {

const std::string umats = UMATS;

Ending run_with(const std::string &law, int ranks = 1, const std::string &command = "run") {
  const Folder folder;
  const std::string built_in =
      "law = \"mohr_coulomb\"\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.3\ncohesion = 0\nfriction_angle = 30\n";
  folder.write("section.csv", good_section);
  folder.write("scene.toml", changed(good_scene, built_in,
                                     "law = \"umat\"\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.3\n" + law + "\n"));
  std::vector<std::string> words{command, "scene.toml", "-o", "results"};
  words.push_back("--no-pictures");
  return talus(folder, words, ranks);
}

std::string library(const std::string &name) { return "library = \"" + umats + "/umat_" + name + ".so\"\n"; }

void expect(const Ending &ending, int status, const std::vector<std::string> &words) {
  EXPECT_EQ(ending.status, status) << ending.output;
  for (const std::string &word : words) EXPECT_TRUE(ending.says(word)) << word << "\n" << ending.output;
  EXPECT_FALSE(ending.says("PETSC ERROR"));
}

TEST(UmatEndings, a_library_that_is_not_there_is_refused) {
  expect(run_with("library = \"no.so\""), 2, {"scene.toml line", "body.sand", "no.so", "cannot be loaded"});
  expect(run_with(""), 2, {"body.sand", "needs library"});
}

TEST(UmatEndings, a_library_without_the_subroutine_is_refused) {
  expect(run_with(library("linear_elastic") + "props = [1e6, 0.3]\nsubroutine = \"my_umat_\""), 2,
         {"body.sand", "no symbol my_umat_", "nm -D"});
}

TEST(UmatEndings, too_few_state_variables_are_refused) {
  expect(run_with(library("broken") + "props = [0, 2]\nnstatv = 3", 2), 2,
         {"body.sand", "writes beyond its 3 state variables", "nstatv"});
  expect(run_with(library("broken") + "props = [0, 2]\nnstatv = 1\nstate = [\"a\", \"b\"]"), 2,
         {"body.sand", "2 names for nstatv = 1"});
#ifdef UMAT_FORTRAN
  expect(run_with(library("mohr_coulomb") + "props = [1e6, 0.3, 1e3, 0.5, 0, 1e3, 0.5, 0, 0]\nnstatv = 1"), 2,
         {"body.sand", "writes beyond its 1 state variables"});
#endif
}

TEST(UmatEndings, an_answer_that_is_no_number_is_refused_before_the_run) {
  expect(run_with(library("linear_elastic") + "props = [1e6, 0.5]"), 2, {"body.sand", "STRESS(1)", "nan"});
  expect(run_with(library("linear_elastic") + "props = [1e6, 0.5]", 1, "soil"), 2, {"cannot be used", "STRESS(1)"});
}

TEST(UmatEndings, an_answer_that_is_no_number_ends_the_run_and_says_where) {
  expect(run_with(library("broken") + "props = [0.02, 0]"), 1, {"STRESS(2) = nan", "near (", "DSTRAN", "t = 0.02"});
  expect(run_with(library("broken") + "props = [0.02, 1]\nstate = \"memory\"", 2), 1, {"STATEV(1) = nan", "near ("});
  expect(run_with(library("broken") + "props = [0.02, 3]"), 1, {"PNEWDT = 0.25", "integrator.fraction"});
}

}  // namespace
}  // namespace talus
