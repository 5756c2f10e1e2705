// Wrong words on the command line: status 2, and what would be right.
#include <gtest/gtest.h>

#include "scene.h"

namespace talus {
namespace {

/// What is wrong on the command line.
struct WrongWords {
  const char *name;
  std::vector<std::string> arguments, words;
};

void PrintTo(const WrongWords &wrong, std::ostream *out) { *out << wrong.name; }

const WrongWords wrong_words[] = {
    {"no_command", {}, {"A subcommand is required"}},
    {"unknown_option", {"run", "scene.toml", "--fast"}, {"run has no option --fast\n", "talus run --help"}},
    {"misspelt_option",
     {"check", "scene.toml", "--pictre"},
     {"check has no option --pictre; did you mean `--picture`?"}},
    {"two_misspelt_options",
     {"run", "scene.toml", "--resum", "--forze"},
     {"has no option --resum; did you mean `--resume`?, and no --forze; did you mean `--force`?"}},
    {"a_word_too_many", {"check", "scene.toml", "other.toml"}, {"check takes nothing more, and there is other.toml"}},
    {"unknown_quantity_to_refine",
     {"converge", "scene.toml", "--by", "cell"},
     {"--by: cell not in {cells,particles,steps}"}},
    {"scene_not_there", {"run", "noscene.toml"}, {"noscene.toml is neither a file nor a gallery scene", "column"}},
    {"scene_is_a_folder", {"check", "."}, {". is neither a file nor a gallery scene"}},
    {"scene_is_a_section", {"check", "section.csv"}, {"section.csv is a section, not a scene"}},
    {"picture_in_no_folder",
     {"check", "scene.toml", "--picture", "nofolder/m.png"},
     {"--picture nofolder/m.png cannot be written: there is no folder", "nofolder"}},
    {"unknown_override",
     {"run", "scene.toml", "--set", "body.sand.densty=1"},
     {"--set: body.sand.densty is no known key; did you mean `density`?"}},
    {"override_without_value", {"run", "scene.toml", "--set", "gravity"}, {"--set gravity", "key.path=value"}},
    {"override_out_of_range",
     {"check", "scene.toml", "--set", "stage.fall.duration=-1"},
     {"--set: stage.0.duration = -1"}},
    {"check_of_a_bad_scene",
     {"check", "scene.toml", "--set", "body.sand.region=clay"},
     {"--set: body.sand.region = \"clay\"", "known are air, sand"}},
    {"override_of_two_lines",
     {"run", "scene.toml", "--set", "gravity=9.81\ntitle = \"x\""},
     {"--set", "no value of TOML", "single line"}},
    {"resume_and_force", {"run", "scene.toml", "--resume", "--force"}, {"--force", "excludes", "--resume"}},
    {"umat_of_a_stranger",
     {"run", "scene.toml", "--no-umat", "--set", "body.sand.law=umat"},
     {"body.sand.law", "must not be a UMAT with --no-umat"}},
    {"umat_of_a_stranger_to_check",
     {"check", "scene.toml", "--no-umat", "--set", "body.sand.law=umat"},
     {"body.sand.law", "must not be a UMAT with --no-umat"}},
    {"unknown_key_to_describe", {"describe", "densty"}, {"did you mean `density`?"}},
    {"section_to_mesh_not_there",
     {"mesh", "nosection.csv", "-o", "out.msh", "--size", "1"},
     {"nosection.csv: cannot be read"}},
    {"wrong_unit_for_a_mesh",
     {"mesh", "section.csv", "-o", "out.msh", "--size", "1", "--young-modulus", "2 m"},
     {"--young-modulus 2 m"}},
    {"wrong_unit_for_a_cell_size", {"mesh", "section.csv", "-o", "out.msh", "--size", "1 s"}, {"--size 1 s"}},
    {"nothing_to_resume", {"run", "scene.toml", "-o", "results", "--resume"}, {"results contains no checkpoint"}},
    {"soil_that_is_not_there", {"soil", "scene.toml", "--body", "clay"}, {"--body clay", "known are sand"}},
    {"unknown_key_of_a_test",
     {"soil", "scene.toml", "--set", "test.a.stran=0.1"},
     {"--set: test.a.stran is no known key; did you mean `strain`?"}},
    {"test_of_a_saturated_oedometer",
     {"soil", "scene.toml", "--set", "test.a.type=oedometer", "--set", "test.a.undrained=true"},
     {"test.a", "keeps its volume", "pore_stiffness"}},
    {"suction_for_dry_strength",
     {"soil", "scene.toml", "--set", "test.a.suction=1e5"},
     {"test.a", "mohr_coulomb takes no strength from suction"}},
    {"solve_without_a_stage_for_it", {"solve", "scene.toml"}, {"no quasi-static stage", "quasi_static"}},
    {"damping_without_motion",
     {"solve", "scene.toml", "--set", "stage.0.kind=quasi_static", "stage.0.damping=0.5"},
     {"stage.0.damping", "belongs to kind = \"dynamic\""}},
    {"body_to_remove_not_there",
     {"solve", "scene.toml", "--set", "stage.0.kind=quasi_static", "stage.0.remove=clay"},
     {"stage.0.remove", "there is no [body.clay]", "known are sand"}},
    {"body_removed_in_motion",
     {"run", "scene.toml", "--set", "stage.0.remove=sand"},
     {"stage.0.remove", "kind = \"quasi_static\""}},
    {"friction_under_elements_of_second_order",
     {"solve", "scene.toml", "--set", "dimension=3", "mesh.thickness=1", "stage.0.kind=quasi_static",
      "boundary.base.kind=friction"},
     {"quasi_static.elements", "patches", "corners of facets"}},
    {"friction_beside_total_stress",
     {"run", "scene.toml", "--set", "phases=drained", "water.table=[[0, 1], [1, 1]]", "water.open_water_load=false",
      "boundary.base.kind=friction"},
     {"boundary.base.kind", "effective stress", "open_water_load"}},
    {"seepage_without_water_that_moves",
     {"solve", "scene.toml", "--set", "stage.0.kind=seepage"},
     {"stage.0.kind", "needs pore water that moves", "phases = \"saturated\" or \"unsaturated\" (or \"drained\"",
      "not \"dry\""}},
    {"steady_motion",
     {"run", "scene.toml", "--set", "stage.0.steady=true"},
     {"stage.0.steady", "belongs to kind = \"seepage\""}},
    {"a_film_shows_all_times", {"plot", "nowhere", "--movie", "--times", "3"}, {"--times excludes --movie"}},
    {"width_of_cells_below_zero", {"maps", "nowhere", "--spacing", "-3"}, {"--spacing: -3 must be a number above 0"}},
    {"values_that_are_no_numbers",
     {"converge", "scene.toml", "--by", "cells", "--values", "a"},
     {"--values: a must be a number above 0"}},
    {"no_results_to_plot", {"plot", "nowhere"}, {"nowhere contains no results"}},
};

TEST(RightArguments, HaveUnits) {
  const Folder folder;
  folder.write("section.csv", good_section);
  const Ending plain = talus(folder, {"mesh", "section.csv", "-o", "out.msh", "--size", "0.25"});
  const Ending in_unit = talus(folder, {"mesh", "section.csv", "-o", "out.msh", "--size", "25 cm"});
  EXPECT_EQ(in_unit.status, 0);
  EXPECT_EQ(in_unit.output, plain.output);
}

class WrongArguments : public testing::TestWithParam<WrongWords> {};

TEST_P(WrongArguments, AreRefused) {
  const Folder folder;
  folder.write("scene.toml", good_scene), folder.write("section.csv", good_section);
  const Ending ending = talus(folder, GetParam().arguments);
  EXPECT_EQ(ending.status, 2);
  for (const std::string &words : GetParam().words) EXPECT_TRUE(ending.says(words)) << words;
  EXPECT_FALSE(std::filesystem::exists(folder / "results"));
  if (HasFailure()) ADD_FAILURE() << ending.output;
}

INSTANTIATE_TEST_SUITE_P(All, WrongArguments, testing::ValuesIn(wrong_words),
                         [](const auto &wrong) { return wrong.param.name; });

}  // namespace
}  // namespace talus
