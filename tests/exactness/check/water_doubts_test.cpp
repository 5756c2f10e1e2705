// What `talus check` doubts of water, and of pores.
#include "check/check.h"

namespace talus {
namespace {

/// Pores are full of water below a water table, and not by an excess pressure alone.
TEST(Check, DoubtsWetWeightsWithoutAWaterTable) {
  const Folder folder;
  folder.write("section.csv", good_section);
  folder.write("scene.toml", changed(good_scene, "density = 2000",
                                     "unit_weight = \"18 kN/m3\"\nsaturated_unit_weight = \"21 kN/m3\""));
  const auto says = [&](const std::string &water) {
    return talus(folder, {"check", "scene.toml", "--set", "phases=drained", "--set", "water={" + water + "}"})
        .says("water.excess is the only pore pressure of body.sand");
  };
  EXPECT_TRUE(says("excess='max(0, 9810 * (0.4 - y))'"));
  EXPECT_FALSE(says("table='0.4 - 0.1 * x'"));
  EXPECT_FALSE(says("table='0.4 - 0.1 * x', excess='100 * x'"));
}

/// Soil whose pores are full everywhere weighs the same above and below any table.
TEST(Check, DoesNotDoubtFullPoresWithoutAWaterTable) {
  const Folder folder;
  folder.write("section.csv", good_section);
  folder.write("scene.toml",
               changed(good_scene, "density = 2000", "porosity = 0.3\ngrain_density = 2650\nsaturation = 1"));
  const auto says = [&](const std::string &saturation) {
    return talus(folder, {"check", "scene.toml", "--set", "phases=drained", "--set",
                          "water={excess='9810 * (0.5 - y)'}", "--set", "body.sand.saturation=" + saturation})
        .says("water.excess is the only pore pressure of body.sand");
  };
  EXPECT_TRUE(says("0.5"));
  EXPECT_FALSE(says("1"));
}

/// Open water is level and has a weight. The ground is level at y = 0.5 m up to x = 1 m, where it falls to 0 m at once.
TEST(Check, DoubtsOpenWaterThatIsNotLevel) {
  const Folder folder;
  const auto advice = [&](std::vector<std::string> overrides, int ranks = 1) {
    overrides.emplace_back("phases=drained");
    const Ending ending = check(folder, overrides, ranks);
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const std::string sloping = "water.table=[[0, 0.9], [1, 0.6]]";
  for (const int ranks : {1, 2}) {
    const Ending ending = advice({sloping}, ranks);
    EXPECT_TRUE(
        ending.says("water.table stands up to 0.6 m above the ground from x = 0 to 1 m and is not level there, "
                    "at 0.6 to 0.9 m"))
        << ending.output;
  }
  const char *doubt = "is not level there";
  EXPECT_FALSE(advice({"water.table=[[0, 0.9], [1, 0.9]]"}).says(doubt)) << "a pond";
  for (const int ranks : {1, 2})
    EXPECT_FALSE(advice({"water.table=[[0, 0.5], [1, 0]]"}, ranks).says(doubt)) << "water in the soil";
  EXPECT_FALSE(advice({"water.table=[[0, 0.502], [1, 0.49]]"}).says(doubt)) << "a film";
  EXPECT_FALSE(advice({sloping, "water.open_water_load=false"}).says(doubt)) << "a head";
  EXPECT_FALSE(advice({"water.table=[[0, 0.4], [1, 0.1]]"}).says(doubt));
  EXPECT_TRUE(advice({"water.table=[[0, 0.4], [1, 0.1]]", "water.level=[[0, 0], [0.05, 0.5]]"}).says(doubt))
      << "a table that rises above the ground";
  // a peak that lasts shorter than the times at which functions are looked at
  EXPECT_TRUE(
      advice({"water.table=[[0, 0.4], [1, 0.1]]", "water.level=[[0, 0], [0.0301, 0], [0.0305, 0.5], [0.0309, 0]]"})
          .says("water.table stands up to 0.6 m above the ground"))
      << "the deepest at the points of water.level";
  EXPECT_FALSE(advice({"water.table=[[0, 0.9], [0.1, 0.9], [0.2, 0.4], [0.8, 0.4], [0.9, 0.7], [1, 0.7]]"}).says(doubt))
      << "two ponds, of which each is level";
}

/// The good scene with soil whose water moves.
void write_wet_block(const Folder &folder) {
  folder.write("section.csv", good_section);
  folder.write("scene.toml",
               changed(good_scene, "density = 2000", "porosity = 0.4\ngrain_density = 2650\npermeability = 1e-10"));
}

/// Water that moves does not rest on the ground by its table.
TEST(Check, DoubtsPondsOfMovingWaterWithoutABoundary) {
  const Folder folder;
  const std::string pond = "water.table=[[0, 0.9], [1, 0.9]]";
  write_wet_block(folder);
  const auto output = [&](const std::vector<std::string> &overrides) {
    std::vector<std::string> arguments{"check", "scene.toml", "--json", "--set", "phases=saturated"};
    for (const std::string &one : overrides) arguments.insert(arguments.end(), {"--set", one});
    const Ending ending = talus(folder, arguments);
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const Ending dry = output({pond});
  EXPECT_TRUE(
      dry.says("water.table stands up to 0.9 m above the ground from x = 0 to 1 m, and no boundary puts water of this "
               "level on the ground there"))
      << dry.output;
  const char *doubt = "[dry_pond]";
  EXPECT_FALSE(output({"water.table=[[0, 0.4], [1, 0]]"}).says(doubt)) << "in the soil";
  EXPECT_FALSE(output({"water.table=[[0, 0.5], [1, 0.5]]"}).says(doubt)) << "up to the ground, beside a step down";
  const auto lake = [&](const char *level) {
    return output({pond, "boundary.lake.group=free_surface", "boundary.lake.kind=head",
                   std::string("boundary.lake.level=") + level});
  };
  EXPECT_FALSE(lake("0.9").says(doubt)) << "a lake";
  EXPECT_TRUE(lake("0.7").says(doubt)) << "low";
  EXPECT_FALSE(lake("1.1").says(doubt)) << "it rises over the pores";
}

/// Water that stands nowhere, rain that reaches no soil.
TEST(Check, DoubtsLevelsAndRainBesideTheSoil) {
  const Folder folder;
  write_wet_block(folder);
  const auto output = [&](const std::vector<std::string> &overrides) {
    std::vector<std::string> arguments{"check",
                                       "scene.toml",
                                       "--json",
                                       "--set",
                                       "phases=unsaturated",
                                       "--set",
                                       "body.sand.retention.material=loam",
                                       "--set",
                                       "body.sand.relative_permeability.curve=constant"};
    for (const std::string &one : overrides) arguments.insert(arguments.end(), {"--set", one});
    const Ending ending = talus(folder, arguments);
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const auto with = [&](const char *kind, const char *value) {
    return output({"boundary.top.group=free_surface", std::string("boundary.top.kind=") + kind,
                   std::string("boundary.top.") + value});
  };
  const char *low = "boundary.top has its water below all of its faces";
  EXPECT_TRUE(with("head", "level=-5").says(low)) << with("head", "level=-5").output;
  EXPECT_FALSE(with("head", "level=0.4").says(low));
  EXPECT_FALSE(with("head", "level=[[0, -5], [0.04, 1]]").says(low)) << "it rises";
  const char *wall = "boundary.top lies on faces that are vertical or overhang";
  EXPECT_FALSE(with("rainfall", "intensity=20 mm/h").says(wall));
  EXPECT_TRUE(
      output({"boundary.top.group=left", "boundary.top.kind=rainfall", "boundary.top.intensity=1e-6"}).says(wall))
      << with("rainfall", "intensity=20 mm/h").output;
  EXPECT_TRUE(output({"boundary.top.group=surface", "boundary.top.kind=rainfall", "boundary.top.intensity=1e-6"})
                  .says("boundary.top decides on the water at faces of the mesh that no soil touches"));
  const auto stages = [&](const char *more, std::vector<std::string> keys = {}) {
    keys.push_back(std::string("stage=[{name='rain', kind='seepage', duration=9}") + more + "]");
    return output(keys);
  };
  const char *undone = "stage.then.pore_flow = false gives the pores the pressure of [water] again";
  EXPECT_TRUE(stages(", {name='then', duration=1, pore_flow=false}").says(undone));
  EXPECT_FALSE(stages(", {name='then', duration=1}").says(undone));
}

/// Water that rises where that in the pores stays, and ground that drinks as if it were flooded.
TEST(Check, DoubtsOpenWaterThatPoresDoNotFollow) {
  const Folder folder;
  write_wet_block(folder);
  const auto output = [&](const char *phases, const std::string &level, const std::string &stage) {
    const Ending ending =
        talus(folder, {"check", "scene.toml", "--json", "--set", std::string("phases=") + phases, "--set",
                       "boundary.top={group='free_surface', kind='head', level=" + level + "}", "--set",
                       "stage=[{name='rest', duration=9, " + stage + "}]"});
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const std::string rises = "[[0, 0.6], [9, 0.9]]";
  const char *stays = "the water of boundary.top changes in stage rest, in which no pore water moves";
  const Ending doubted = output("saturated", rises, "kind='quasi_static'");
  EXPECT_TRUE(doubted.says(stays)) << doubted.output;
  EXPECT_FALSE(output("saturated", rises, "kind='consolidation'").says("in which no pore water moves"));
  EXPECT_FALSE(output("saturated", rises, "kind='quasi_static', hold_loads=true").says("in which no pore water moves"));
  EXPECT_FALSE(output("saturated", "0.6", "kind='quasi_static'").says("in which no pore water moves"));
  const auto open = [&](const std::string &boundary, const std::string &more = "body.sand.saturation=1") {
    const Ending ending =
        talus(folder, {"check", "scene.toml", "--json", "--set", "phases=drained", "--set", "water.table=[[0, 0.2]]",
                       "--set", boundary, "--set", "stage=[{name='seep', kind='seepage', duration=9}]", "--set", more});
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const char *drinks = "has no boundary of water, so that its pressure is 0";
  EXPECT_TRUE(open("boundary.well={group='left', kind='pore_pressure', pressure=1e3}").says(drinks))
      << open("boundary.well={group='left', kind='pore_pressure', pressure=1e3}").output;
  EXPECT_FALSE(open("boundary.top={group='free_surface', kind='rainfall', intensity=0}").says(drinks));
}

/// Water that is softer than the soil takes no load: B = 1 / (1 + 0.4 * 0.83 MPa / 2.2 MPa).
TEST(Check, DoubtsSoftWater) {
  const Folder folder;
  write_wet_block(folder);
  const auto output = [&](const std::string &one) {
    return talus(folder, {"check", "scene.toml", "--json", "--set", "phases=saturated", "--set", one});
  };
  const char *soft = "[soft_water]";
  EXPECT_TRUE(output("water.bulk_modulus=1 MPa").says(soft)) << output("water.bulk_modulus=1 MPa").output;
  EXPECT_FALSE(output("water.bulk_modulus=20 MPa").says(soft));
}

/// T = k M t / (gamma_w L^2) = 10 at k = 0.36 m/s for 0.5 m of soil in 0.05 s; 1e-10 m2 are 0.001 m/s, 1e-7 m2 are 1
/// m/s.
TEST(Check, DoubtsGivenPressuresWhereSoilCannotDrain) {
  const Folder folder;
  folder.write("scene.toml", sound_scene("drained")), folder.write("section.csv", good_section);
  const auto doubted = [&](const std::string &key) {
    return talus(folder, {"check", "scene.toml", "--json", "--set", key}).says("[drainage]");
  };
  EXPECT_TRUE(doubted("body.sand.permeability=1e-10"));
  EXPECT_FALSE(doubted("body.sand.permeability=1e-7"));
  EXPECT_FALSE(doubted("phases=saturated")) << "its pressure follows";
}

/// A boundary of water holds no soil.
TEST(Check, DoubtsEndsOfWetSoilThatNothingHolds) {
  const Folder folder;
  write_wet_block(folder);
  const auto output = [&](const char *left) {
    return talus(folder, {"check", "scene.toml", "--json", "--set", "phases=saturated", "--set",
                          "stage.0.until=equilibrium", "--set", "boundary.left.group=right", "--set", left});
  };
  const char *doubt = "the soil ends with the mesh at x = 0 m, and no boundary of the soil names";
  const Ending drain = output("boundary.lake={kind='head', group='left', level=0.4}");
  EXPECT_TRUE(drain.says(doubt)) << drain.output;
  EXPECT_FALSE(output("boundary.wall={kind='roller', group='left'}").says("the soil ends with the mesh at x = 0 m"));
}

/// Boundaries of water on faces that have no soil, or that soil may leave.
TEST(Check, DoubtsFacesOfWaterThatSoilLeaves) {
  const Folder folder;
  write_wet_block(folder);
  const auto output = [&](const std::string &group) {
    const Ending ending = talus(folder, {"check", "scene.toml", "--json", "--set", "phases=saturated", "--set",
                                         "boundary.pump.kind=flux", "--set", "boundary.pump.group=" + group});
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const char *bare = "boundary.pump decides on the water at faces of the mesh that no soil touches",
             *left = "boundary.pump decides on the water at faces where the soil begins";
  EXPECT_TRUE(output("surface").says(bare)) << output("surface").output;
  EXPECT_FALSE(output("left").says(bare) || output("left").says(left)) << "at the end of the mesh";
  EXPECT_FALSE(output("free_surface").says(bare) || output("free_surface").says(left));
  folder.write("section.csv", good_section + std::string("b_ground,0,0.5\nb_ground,1,0.5\n"));
  EXPECT_TRUE(output("ground").says(left)) << output("ground").output;
}

TEST(Check, DoubtsWaterTablesOfASoilAboveItsGround) {
  const Folder folder;
  folder.write("top.csv", good_section + "b_top,0,0.5\nb_top,1,0.5\n");
  const auto advice = [&](std::vector<std::string> overrides) {
    overrides.insert(overrides.end(), {"phases=drained", "water.density=1000", "mesh.section=top.csv"});
    const Ending ending = check(folder, overrides);
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const std::string own = "body.sand.water_table=[[0, 0.8], [1, 0.6]]";
  const char *doubt = "body.sand.water_table stands up to ";
  const Ending ending = advice({own});
  EXPECT_TRUE(ending.says(std::string(doubt) + "0.3 m above the ground from x = 0 to 1 m")) << ending.output;
  EXPECT_FALSE(advice({own, "water.table=[[0, 0.8], [1, 0.8]]"}).says(doubt)) << "under a pond as high";
  EXPECT_FALSE(advice({"body.sand.water_table=[[0, 0.4], [1, 0]]"}).says(doubt));
  EXPECT_FALSE(advice({"body.sand.water_table=[[0, 0.5], [1, 0.3]]"}).says(doubt)) << "water leaves at the steep face";
  EXPECT_FALSE(advice({own, "water.open_water_load=false"}).says(doubt)) << "a head";
  EXPECT_FALSE(advice({own, "boundary.top={kind='traction', pressure=3e3}"}).says(doubt)) << "a load bears against it";
}

/// Pressure at the surface of the soil counts as the load of open water. Under sealed ground there is none.
TEST(Check, DoubtsSeepageUnderSealedGround) {
  const Folder folder;
  folder.write("section.csv", good_section);
  folder.write("scene.toml",
               changed(good_scene, "density = 2000", "porosity = 0.3\ngrain_density = 2650\npermeability = 1e-12"));
  const auto advice = [&](const std::vector<std::string> &overrides) {
    std::vector<std::string> words{"check",          "scene.toml", "--set",
                                   "phases=drained", "--set",      "water.table=[[0, 0.3], [1, 0.1]]"};
    for (const std::string &one : overrides) words.insert(words.end(), {"--set", one});
    const Ending ending = talus(folder, words);
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const std::string seepage = "stage.0.kind=seepage",
                    sealed = "boundary.ground={kind='impermeable', group='free_surface'}";
  const char *doubt = "boundary.ground lets no water through the ground";
  EXPECT_TRUE(advice({seepage, sealed}).says(doubt));
  EXPECT_FALSE(advice({seepage, sealed, "water.open_water_load=false"}).says(doubt));
  const std::string second = "[[stage]]\nname = \"rain\"\nkind = \"seepage\"\nduration = 1\n",
                    dries =
                        "[body.sand.retention]\ncurve = \"van_genuchten\"\nreference_suction = 1e4\nshape = 0.5\n"
                        "[body.sand.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.5\n";
  folder.write("scene.toml",
               changed(good_scene, "density = 2000", "porosity = 0.3\ngrain_density = 2650\npermeability = 1e-12") +
                   dries + second);
  const char *early = "water.suction acts from the first stage of seepage on: the soil of stage.";
  EXPECT_TRUE(advice({"water.suction=5e4"}).says(early));
  EXPECT_FALSE(advice({"water.suction=5e4", seepage}).says(early));
  EXPECT_FALSE(advice({}).says(early));
  EXPECT_FALSE(advice({seepage, "boundary.ground={kind='impermeable', group='right'}"}).says(doubt)) << "a side";
  EXPECT_FALSE(advice({seepage, "boundary.ground={kind='rainfall', group='free_surface', intensity=0}"}).says(doubt));
}

/// A pressure pushes both sides of a line in the soil with the same force. Where soil comes or goes it does not.
TEST(Check, RefusesAPressureInsideTheSoil) {
  const Folder folder;
  const std::string crack = good_section + "b_crack,0.5,0.25\nb_crack,0.5,0.5\n";
  const std::string load = "[boundary.crack]\nkind = \"traction\"\n";
  const auto end_with = [&](const std::string &keys, const std::string &section) {
    folder.write("section.csv", section), folder.write("scene.toml", good_scene + load + keys);
    return talus(folder, {"check", "scene.toml"});
  };
  for (const int ranks : {1, 2}) {
    (void)end_with("pressure = 1e3\n", crack);
    const Ending refused = talus(folder, {"check", "scene.toml"}, ranks);
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(refused.says("boundary.crack.kind = \"traction\" is a pressure on a face inside the soil"))
        << refused.output;
  }
  EXPECT_EQ(end_with("traction = [1e3, 0]\n", crack).status, 0) << "an anchor";
  const std::string longer = good_section + "b_crack,0.5,0.5\nb_crack,1,0.5\nb_crack,1,0.25\n";
  EXPECT_EQ(end_with("pressure = 1e3\n", longer).status, 0) << "the surface";
  const std::string later =
      "[body.fill]\nregion = \"fill\"\ndensity = 2000\nlaw = \"linear_elastic\"\n"
      "young_modulus = 1e6\npoisson_ratio = 0.3\n[[stage]]\nkind = \"quasi_static\"\n"
      "duration = 1\nadd = [\"fill\"]\n";
  const std::string filled = changed(longer, "region_air,1.5,0.5", "region_fill,1.5,0.5");
  EXPECT_EQ(end_with("pressure = 1e3\n" + later, filled).status, 0) << "fill that comes later";
}

}  // namespace
}  // namespace talus
