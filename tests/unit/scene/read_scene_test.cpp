#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <set>

#include "complaint.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/output_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/water_source.h"

namespace talus {
namespace {

const std::string dry = R"(title = "a slope"
gravity = 9.81

[mesh]
file = "slope.msh"

[body.sand]
region = "hill"
density = 2000
law = "linear_elastic"

[boundary.base]
kind = "fixed"

[[stage]]
name = "creep"
duration = "1 min"

[output.point.crest]
position = [1, 2]
)";

const std::string drained = R"(phases = "drained"
[mesh]
section = "slope.csv"
size = 1
[body.clay]
region = "hill"
porosity = 0.4
grain_density = "2.65 t/m3"
[water]
table = [[0, 1], [10, 2]]
[[stage]]
duration = 1
)";

const std::string with_unit_weights = R"(phases = "drained"
gravity = 10
[mesh]
section = "slope.csv"
size = 1
[body.clay]
region = "hill"
unit_weight = "18 kN/m3"
[water]
table = [[0, 1], [10, 2]]
[[stage]]
duration = 1
)";

std::string refusal(const std::string &text, const std::vector<std::string> &overrides = {}) {
  return complaint([&] { parse_scene(text, "slope.toml", overrides); });
}

TEST(ReadScene, ComplainsAtAKeysPlaceAfterReadingToo) {
  const Scene scene = parse_scene(dry, "slope.toml", {"output.interval=0.5"});
  const int line =
      1 + static_cast<int>(std::count(dry.begin(), dry.begin() + static_cast<int>(dry.find("region =")), '\n'));
  EXPECT_EQ(complaint([&] { scene.complain("body.sand.region", "is empty"); }),
            "slope.toml line " + std::to_string(line) + ": body.sand.region = \"hill\" is empty");
  EXPECT_EQ(complaint([&] { scene.complain("output.interval", "is large"); }), "--set: output.interval = 0.5 is large");
}

TEST(ReadScene, ReadsADryScene) {
  const Scene scene = parse_scene(dry, "slope.toml");
  EXPECT_EQ(scene.title, "a slope");
  EXPECT_EQ(scene.file, "slope.toml");
  EXPECT_EQ(scene.phases, PhaseModel::dry);
  EXPECT_EQ(scene.gravity, (std::vector<double>{0, -9.81}));
  ASSERT_EQ(scene.body.size(), 1u);
  EXPECT_EQ(scene.body[0].name, "sand");
  EXPECT_EQ(scene.body[0].density, 2000);
  EXPECT_TRUE(scene.body[0].law.reader);
  EXPECT_FALSE(scene.integrator.reader);
  EXPECT_FALSE(scene.water->given);
  EXPECT_EQ(scene.boundary[0].group, std::vector<std::string>{"base"});
  EXPECT_EQ(scene.stage[0].duration, 60);
  EXPECT_EQ(scene.output->point[0].name, "crest");
}

TEST(ReadScene, ReadsADrainedScene) {
  const Scene scene = parse_scene(drained, "slope.toml");
  EXPECT_EQ(scene.phases, PhaseModel::drained);
  EXPECT_TRUE(scene.water->given);
  EXPECT_EQ(scene.water->table.points[1], (std::vector<double>{10, 2}));
  EXPECT_EQ(scene.body[0].grain_density, 2650);
  EXPECT_EQ(scene.gravity, (std::vector<double>{0, 0}));
}

TEST(ReadScene, PointsASingleGravityDownInThreeDimensions) {
  const Scene scene = parse_scene(dry, "slope.toml", {"dimension=3", "output.point.crest.position=[1, 2, 3]"});
  EXPECT_EQ(scene.gravity, (std::vector<double>{0, -9.81, 0}));
}

TEST(ReadScene, PointsOfASectionLieInTheMiddleOfItsBody) {
  const std::string text = drained + "[output.point.crest]\nposition = [1, 2]\n";
  EXPECT_EQ(parse_scene(text, "slope.toml").output->point[0].position, (std::vector<double>{1, 2}));
  const Scene slice = parse_scene(text, "slope.toml", {"dimension=3", "output.line.slip.points=[[0, 1], [4, 2, 0.1]]"});
  EXPECT_EQ(slice.output->point[0].position, (std::vector<double>{1, 2, 0.5}));  // of a cell of 1 m
  EXPECT_EQ(slice.output->line[0].points[0], (std::vector<double>{0, 1, 0.5}));
  EXPECT_EQ(slice.output->line[0].points[1], (std::vector<double>{4, 2, 0.1}));
  const Scene thick = parse_scene(text, "slope.toml", {"dimension=3", "mesh.thickness=6"});
  EXPECT_EQ(thick.output->point[0].position, (std::vector<double>{1, 2, 3}));
  EXPECT_NE(refusal(dry, {"dimension=3"}).find("must have 3 coordinates, not 2"),
            std::string::npos);  // a mesh from a file
}

TEST(ReadScene, KeepsTheTextAsItWasRun) {
  const Scene scene = parse_scene(dry, "slope.toml", {"body.sand.density=1800", "title=b"});
  EXPECT_EQ(scene.source, "# --set body.sand.density=1800\n# --set title=b\n" + dry);
  EXPECT_EQ(scene.body[0].density, 1800);
}

TEST(ReadScene, OverridesStagesByPositionAndByName) {
  EXPECT_EQ(parse_scene(dry, "slope.toml", {"stage.0.duration=3"}).stage[0].duration, 3);
  EXPECT_EQ(parse_scene(dry, "slope.toml", {"stage.creep.duration=1 h"}).stage[0].duration, 3600);
  EXPECT_EQ(refusal(dry, {"stage.crep.duration=3"}),
            "--set stage.crep.duration: the scene has no such entry `crep`; there are creep, or by number 0");
}

TEST(ReadScene, ReadsFiles) {
  const std::string file = testing::TempDir() + "talus_read_scene_test.toml";
  std::ofstream(file) << dry;
  EXPECT_EQ(read_scene(file).title, "a slope");
  EXPECT_EQ(read_scene(file).source, dry);
  std::remove(file.c_str());
}

TEST(ReadScene, RefusesAnUnknownTableOfTheScene) {
  EXPECT_EQ(refusal(dry + "[outptu]\n"), "slope.toml line 21: outptu is no known key; did you mean `output`?");
}

TEST(ReadScene, DemandsWhatASceneCannotDoWithout) {
  EXPECT_EQ(refusal(""), "slope.toml: body has no soil; add a table [body.NAME] with region, density and law");
  EXPECT_EQ(refusal("[body.a]\nregion = 'a'\n"),
            "slope.toml: stage is missing; add a table [[stage]] with its duration");
}

TEST(ReadScene, ChecksOneKeyAgainstAnother) {
  const struct {
    const std::string &text;
    std::vector<std::string> overrides;
    const char *expected;
  } table[] = {
      {dry,
       {"mesh.section=a.csv"},
       "slope.toml line 4: mesh has two sources: give one of file, section and terrain.file"},
      {dry, {"mesh={}"}, "--set: mesh needs a source: give file, section or terrain.file"},
      {drained, {"mesh.size=0"}, "--set: mesh.size = 0 must be a cell size above 0 m"},
      {dry,
       {"dimension=4"},
       "dimension = 4 (2: plane strain on triangles, 3: tetrahedra) must be a whole number from 2 to 3"},
      {dry, {"gravity=[0, 0, -9.81]"}, "--set: gravity = [0, 0, -9.81] must be one number, which acts downwards, or"},
      {dry, {"gravity=[9, -4]"}, "gravity = [9, -4] must point down, within 60 degrees of -y"},
      {dry, {"gravity=[0, 9.81]"}, "turn the mesh, or set gravity to a number, which acts along -y"},
      {dry, {"dimension=3", "gravity=[0, 0, -9.81]"}, "are counted along up = \"y\": set up = \"z\""},
      {dry,
       {"dimension=3", "up=z", "gravity=[0, -9.81, 0]"},
       "within 60 degrees of -z, since elevations are counted along up = \"z\": set up = \"y\""},
      {dry, {"up=z"}, "up = \"z\" needs dimension = 3: in plane strain y is up"},
      {drained, {"dimension=3", "up=z"}, "mesh.section = \"slope.csv\" counts elevations along y"},
      {dry, {"gravity=-9.81"}, "gravity = -9.81 must not be negative"},
      {dry, {"body.sand.region=[]"}, "slope.toml line 7: body.sand needs region"},
      {dry, {"body.snd.density=1"}, "or is this body `sand`, misspelt?"},
      {dry, {"body.sand.velocity=[1, 2, 3]"}, "must have 2 components, not 3 (dimension = 2)"},
      {dry, {"body.sand.displacement=1"}, "must have 2 components, not 1 (dimension = 2)"},
      {dry, {"body.sand.body_acceleration=[1]"}, "must have 2 components, not 1 (dimension = 2)"},
      {dry, {"body.sand.stress=[1, 2, 3]"}, "must have 4 components, not 3 (dimension = 2)"},
      {dry, {"body.sand.density=0.01", "body.sand.grain_density=2650", "body.sand.porosity=0.3"}, "is given twice"},
      {dry,
       {"body.clay={region=\"a\"}"},
       "--set: body.clay needs a weight: give unit_weight, density, or porosity and grain_density"},
      {dry, {"body.clay={region=\"a\", porosity=0.3}"}, "body.clay needs a weight"},
      {dry, {"body.sand.dense=[{from=[0, 0], to=[1, 1]}]"}, "body.sand.dense.0 needs particles_per_cell"},
      {dry, {"mesh.refine=[{from=[0, 0], to=[1, 0], size=1}]"}, "mesh.refine.0.to = [1, 0] must lie beyond `from`"},
      {dry, {"mesh.refine=[{from=[0], to=[1, 0], size=1}]"}, "mesh.refine.0.from = [0] must have 2 coordinates, not 1"},
      {drained, {"body.clay.unit_weight=19 kN/m3", "gravity=10"}, "unit_weight = \"19 kN/m3\" is a second weight"},
      {dry, {"body.clay={region=\"a\", unit_weight=19000}", "gravity=0"}, "cannot be used without gravity"},
      {dry,
       {"body.clay={region=\"a\", unit_weight=19000, saturated_unit_weight=20000}"},
       "saturated_unit_weight = 20000 has no effect, since phases = \"dry\""},
      {with_unit_weights,
       {"body.clay.unit_weight=21 kN/m3", "body.clay.saturated_unit_weight=20 kN/m3"},
       "saturated_unit_weight = \"20 kN/m3\" must exceed unit_weight by 0 to 10000 N/m3"},
      {with_unit_weights, {"body.clay.porosity=0.3", "body.clay.saturated_unit_weight=20 kN/m3"}, "leave porosity out"},
      {dry,
       {"factor_of_safety.within=[[0, 0], [4, 3], [4, 0], [0, 3]]"},
       "factor_of_safety.within = [[0, 0], [4, 3], [4, 0], [0, 3]] must not cross itself, as its sides from points 0 "
       "and 2"},
      {with_unit_weights,
       {"body.clay.pore_pressure_ratio=0.3", "body.clay.saturated_unit_weight=20 kN/m3"},
       "needs a weight that does not depend on a water table"},
      {dry,
       {"body.clay={region=\"a\", unit_weight=18}"},
       "must be a number from 1000 to 1e5 N/m3; usual 10000 to 30000 N/m3"},
      {with_unit_weights,
       {"body.clay.pore_pressure_ratio=0.2", "gravity=[3.4, -9.2]"},
       "needs gravity along -y, since it counts the soil above along y"},
      {dry, {"body.sand.pore_pressure_ratio=0.3"}, "needs phases = \"drained\" and no seepage stage"},
      {with_unit_weights,
       {"phases=saturated", "body.clay.permeability=1e-12"},
       "give saturated_unit_weight and porosity"},
      {dry, {"stage.0.seismic_coefficient=[0.1]"}, "stage.0.seismic_coefficient = [0.1] must have 2 components, not 1"},
      {dry, {"stage.0.seismic_coefficient=[0.1, 15]"}, "must have components from -2 to 2"},
      {drained,
       {"phases=saturated"},
       "needs permeability [m2] or hydraulic_conductivity [m/s], since pore water moves"},
      {drained,
       {"phases=unsaturated", "body.clay.permeability=1e-12"},
       "needs a retention curve, since its saturation may change"},
      {drained,
       {"phases=saturated", "body.clay.permeability=1e-3 m/s"},
       "that is a hydraulic_conductivity; permeability is in m2"},
      {drained,
       {"phases=saturated", "body.clay.permeability=1e-12", "body.clay.hydraulic_conductivity=1e-5"},
       "is given twice: give permeability or"},
      {drained, {"gas={}"}, "--set: gas has no effect, since phases = \"drained\""},
      {dry, {"water={}"}, "--set: water has no effect, since phases = \"dry\""},
      {drained,
       {"water.table=[[1, 0], [1, 2]]"},
       "water.table.1 = [1, 2] must lie to the right of the point before it"},
      {drained,
       {"water.table=[[1, 0, 3]]"},
       "water.table.0 = [1, 0, 3] must have 2 coordinates, [x, elevation], not 3"},
      {drained, {"water.table=[]"}, "must be a list with at least one point; leave it out for none"},
      {drained,
       {"body.clay.relative_permeability.curve=cubic"},
       "has no effect without a retention curve, from which the degree of saturation follows: add "
       "[body.clay.retention] with curve, or leave [body.clay.relative_permeability] out"},
      {dry, {"mesh.halvings=5"}, "so that none holds all cells) must be a whole number from 0 to 4"},
      {dry, {"mesh.halvings=0.5"}, "must be a whole number from 0 to 4"},
      {dry, {"mesh.halving=1"}, "did you mean `halvings`?"},
      {dry, {"mesh.leaving_particles=go"}, "may be changed with --resume) must be one of stop, remove"},
      {dry, {"output.point.crest.position=[1]"}, "output.point.crest.position = [1] must have 2 coordinates, not 1"},
      {dry,
       {"stage.0.until=failure"},
       "slope.toml line 15: stage.0.failure_point must name a point of [output.point.NAME]"},
      {dry, {"stage.0.until=failure", "stage.0.failure_point=crets"}, "did you mean `crest`?"},
      {drained, {"stage.0.until=failure"}, "the scene has no points: add [output.point.NAME]"},
  };
  for (const auto &[text, overrides, expected] : table)
    EXPECT_TRUE(contains(refusal(text, overrides), expected)) << expected << "\n" << refusal(text, overrides);
}

TEST(ReadScene, NeedsWaterInADrainedScene) {
  const std::string text =
      "phases = 'drained'\n[mesh]\nfile = 'a'\n[body.a]\nregion = 'a'\nporosity = 0.3\ngrain_density = "
      "2650\n[[stage]]\nduration = 1\n";
  EXPECT_EQ(refusal(text),
            "slope.toml line 1: phases = \"drained\" needs pore water: add a table [water] with its table of "
            "points [x, elevation], or an empty one for none");
}

TEST(ReadScene, TakesUnitWeightsForDensities) {
  const std::string one =
      "gravity = 10\n[mesh]\nfile = 'a'\n[body.a]\nregion = 'a'\nunit_weight = '19 kN/m3'\n"
      "[[stage]]\nduration = 1\n";
  EXPECT_DOUBLE_EQ(parse_scene(one, "a.toml", {}).body[0].density, 1900);
  const BodySource two = parse_scene(with_unit_weights, "a.toml", {"body.clay.saturated_unit_weight=20 kN/m3"})
                             .body[0];  // 18 above, 20 below the water table
  EXPECT_DOUBLE_EQ((1 - two.porosity) * two.grain_density, 1800);
  EXPECT_DOUBLE_EQ((1 - two.porosity) * two.grain_density + two.porosity * 1000, 2000);
  EXPECT_DOUBLE_EQ(
      parse_scene(with_unit_weights, "a.toml", {"body.clay.saturated_unit_weight=18 kN/m3"}).body[0].density, 1800);
  EXPECT_EQ(two.saturation, 0);
  const std::string moving =
      "phases = 'saturated'\n[body.a]\nregion = 'a'\nsaturated_unit_weight = '20 kN/m3'\n"
      "porosity = 0.4\npermeability = 1e-12\n[water]\n";
  const std::string rest = "[mesh]\nfile = 'a'\n[[stage]]\nduration = 1\n";
  const BodySource wet = parse_scene("gravity = 10\n" + moving + rest, "a.toml", {}).body[0];
  EXPECT_DOUBLE_EQ(0.6 * wet.grain_density + 0.4 * 1000, 2000);
  EXPECT_TRUE(contains(refusal("gravity = 10\n" + moving + rest, {"body.a.saturated_unit_weight=3 kN/m3"}),
                       "must exceed the weight of the water in the pores, porosity times 10000 N/m3"));
}

TEST(ReadScene, AddsAnEarthquakeToGravity) {
  const Scene scene = parse_scene(dry, "slope.toml", {"gravity=[3, -4]", "stage.0.seismic_coefficient=[0.2, -0.1]"});
  EXPECT_EQ(scene.acceleration_in(scene.stage[0]), (std::array<double, 3>{3 + 5 * 0.2, -4 - 5 * 0.1, 0}));
  EXPECT_EQ(scene.acceleration_in(Stage{}), (std::array<double, 3>{3, -4, 0}));
}

TEST(ReadScene, TakesAFailureStageThatWatchesAnOutputPoint) {
  const Scene scene = parse_scene(dry, "slope.toml", {"stage.0.until=failure", "stage.0.failure_point=crest"});
  ASSERT_TRUE(scene.stage[0].motion());
  EXPECT_EQ(std::get<AtFailure>(scene.stage[0].motion()->until).failure_point, "crest");
  EXPECT_TRUE(scene.stage[0].stop().early);
  EXPECT_FALSE(scene.stage[0].stop().waits_for_loads);
}

/// What the program asks of a kind of stage.
TEST(ReadScene, KnowsTheTraitsOfStages) {
  const auto stage = [](const std::string &kind) {
    const std::string more = kind == "dynamic" ? "" : "load_steps = 7\nadd = ['fill']\ninitial_stress = 'k0'\n";
    Scene scene = parse_scene(
        "phases = 'saturated'\ngravity = 10\n[mesh]\nfile = 'a'\n[body.fill]\nregion = 'a'\nporosity = 0.4\n"
        "grain_density = 2650\npermeability = 1e-12\n[water]\n[[stage]]\nduration = 1\nkind = '" +
            kind + "'\n" + more,
        "a.toml");
    return scene.stage[0];
  };
  const Stage moves = stage("dynamic"), rests = stage("quasi_static"), seeps = stage("seepage"),
              consolidates = stage("consolidation");
  EXPECT_FALSE(moves.is_static() || moves.water_flows() || moves.finite_elements() || moves.begins_at_rest());
  EXPECT_TRUE(rests.is_static() && rests.soil_moves() && !rests.water_flows() && !rests.motion());
  EXPECT_TRUE(seeps.is_static() && !seeps.soil_moves() && seeps.water_flows() && seeps.seeps());
  EXPECT_TRUE(consolidates.is_static() && consolidates.soil_moves() && consolidates.water_flows());
  for (const Stage &one : {rests, seeps, consolidates}) {
    EXPECT_EQ(one.finite_elements()->load_steps, 7);
    EXPECT_TRUE(one.adds("fill") && !one.removes("fill") && one.begins_at_rest());
  }
}

/// The stage that `talus solve --factor-of-safety` adds is the one that a scene may have.
TEST(ReadScene, MayLookForAFactorOfSafety) {
  Scene scene = parse_scene(dry, "slope.toml", {"stage.0.kind=quasi_static"});
  EXPECT_FALSE(scene.finds_factor());
  scene.add_factor_stage();
  scene.add_factor_stage();
  ASSERT_EQ(scene.stage.size(), 2u);
  EXPECT_TRUE(scene.finds_factor() && scene.stage[1].is_static() && !scene.stage[1].soil_moves());
  const Scene given = parse_scene(std::string(dry) + "\n[[stage]]\nkind = 'factor_of_safety'\n", "slope.toml",
                                  {"stage.0.kind=quasi_static"});
  EXPECT_TRUE(given.stage[1].finds_factor());
  EXPECT_EQ(given.stage[1].duration, 0);
}

TEST(ReadScene, LeavesTheMeshToAHost) {
  const std::string rest = "[body.a]\nregion = 'a'\ndensity = 2000\nlaw = 'linear_elastic'\n[[stage]]\nduration = 1\n";
  EXPECT_EQ(parse_host_scene(rest, "host").body[0].name, "a");
  EXPECT_TRUE(contains(complaint([&] { parse_host_scene("[mesh]\nfile = 'a.msh'\n" + rest, "host"); }),
                       "host line 1: mesh has a source, but the host program brings the mesh"));
}

/// Each key that names a file says so itself: what a run reads is known before it runs.
TEST(ReadScene, KnowsTheFilesThatItNames) {
  const std::string named =
      "[mesh]\nfile = 'slope.msh'\n[grids]\nwet = '/data/wet.tif'\n[start_from]\nfolder = 'results/before'\n"
      "[body.a]\nregion = 'a'\ndensity = 2000\nlaw = 'linear_elastic'\n[[stage]]\nduration = 1\n";
  const std::set<std::string> always{"/data/wet.tif", "folder/results/before"};
  const auto files = [&](const std::vector<std::string> &overrides, std::set<std::string> more) {
    more.insert(always.begin(), always.end());
    EXPECT_EQ(parse_scene(named, "folder/scene.toml", overrides).root->files(), more);
  };
  files({}, {"folder/slope.msh"});
  files({"mesh={section='../slope.csv', size=1}"}, {"slope.csv"});
  const std::string terrain = "mesh={size=1, terrain={file='dem.asc', base=[0], layer.clay.file='clay.asc', ";
  files({"dimension=3", "up=z", terrain + "slip_surface='slip.asc'}}"},
        {"folder/dem.asc", "folder/clay.asc", "folder/slip.asc"});
  files({"dimension=3", "up=z", terrain + "outline='slide.shp', depth=2}}"},
        {"folder/dem.asc", "folder/clay.asc", "folder/slide.shp"});
}

TEST(ReadScene, HasOnePathForAKeyOfAList) {
  const Scene scene = parse_scene(dry, "slope.toml");
  EXPECT_EQ(scene.root->one_path("stage.creep.duration"), "stage.0.duration");
  EXPECT_EQ(scene.root->one_path("stage.00.duration"), "stage.0.duration");
  EXPECT_EQ(scene.root->one_path("body.sand.cohesion"), "body.sand.cohesion");
  EXPECT_EQ(scene.root->one_path("nothing.there"), "nothing.there");
}

}  // namespace
}  // namespace talus
