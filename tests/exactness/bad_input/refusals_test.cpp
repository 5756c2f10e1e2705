// Bad input: the program ends with status 2 before it writes results, and says where the fault is and what would be
// right.
#include <gtest/gtest.h>

#include "scene.h"

namespace talus {
namespace {

/// One fault: what is changed in which file, and what the complaint has to say.
struct Fault {
  const char *name;
  const char *file;  ///< "scene.toml", "section.csv" or "mesh.msh"
  const char *from, *to;
  std::vector<std::string> words;
  int ranks = 1;
};

void PrintTo(const Fault &fault, std::ostream *out) { *out << fault.name; }

constexpr const char *dry_part =
    "[mesh]\nsection = \"section.csv\"\nsize = 0.25\n[body.sand]\nregion = \"sand\"\ndensity = 2000";
#define WET_PART_WITH(water)                                        \
  "[mesh]\nsection = \"section.csv\"\nsize = 0.25\n[water]\n" water \
  "table = [[0, 0.5], [2, 0.5]]\n[body.sand]\nregion = \"sand\"\n"  \
  "porosity = 0.4\ngrain_density = 2600\npermeability = 1e-10"
#define WET_PART WET_PART_WITH("")

const Fault faults[] = {
    // the text
    {"malformed", "scene.toml", "[mesh]", "[mesh", {"scene.toml line 3"}},
    {"malformed_on_two_ranks", "scene.toml", "[mesh]", "[mesh", {"scene.toml line 3"}, 2},
    {"wrong_unit",
     "scene.toml",
     "\"1 MPa\"",
     "\"1 m\"",
     {"scene.toml line 10", "body.sand.young_modulus = \"1 m\"", "Pa"}},
    {"unknown_unit", "scene.toml", "\"1 MPa\"", "\"1 MPb\"", {"scene.toml line 10", "MPb"}},
    {"out_of_range",
     "scene.toml",
     "friction_angle = 30",
     "friction_angle = 130",
     {"scene.toml line 13", "body.sand.friction_angle = 130", "0 to 70 deg"}},
    {"negative_cohesion",
     "scene.toml",
     "cohesion = 0",
     "cohesion = \"-1 Pa\"",
     {"scene.toml line 12", "body.sand.cohesion", "0 to 1e9 Pa"}},
    {"water_table_of_a_soil_without_water",
     "scene.toml",
     "law = ",
     "water_table = [[0, 1]]\nlaw = ",
     {"scene.toml line 9", "body.sand.water_table", "needs phases = \"drained\" and no seepage stage"}},
    {"cohesion_that_falls_below_zero",
     "scene.toml",
     "cohesion = 0",
     "cohesion = \"1e3 - 4e3 * y\"",
     {"scene.toml line 12",
      "body.sand.cohesion = \"1e3 - 4e3 * y\" must be a number from 0 to 1e9 Pa in the whole body", "and is -",
      "at (0."}},
    {"friction_that_is_no_number_on_two_ranks",
     "scene.toml",
     "friction_angle = 30",
     "friction_angle = \"30 / (x > 0.3)\"",
     {"scene.toml line 13", "body.sand.friction_angle", "0 to 70 deg in the whole body, and is no number at ("},
     2},
    {"dilation_above_all_friction",
     "scene.toml",
     "friction_angle = 30",
     "friction_angle = \"20 + 10 * x\"\ndilation_angle = 31",
     {"scene.toml line 14", "body.sand.dilation_angle = 31 must not exceed friction_angle, 29.",
      "deg, its largest value"}},
    {"strength_in_time",
     "scene.toml",
     "cohesion = 0",
     "cohesion = \"1e3 * t\"",
     {"scene.toml line 12", "body.sand.cohesion", "an expression of x, y, z; it cannot depend on t"}},
    {"polygon_of_two_points",
     "scene.toml",
     "[output]",
     "[factor_of_safety]\nwithin = [[0, 0], [1, 1]]\n[output]",
     {"factor_of_safety.within", "must have at least 3 points [x, y]"}},
    {"line_of_one_point",
     "scene.toml",
     "[output]",
     "[factor_of_safety]\nalong = [[0, 0]]\n[output]",
     {"factor_of_safety.along", "must have at least 2 points [x, y]"}},
    {"point_in_space_of_a_plane_line",
     "scene.toml",
     "[output]",
     "[factor_of_safety]\nalong = [[0, 0], [1, 1, 1]]\n[output]",
     {"factor_of_safety.along.1", "must have 2 coordinates, [x, y]"}},
    {"point_twice_in_a_line",
     "scene.toml",
     "[output]",
     "[factor_of_safety]\nalong = [[0, 0], [0, 0]]\n[output]",
     {"factor_of_safety.along.1", "must not be the point before it again"}},
    {"width_without_a_line",
     "scene.toml",
     "[output]",
     "[factor_of_safety]\nwidth = 2\n[output]",
     {"factor_of_safety.width", "has no effect without the line factor_of_safety.along"}},
    {"no_mechanism",
     "scene.toml",
     "[output]",
     "[factor_of_safety]\nmechanisms = 0\n[output]",
     {"factor_of_safety.mechanisms", "from 1 to 10"}},
    {"residual_above_peak",
     "scene.toml",
     "friction_angle = 30",
     "friction_angle = 30\nresidual_friction_angle = 31\nshape_factor = 10",
     {"scene.toml line 14", "body.sand.residual_friction_angle = 31 must not exceed friction_angle, 30 deg"}},
    {"residual_cohesion_above_peak",
     "scene.toml",
     "cohesion = 0\nfriction_angle = 30",
     "cohesion = \"5 kPa\"\nfriction_angle = 30\nresidual_cohesion = \"6 kPa\"\nshape_factor = 10",
     {"scene.toml line 14", "body.sand.residual_cohesion = \"6 kPa\" must not exceed cohesion, 5000 Pa"}},
    {"friction_of_a_right_angle",
     "scene.toml",
     "friction_angle = 30",
     "friction_angle = \"90 deg\"",
     {"scene.toml line 13", "body.sand.friction_angle = \"90 deg\"", "0 to 70 deg"}},
    {"clay_that_swells_as_it_is_compressed",
     "scene.toml",
     "law = \"mohr_coulomb\"\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.3\ncohesion = 0\nfriction_angle = 30",
     "law = \"cam_clay\"\ncompression_slope = 0.04\nswelling_slope = 0.05\ncritical_stress_ratio = 1\npoisson_ratio = "
     "0.3\nvoid_ratio = 1\n"
     "preconsolidation_pressure = \"100 kPa\"",
     {"scene.toml line 10", "body.sand.compression_slope = 0.04 must exceed swelling_slope, 0.05"}},
    {"point_far_from_soil",
     "scene.toml",
     "interval = 0.01",
     "interval = 0.01\n[output.point.crest]\nposition = [1.9, 0.9]",
     {"scene.toml line 24", "output.point.crest.position", "in the soil or at its surface", "m away"}},
    {"point_far_from_soil_on_two_ranks",
     "scene.toml",
     "interval = 0.01",
     "interval = 0.01\n[output.point.crest]\nposition = [1.9, 0.9]",
     {"scene.toml line 24", "output.point.crest.position", "in the soil or at its surface", "m away"},
     2},
    {"suction_without_water",
     "scene.toml",
     "cohesion = 0",
     "cohesion = 0\nsuction_cohesion = \"15 kPa\"\nsuction_cohesion_rate = \"0.0007 1/kPa\"",
     {"scene.toml line 9", "body.sand.law", "takes strength from suction", "drained"}},
    {"suction_rate_without_unit",
     "scene.toml",
     "cohesion = 0",
     "cohesion = 0\nsuction_cohesion = \"15 kPa\"\nsuction_cohesion_rate = 0.0007",
     {"scene.toml line 14", "body.sand.suction_cohesion_rate = 7e-4", "0 to 1e-4 1/Pa"}},
    {"no_stable_elasticity",
     "scene.toml",
     "poisson_ratio = 0.3",
     "poisson_ratio = 0.5",
     {"scene.toml line 11", "body.sand.poisson_ratio = 0.5", "below 0.5"}},
    {"unknown_key",
     "scene.toml",
     "cohesion = 0\n",
     "cohesion = 0\ndilation_angel = 0\n",
     {"scene.toml line 13", "did you mean `dilation_angle`?"}},
    {"misspelt_parameter",
     "scene.toml",
     "friction_angle",
     "friction_angel",
     {"scene.toml line 6", "needs friction_angle", "did you mean it by `friction_angel`?"}},
    {"unknown_table", "scene.toml", "[output]", "[ouput]", {"scene.toml line 21", "did you mean `output`?"}},
    {"unknown_law",
     "scene.toml",
     "mohr_coulomb",
     "mohr_columb",
     {"scene.toml line 9", "body.sand.law", "did you mean `mohr_coulomb`?"}},
    {"unknown_boundary",
     "scene.toml",
     "\"roller\"",
     "\"roler\"",
     {"scene.toml line 17", "boundary.left.kind", "did you mean `roller`?"}},
    {"water_boundary_on_dry_soil",
     "scene.toml",
     "kind = \"roller\"",
     "kind = \"rainfall\"",
     {"scene.toml line 16", "boundary.left", "phases = \"dry\" has none", "unsaturated"}},
    {"gas_boundary_without_gas",
     "scene.toml",
     "[mesh]\nsection = \"section.csv\"\nsize = 0.25\n[body.sand]\nregion = \"sand\"\ndensity = 2000",
     "phases = \"saturated\"\n[mesh]\nsection = \"section.csv\"\nsize = 0.25\n[boundary.gas]\ngroup = \"left\"\nkind = "
     "\"gas_pressure\"\n[body.sand]\nregion = \"sand\"\n"
     "porosity = 0.3\ngrain_density = 2650\npermeability = 1e-10",
     {"scene.toml line 9", "boundary.gas.kind", "moving pore gas", "three-phase"}},
    {"saturation_beyond_one",
     "scene.toml",
     "density = 2000",
     "density = 2000\nsaturation = 1.2",
     {"scene.toml line 9", "saturation = 1.2", "from 0 to 1"}},
    {"conductivity_for_permeability",
     "scene.toml",
     "density = 2000",
     "density = 2000\npermeability = \"1e-3 m/s\"",
     {"scene.toml line 9", "permeability", "that is a hydraulic_conductivity"}},
    {"unknown_integrator",
     "scene.toml",
     "[output]",
     "[integrator]\nkind = \"eular\"\n[output]",
     {"scene.toml line 22", "did you mean `euler`?"}},
    {"unknown_end",
     "scene.toml",
     "duration = 0.05",
     "duration = 0.05\nuntil = \"stop\"",
     {"scene.toml line 21", "stage.0.until", "equilibrium"}},
    {"missing_parameter", "scene.toml", "cohesion = 0\n", "", {"body.sand", "needs cohesion"}},
    {"name_with_a_line_break",
     "scene.toml",
     "[boundary.left]",
     "[boundary.\"le\\nft\"]\ngroup = \"left\"",
     {"scene.toml line 16", "named without line breaks"}},
    {"stage_with_a_line_break",
     "scene.toml",
     "name = \"fall\"",
     "name = \"fa\\nll\"",
     {"scene.toml line 19", "stage.0.name", "without line breaks"}},
    {"interval_of_nothing",
     "scene.toml",
     "interval = 0.01",
     "interval = 1e-300",
     {"scene.toml line 22", "output.interval = 1e-300 must be 0, or ", "critical step"}},
    {"interval_of_nothing_on_two_ranks",
     "scene.toml",
     "interval = 0.01",
     "interval = 0.01\nhistory_interval = 1e-300",
     {"scene.toml line 23", "output.history_interval = 1e-300 must be 0, or "},
     2},
    {"no_region", "scene.toml", "region = \"sand\"", "region = []", {"body.sand", "needs region"}},
    // what the mesh has
    {"region_not_there",
     "scene.toml",
     "region = \"sand\"",
     "region = \"snad\"",
     {"scene.toml line 7", "body.sand.region = \"snad\"", "did you mean `sand`?"}},
    {"region_not_there_on_two_ranks",
     "scene.toml",
     "region = \"sand\"",
     "region = \"clay\"",
     {"scene.toml line 7", "known are air, sand"},
     2},
    {"group_not_there",
     "scene.toml",
     "[boundary.left]",
     "[boundary.lift]",
     {"scene.toml line 16", "boundary.lift.group", "did you mean `left`?"}},
    {"two_bodies_in_one_region",
     "scene.toml",
     "[boundary.base]",
     "[body.more]\nregion = [\"air\", \"sand\"]\ndensity = 2000\nlaw = \"linear_elastic\"\nyoung_modulus = "
     "1e6\npoisson_ratio = 0.3\n[boundary.base]",
     {"scene.toml line 15", "body.more.region", "body.sand"}},
    {"no_lattice",
     "scene.toml",
     "density = 2000",
     "density = 2000\nparticles_per_cell = 5",
     {"scene.toml line 9", "body.sand.particles_per_cell = 5", "1, 3, 4, 6"}},
    {"no_lattice_in_a_box",
     "scene.toml",
     "[boundary.base]",
     "[[body.sand.dense]]\nfrom = [0, 0]\nto = [1, 1]\nparticles_per_cell = 7\n[boundary.base]",
     {"scene.toml line 17", "body.sand.dense.0.particles_per_cell = 7"}},
    {"traction_of_three_components",
     "scene.toml",
     "kind = \"roller\"",
     "kind = \"traction\"\ntraction = [\"0\", \"0\", \"1\"]",
     {"scene.toml line 18", "boundary.left.traction", "2 components"}},
    {"start_that_is_no_number",
     "scene.toml",
     "density = 2000",
     "density = 2000\nvelocity = [\"1 / (x - x)\", \"0\"]",
     {"scene.toml line 9", "body.sand.velocity", "is no number at ("}},
    {"start_outside_the_mesh",
     "scene.toml",
     "density = 2000",
     "density = 2000\ndisplacement = [\"-0.5\", \"0\"]",
     {"scene.toml line 9", "body.sand.displacement", "out of the mesh near ("}},
    {"step_above_the_critical",
     "scene.toml",
     "[output]",
     "[integrator]\nstep = \"1 s\"\n[output]",
     {"scene.toml line 22", "integrator.step", "critical step of 0.0"}},
    {"step_above_the_critical_on_two_ranks",
     "scene.toml",
     "[output]",
     "[integrator]\nstep = \"1 s\"\n[output]",
     {"scene.toml line 22", "integrator.step"},
     2},
    {"picture_of_a_field_not_there",
     "scene.toml",
     "[output]",
     "[output]\npicture = [\"velocity\", \"plastic_strane\"]",
     {"scene.toml line 22", "output.picture", "did you mean `plastic_strain`?"}},
    {"order_nine",
     "scene.toml",
     "[output]",
     "[integrator]\nkind = \"arkode\"\norder = 9\n[output]",
     {"scene.toml line 23", "integrator.order = 9", "2 to 5"}},
    {"tolerance_of_nothing",
     "scene.toml",
     "[output]",
     "[integrator]\nkind = \"arkode\"\nvelocity_tolerance = 0\n[output]",
     {"scene.toml line 23", "integrator.velocity_tolerance = 0", "1e-12 to 1000 m/s"}},
    {"tolerance_in_the_wrong_unit",
     "scene.toml",
     "[output]",
     "[integrator]\nkind = \"arkode\"\nvelocity_tolerance = \"1 mm\"\n[output]",
     {"scene.toml line 23", "integrator.velocity_tolerance", "m/s"}},
    {"step_above_the_limit_of_its_order",
     "scene.toml",
     "[output]",
     "[integrator]\nkind = \"arkode\"\nstep = \"1 s\"\n[output]",
     {"scene.toml line 23", "integrator.step", "1.732 / omega_max"}},
    {"forward_euler_where_water_moves",
     "scene.toml",
     dry_part,
     "phases = \"saturated\"\n[integrator]\nkind = \"forward-euler\"\n" WET_PART,
     {"scene.toml line 5", "integrator.kind", "\"euler\", or \"arkode\" of order 3", "phases = \"dry\""}},
    {"order_four_where_water_moves",
     "scene.toml",
     dry_part,
     "phases = \"saturated\"\n[integrator]\nkind = \"arkode\"\norder = 4\n" WET_PART,
     {"scene.toml line 5", "integrator.kind", "order = 4, but only order 3"},
     2},
    {"frequency_of_the_mesh_where_water_moves",
     "scene.toml",
     dry_part,
     "phases = \"saturated\"\n[integrator]\nomega_max = \"mesh\"\n" WET_PART,
     {"scene.toml line 5", "integrator.omega_max", "\"cells\" where pore fluids move"},
     2},
    {"explicit_drag_with_another_integrator",
     "scene.toml",
     dry_part,
     "phases = \"saturated\"\n[integrator]\nkind = \"arkode\"\n" WET_PART_WITH("drag = \"explicit\"\n"),
     {"scene.toml line 10", "water.drag", "only with integrator.kind = \"euler\""},
     2},
    {"explicit_drag_where_no_water_moves",
     "scene.toml",
     dry_part,
     "phases = \"drained\"\n" WET_PART_WITH("drag = \"explicit\"\n"),
     {"scene.toml line 8", "water.drag", "only where pore fluids move"}},
    {"storage_by_rate_in_saturated_soil",
     "scene.toml",
     dry_part,
     "phases = \"saturated\"\n" WET_PART_WITH("storage = \"rate\"\n"),
     {"scene.toml line 8", "water.storage", "only with phases = \"unsaturated\""}},
    {"fixed_step_limit_below_one",
     "scene.toml",
     "[output]",
     "[integrator]\nlimit = 0.5\n[output]",
     {"scene.toml line 22", "integrator.limit = 0.5", "1 to"}},
    {"unknown_method_of_petsc",
     "scene.toml",
     "[output]",
     "[integrator]\nkind = \"petsc\"\nmethod = \"rk6\"\n[output]",
     {"scene.toml line 23", "integrator.method = \"rk6\"", "rk3", "rk8"}},
    // sections
    {"section_not_there",
     "scene.toml",
     "section.csv",
     "nosection.csv",
     {"scene.toml line 4", "mesh.section", "nosection.csv: cannot be read"}},
    {"outline_that_crosses_itself",
     "section.csv",
     "outline,2,1\noutline,0,1",
     "outline,0,1\noutline,2,1",
     {"scene.toml line 4", "section.csv", "outline", "cross"}},
    {"interfaces_that_cross",
     "section.csv",
     "interface0,0,0.5",
     "interface1,0.5,0\ninterface1,0.6,1\ninterface0,0,0.5",
     {"scene.toml line 4", "section.csv line 6: 'interface1' crosses 'interface0' of line 8 near (0.55, 0.5)"}},
    {"malformed_row", "section.csv", "outline,2,1", "outline,2,one", {"scene.toml line 4", "section.csv line 4"}},
    {"cells_larger_than_the_section",
     "scene.toml",
     "size = 0.25",
     "size = 25",
     {"scene.toml line 4", "25 m is larger than the section"}},
    {"no_cell_size", "scene.toml", "size = 0.25\n", "", {"mesh.size", "above 0 m"}},
    // mesh files
    {"mesh_not_there",
     "scene.toml",
     "section = \"section.csv\"\nsize = 0.25",
     "file = \"nomesh.msh\"",
     {"scene.toml line 4", "nomesh.msh: cannot be read"}},
    {"mesh_of_garbage", "mesh.msh", "$MeshFormat", "$Rubbish", {"scene.toml line 4", "mesh.msh"}},
    {"mesh_of_garbage_on_two_ranks", "mesh.msh", "2.2 0 8", "two", {"scene.toml line 4", "mesh.msh"}, 2},
    {"mesh_cut_short", "mesh.msh", "3 2 2 2 1 1 3 4\n$EndElements\n", "", {"scene.toml line 4", "mesh.msh"}},
    {"mesh_of_another_dimension",
     "scene.toml",
     "section = \"section.csv\"\nsize = 0.25",
     "file = \"mesh.msh\"\n[body.stone]\nregion = \"sand\"",
     {"needs"}},
    {"empty_body",
     "mesh.msh",
     "2\n1 1 \"base\"\n2 2 \"sand\"",
     "3\n1 1 \"base\"\n2 2 \"clay\"\n2 3 \"sand\"",
     {"scene.toml line 7", "body.sand.region", "known are clay"}},
    {"element_without_its_node",
     "mesh.msh",
     "1 3 4\n$EndElements",
     "1 3 5\n$EndElements",
     {"scene.toml line 4", "mesh.msh: element 3 names the node 5, which is not in the file"}},
    {"element_without_its_node_on_two_ranks",
     "mesh.msh",
     "1 3 4\n$EndElements",
     "1 3 5\n$EndElements",
     {"scene.toml line 4", "mesh.msh: element 3 names the node 5, which is not in the file"},
     2},
    {"mesh_that_is_not_plane", "mesh.msh", "3 1 1 0", "3 1 1 0.1", {"scene.toml line 4", "mesh.msh", "is not plane"}},
    {"group_beside_the_cells",
     "mesh.msh",
     "1 1 2 1 1 1 2",
     "1 1 2 1 1 2 4",
     {"scene.toml line 4", "mesh.msh: element 1 of the group 'base' is not the side of a cell"}},
    {"parts_in_one_place",
     "mesh.msh",
     "4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n3\n1 1 2 1 1 1 2\n2 2 2 2 1 1 2 3",
     "7\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.2 0.3 0\n6 2 0 0\n7 2 1 0\n$EndNodes\n$Elements\n3\n1 1 2 1 1 1 3\n2 "
     "2 2 2 1 5 6 7",
     {"scene.toml line 4", "mesh.msh: cell 0", "overlaps cell 1", "parts of the mesh lie in one place"}},
    {"cell_without_area", "mesh.msh", "3 1 1 0", "3 2 0 0", {"scene.toml line 4", "mesh.msh", "no area"}},
};

class BadInput : public testing::TestWithParam<Fault> {};

TEST_P(BadInput, IsRefused) {
  const Fault &fault = GetParam();
  const bool of_mesh = std::string(fault.file) == "mesh.msh";
  std::string scene = good_scene, section = good_section, mesh = good_mesh;
  if (of_mesh)
    scene = changed(changed(scene, "section = \"section.csv\"\nsize = 0.25", "file = \"mesh.msh\"\n"),
                    "[boundary.left]\nkind = \"roller\"\n", "");
  std::string &spoilt = of_mesh ? mesh : std::string(fault.file) == "section.csv" ? section : scene;
  spoilt = changed(spoilt, fault.from, fault.to);
  const Folder folder;
  folder.write("scene.toml", scene), folder.write("section.csv", section), folder.write("mesh.msh", mesh);

  for (const std::vector<std::string> &command :
       {std::vector<std::string>{"run", "scene.toml", "-o", "results"}, {"check", "scene.toml"}}) {
    const Ending ending = talus(folder, command, fault.ranks);
    EXPECT_EQ(ending.status, 2);
    for (const std::string &words : fault.words) EXPECT_TRUE(ending.says(words)) << words;
    EXPECT_EQ(ending.count("talus: "), 1) << "one message";
    EXPECT_FALSE(ending.says("PETSC ERROR"));
    EXPECT_FALSE(std::filesystem::exists(folder / "results"));
    if (HasFailure()) ADD_FAILURE() << command[0] << ": " << ending.output;
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadInput, testing::ValuesIn(faults), [](const auto &fault) { return fault.param.name; });

/// What is wrong on the command line.
struct WrongWords {
  const char *name;
  std::vector<std::string> arguments, words;
};

void PrintTo(const WrongWords &wrong, std::ostream *out) { *out << wrong.name; }

const WrongWords wrong_words[] = {
    {"no_command", {}, {"A subcommand is required"}},
    {"unknown_option", {"run", "scene.toml", "--fast"}, {"--fast"}},
    {"scene_not_there", {"run", "noscene.toml"}, {"noscene.toml is neither a file nor a gallery scene", "column"}},
    {"scene_is_a_folder", {"check", "."}, {". is neither a file nor a gallery scene"}},
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
     {"stage.0.damping", "no effect in a quasi-static stage"}},
    {"body_to_remove_not_there",
     {"solve", "scene.toml", "--set", "stage.0.kind=quasi_static", "stage.0.remove=clay"},
     {"stage.0.remove", "there is no [body.clay]", "known are sand"}},
    {"body_removed_in_motion",
     {"run", "scene.toml", "--set", "stage.0.remove=sand"},
     {"stage.0.remove", "kind = \"quasi_static\""}},
    {"friction_without_motion",
     {"solve", "scene.toml", "--set", "stage.0.kind=quasi_static", "boundary.base.kind=friction"},
     {"boundary.base.kind", "no quasi-static form"}},
    {"seepage_without_water_that_moves",
     {"solve", "scene.toml", "--set", "stage.0.kind=seepage"},
     {"stage.0.kind", "needs pore water that moves", "phases = \"saturated\" or \"unsaturated\" (or \"drained\"",
      "not \"dry\""}},
    {"steady_motion",
     {"run", "scene.toml", "--set", "stage.0.steady=true"},
     {"stage.0.steady", "set kind = \"seepage\""}},
    {"no_results_to_plot", {"plot", "nowhere"}, {"nowhere contains no results"}},
};

/// A drained scene with a seepage stage, and what does not go with it.
TEST(Seepage, OfDrainedSoilIsChecked) {
  const Folder folder;
  folder.write("section.csv", good_section);
  const std::string wet =
      changed(changed(changed(good_scene, dry_part, WET_PART), "gravity", "phases = \"drained\"\ngravity"),
              "name = \"fall\"", "name = \"water\"\nkind = \"seepage\"");
  struct Spoiled {
    std::string scene;
    std::vector<std::string> words;
  };
  for (const auto &[scene, words] :
       std::vector<Spoiled>{{changed(wet, "seepage", "consolidation"),
                             {"stage.0.kind", "phases = \"saturated\" or \"unsaturated\", not \"drained\""}},
                            {changed(changed(changed(wet, "seepage", "consolidation"), "drained", "saturated"),
                                     "[output]", "[quasi_static]\nlinear_solver = \"iterative\"\n[output]"),
                             {"quasi_static.linear_solver", "must not be \"iterative\" for consolidation"}},
                            {changed(wet, "[water]", "[water]\nexcess = \"10 kPa\""),
                             {"water.excess", "cannot be combined with seepage", "[boundary.NAME]"}},
                            {changed(wet, "permeability = 1e-10", ""),
                             {"body.sand", "needs permeability [m2] or hydraulic_conductivity [m/s]"}},
                            {wet + "[body.sand.retention]\ncurve = \"van_genuchten\"\nreference_suction = -1\n",
                             {"body.sand.retention.reference_suction = -1"}},
                            {wet + "[body.sand.retention]\ncurve = \"gardner\"\ndecay_suction = 1e4\n"
                                   "[body.sand.relative_permeability]\ncurve = \"cubick\"\n",
                             {"body.sand.relative_permeability.curve = \"cubick\""}},
                            {wet + "[boundary.pond]\nkind = \"head\"\nlevel = 0.4\n",
                             {"boundary.pond.group", "the mesh has no \"pond\""}},
                            {wet + "[boundary.air]\ngroup = \"free_surface\"\nkind = \"gas_pressure\"\n",
                             {"boundary.air", "phases = \"drained\" has none"}}}) {
    folder.write("scene.toml", scene);
    for (const char *command : {"solve", "check"}) {
      const Ending ending = talus(folder, {command, "scene.toml"});
      EXPECT_EQ(ending.status, 2) << command << ending.output;
      for (const std::string &word : words) EXPECT_TRUE(ending.says(word)) << command << word << ending.output;
    }
  }
}

/// Functions are held against the range of their key where they are used: at the start that is bad input, later it ends
/// the run, with all that was computed until then.
TEST(Functions, AreCheckedAsTheyAreUsed) {
  const Folder folder;
  folder.write("section.csv", good_section);
  const std::string wet = changed(changed(good_scene, dry_part, WET_PART), "gravity", "phases = \"drained\"\ngravity");
  struct Spoiled {
    std::string scene;
    int status, ranks;
    std::vector<std::string> words;
  };
  const std::string still = changed(changed(wet, "cohesion = 0", "cohesion = \"100 kPa\""), "name = \"fall\"",
                                    "name = \"load\"\nkind = \"quasi_static\"");
  const std::string rubbed = "[boundary.base]\nkind = \"friction\"\nfriction_angle = \"";
  const auto base = [&](const std::string &angle) {
    return changed(good_scene, "[boundary.base]\nkind = \"fixed\"", rubbed + angle + "\"");
  };
  for (const auto &[scene, status, ranks, words] : std::vector<Spoiled>{
           {changed(wet, "[water]", "[water]\nlevel = \"sqrt(-1 - t)\""),
            2,
            1,
            {"water.level", "no number at t = 0 s"}},
           {changed(wet, "[water]", "[water]\nlevel = \"sqrt(0.03 - t)\""),
            1,
            2,
            {"water.level", "no number at t = 0.0"}},
           {changed(still, "[water]", "[water]\nlevel = \"sqrt(0.03 - t)\""),
            1,
            1,
            {"water.level", "no number at t = 0.0"}},
           {changed(wet, "[water]", "[water]\nlevel = \"x\""), 2, 1, {"water.level", "cannot depend on x"}},
           {base("100 + 0*t"), 1, 1, {"boundary.base.friction_angle", "0 to 89 deg; it is 100 deg at t = 0"}},
           {base("20 - 1000*t"), 1, 2, {"boundary.base.friction_angle", "0 to 89 deg; it is -"}},
           {changed(good_scene, "density = 2000", "density = 2000\nbody_acceleration = [\"1/(t - t)\", \"0\"]"),
            1,
            1,
            {"body.sand.body_acceleration", "a number in m/s2"}}}) {
    folder.write("scene.toml", scene);
    const Ending ending = talus(folder, {"run", "scene.toml", "--no-pictures"}, ranks);
    EXPECT_EQ(ending.status, status) << ending.output;
    for (const std::string &word : words) EXPECT_TRUE(ending.says(word)) << word << "\n" << ending.output;
    std::filesystem::remove_all(folder / "results");
  }
}

/// Without anything that acts, soil would be "in equilibrium" or "at rest" at once.
TEST(Stage, ThatWaitsNeedsSomethingToWaitFor) {
  const Folder folder;
  folder.write("scene.toml", good_scene), folder.write("section.csv", good_section);
  for (const char *until : {"equilibrium", "rest"}) {
    const Ending ending = talus(
        folder, {"run", "scene.toml", "--no-pictures", "--set", "gravity=0", std::string("stage.0.until=") + until});
    EXPECT_EQ(ending.status, 2) << ending.output;
    EXPECT_TRUE(ending.says("waits for soil on which nothing acts: give gravity")) << ending.output;
  }
}

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
