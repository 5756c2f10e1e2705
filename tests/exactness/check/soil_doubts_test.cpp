// What `talus check` doubts of soil, units and sections.
#include "check/check.h"

namespace talus {
namespace {

/// A value that is not usual is said with its place, and the scene may say that it is meant.
TEST(Check, DoubtsValuesThatAreNotUsual) {
  const Folder folder;
  const char *cohesion = "--set: cohesion = 7 Pa in body sand; usual 100 to 1e8 Pa, or 0; is it in kPa? [cohesion]";
  EXPECT_TRUE(check(folder, {"body.sand.cohesion=7"}).says(cohesion));
  EXPECT_FALSE(check(folder, {"body.sand.cohesion=7", "acknowledge=cohesion"}).says("[cohesion]"));
  EXPECT_FALSE(check(folder, {"body.sand.cohesion=7 kPa"}).says("[cohesion]"));
  EXPECT_TRUE(check(folder, {"body.sand.friction_angle=0.47"}).says("is it in rad? [friction_angle]"));
  EXPECT_TRUE(check(folder, {"body.sand.young_modulus=20"}).says("is it in MPa? [young_modulus]"));
  EXPECT_TRUE(check(folder, {"gravity=490.5"}).says("gravity = 490.5 m/s2; usual 9.7 to 10 m/s2 [gravity]"));
  EXPECT_TRUE(check(folder, {"stage.0.damping=0.7"}).says("damping = 0.7 in stage \\\"fall\\\"; usual 0 to 0.1"));
  EXPECT_TRUE(check(folder, {"boundary.base={kind='friction', friction_angle=0.35}"})
                  .says("friction_angle = 0.35 deg in boundary base; usual 3 to 45 deg, or 0; is it in rad?"));
  const Ending unknown = check(folder, {"acknowledge=cohesin"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_TRUE(unknown.says("names no doubt by cohesin; did you mean `cohesion`?")) << unknown.output;
}

/// A section in feet is as large as it was drawn, and check says what was taken.
TEST(Check, SaysTheUnitOfASection) {
  const Folder folder;
  folder.write("scene.toml", changed(good_scene, "size = 0.25", "size = \"0.25 ft\""));
  folder.write("section.csv", changed(good_section, "part,x,y", "part,x [ft],y [ft]"));
  const Ending ending = talus(folder, {"check", "scene.toml"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("section.csv: all numbers are in feet (line 1) and turned into metres")) << ending.output;
  const Ending mesh = talus(folder, {"mesh", "section.csv", "--size", "0.25 ft", "-o", "a.msh"});
  EXPECT_TRUE(mesh.says("a.msh from section.csv, in cells of 0.0762 m\n")) << mesh.output;
  EXPECT_TRUE(mesh.says("all numbers are in feet (line 1)")) << mesh.output;
  EXPECT_TRUE(mesh.says("region sand: ")) << mesh.output;
  EXPECT_TRUE(mesh.says(" cells, 0.0464")) << "half a square foot, in m2: " << mesh.output;
}

/// A region below soil that no body fills is a void, whose roof is soil.
TEST(Check, DoubtsSoilOverAVoid) {
  const Folder folder;
  folder.write("scene.toml", good_scene);
  const auto look = [&](const std::string &below, const std::vector<std::string> &more = {}) {
    folder.write("section.csv",
                 changed(good_section, "region_sand,0.5,0.25\n",
                         "interface1,0,0.25\ninterface1,1,0.25\nregion_sand,0.5,0.4\nregion_" + below + ",0.5,0.1\n"));
    std::vector<std::string> words{"check", "scene.toml", "--set", "mesh.size=0.1"};
    for (const std::string &one : more) words.insert(words.end(), {"--set", one});
    return talus(folder, words);
  };
  const Ending ending = look("clay");
  EXPECT_TRUE(ending.says("the soil hangs over free space: nothing is below its faces at x = 0.1 to 0.9 m, y = 0.25 m"))
      << ending.output;
  EXPECT_FALSE(look("clay", {"body.sand.region=['sand', 'clay']"}).says("hangs over"));
  const std::string held = "boundary.floor={group='floor', kind='fixed'}";
  folder.write("floor.csv", changed(good_section, "region_sand,0.5,0.25\n",
                                    "interface1,0,0.25\ninterface1,1,0.25\nregion_sand,0.5,0.4\nregion_clay,0.5,0.1\n"
                                    "b_floor,0,0.25\nb_floor,1,0.25\n"));
  EXPECT_FALSE(look("clay", {"mesh.section=floor.csv", held}).says("hangs over"));
  EXPECT_FALSE(check(folder, {}).says("hangs over"));
}

TEST(Check, DoubtsWhatFitsTheSoilBadly) {
  const Folder folder;
  const auto says = [&](const std::vector<std::string> &overrides, const std::string &text) {
    const Ending ending = check(folder, overrides);
    EXPECT_EQ(ending.status, ending.says("breaks off in its first steps") ? 1 : 0) << ending.output;
    return ending.says(text);
  };
  const std::string drained = "phases=drained", few = "fewer than 4 over the depth";
  EXPECT_FALSE(says({"mesh.size=0.12"}, few));
  EXPECT_TRUE(says({"mesh.size=0.3"}, few));
  EXPECT_FALSE(says({drained, "water.table=[[0, 0.4], [2, 0.2]]"}, "water.table"));
  EXPECT_TRUE(says({drained, "water.table=[[0, 1000]]"},
                   "water.table lies at y = 1000 m, and the soil at y = 0 to 0.5 m: are both in the same"));
  EXPECT_TRUE(says({drained, "water.table=[[0, 1e5], [2, 1e3]]"}, "breaks off in its first steps"))
      << "a state that has broken off is not looked at";
  EXPECT_TRUE(
      says({drained, "water.table=[[-9, 0.4], [-8, 0.2]]"},
           "water.table lies at y = 0.2 to 0.4 m, x = -9 to -8 m, and the soil at y = 0 to 0.5 m, x = 0 to 1 m"));
  EXPECT_TRUE(says({drained, "water.table=[[0, -1]]"}, "it gives no pore pressure"));
  EXPECT_FALSE(says({drained, "water.table=[[0, -1]]", "water.level=t"}, "it gives no pore pressure"));
  folder.write("scene.toml", good_scene);
  folder.write("mm.csv", "part,x,y\noutline,0,0\noutline,20e3,0\noutline,20e3,10e3\noutline,0,10e3\nregion_sand,5,5\n");
  EXPECT_TRUE(talus(folder, {"check", "scene.toml", "--set", "mesh.section=mm.csv", "--set", "mesh.size=1000", "--set",
                             "output.interval=0"})
                  .says("height of the mesh = 10000 m; usual 0.01 to 5000 m"));
}

/// Soil that was drawn and has no body would be a hole in the slope.
TEST(Check, DoubtsRegionsThatNoBodyFills) {
  const Folder folder;
  folder.write("scene.toml", good_scene);
  const auto says = [&](const std::string &name) {
    std::string section = good_section;
    if (!name.empty()) section = changed(section, "region_air", "region_" + name);
    folder.write("section.csv", section);
    return talus(folder, {"check", "scene.toml"}).says("no body fills the region");
  };
  EXPECT_FALSE(says(""));
  EXPECT_FALSE(says("air_1"));  // between cuts
  EXPECT_TRUE(says("gravel"));
}

/// A section of 20 m by 10 m that was drawn in millimetres; small cells in it are refused, with the same question.
TEST(Check, DoubtsSectionsInMillimetresBeforeTheirMesh) {
  const Folder folder;
  folder.write("millimetres.csv", "part,x,y\noutline,0,0\noutline,20000,0\noutline,20000,10000\noutline,0,10000\n");
  const Ending ending = talus(folder, {"mesh", "millimetres.csv", "--size", "2000", "-o", "a.msh"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("height of the mesh = 10000 m; usual 0.01 to 5000 m; coordinates count in metres"))
      << ending.output;
  const Ending fine = talus(folder, {"mesh", "millimetres.csv", "--size", "0.5", "-o", "b.msh"});
  EXPECT_NE(fine.status, 0);
  EXPECT_TRUE(fine.says("coordinates count in metres, are these in millimetres?")) << fine.output;
  folder.write("section.csv", good_section);
  EXPECT_FALSE(talus(folder, {"mesh", "section.csv", "--size", "0.25", "-o", "c.msh"}).says("millimetres"));
}

/// Interfaces listed from bottom to top: what the mesher doubts is said by check too.
TEST(Check, DoubtsInterfacesFromBottomToTop) {
  const Folder folder;
  const std::string outline = "part,x,y\noutline,0,0\noutline,2,0\noutline,2,1\noutline,0,1\n";
  folder.write("up.csv", outline + "interface0,0,0.25\ninterface0,2,0.25\ninterface1,0,0.5\ninterface1,2,0.5\n");
  const std::vector<std::string> words{"mesh.section=up.csv", "body.sand.region=layer2"};
  const Ending ending = check(folder, words);
  EXPECT_TRUE(ending.says("'interface1' (line 8) lies above 'interface0' (line 6)")) << ending.output;
}

/// Equilibrium of soil that ends with the mesh depends on what holds it there.
TEST(Check, DoubtsMissingSupports) {
  const Folder folder;
  const auto advice = [&](const std::vector<std::string> &overrides, int ranks = 1) {
    const Ending ending = check(folder, overrides, ranks);
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const std::string still = "stage.0.kind=quasi_static";
  const char *
      left = "the soil ends with the mesh at x = 0 m, and no boundary of the soil names its face there, y = 0 to 0.5 m",
     *right = "the soil ends with the mesh at x = 1 m", *below = "and no support names its face there, x = 0 to 1 m";
  const std::string elsewhere = "boundary.left.group=right", side = "boundary.base={kind='fixed', group='right'}";
  for (const int ranks : {1, 2}) EXPECT_TRUE(advice({still, elsewhere}, ranks).says(left));
  EXPECT_TRUE(advice({"stage.0.until=equilibrium", elsewhere}).says(left));
  EXPECT_TRUE(advice({elsewhere}).says(left)) << "a particle that leaves the mesh ends the run";
  EXPECT_FALSE(advice({elsewhere, "mesh.leaving_particles=remove"}).says(left)) << "run-out";
  EXPECT_FALSE(advice({still}).says(left));
  EXPECT_FALSE(advice({still}).says(right)) << "the mesh goes on beyond this face";
  EXPECT_FALSE(advice({still, "boundary.left={kind='traction', traction=[0, 0]}"}).says(left)) << "said to be free";
  EXPECT_FALSE(advice({}).says(below));
  for (const int ranks : {1, 2})
    EXPECT_TRUE(advice({side}, ranks).says(std::string("the soil ends with the mesh at y = 0 m, ") + below));
  EXPECT_FALSE(advice({"boundary.base={kind='friction', friction_angle=20}"}).says(below));
  folder.write("scene.toml", changed(good_scene, "density = 2000",
                                     "porosity = 0.4\ngrain_density = 2650\nhydraulic_conductivity = 1e-5"));
  const Ending seepage = talus(folder, {"check", "scene.toml", "--json", "--set", "phases=drained", "--set",
                                        "stage.0.kind=seepage", "--set", "water.table=[[0, 0.4]]", "--set", elsewhere});
  EXPECT_EQ(seepage.status, 0) << seepage.output;
  EXPECT_FALSE(seepage.says(left)) << "soil at rest";
}

/// The height of the soil is 0.5 m, its weight 2000 9.81 0.5 Pa = 9.81 kPa.
TEST(Check, DoubtsStrengthThatDoesNotFitTheWeight) {
  const Folder folder;
  const auto says = [&](const std::vector<std::string> &overrides, const char *text) {
    const Ending ending = check(folder, overrides);
    return ending.says(text);
  };
  const char *strength = "body.sand: cohesion / weight over the depth = ";
  EXPECT_FALSE(says({"body.sand.cohesion=0.9e6"}, strength));
  EXPECT_TRUE(says({"body.sand.cohesion=1e6"}, "over the depth = 101.9; usual 1e-4 to 100 [strength]"));
  EXPECT_FALSE(says({"body.sand.cohesion=1e6", "body.sand.reduce_strength=false"}, strength));
}

}  // namespace
}  // namespace talus
