// `talus check`: its numbers are those of a run, its advice fits the scene, and it writes nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sstream>

#include "bad_input/refused.h"

namespace talus {
namespace {

Ending check(const Folder &folder, const std::vector<std::string> &overrides, int ranks = 1) {
  folder.write("scene.toml", good_scene), folder.write("section.csv", good_section);
  std::vector<std::string> arguments{"check", "scene.toml", "--json"};
  for (const std::string &one : overrides) arguments.insert(arguments.end(), {"--set", one});
  return talus(folder, arguments, ranks);
}

/// The first number behind "key": in a JSON document.
double number(const Ending &ending, const std::string &key) {
  const std::size_t at = ending.output.find("\"" + key + "\": ");
  return at == std::string::npos ? NAN : std::stod(ending.output.substr(at + key.size() + 4));
}

TEST(Check, KnowsParticlesMassAndLayer) {
  const Folder folder;
  const Ending ending = check(folder, {});
  ASSERT_EQ(ending.status, 0) << ending.output;
  EXPECT_NEAR(number(ending, "mass_kg"), 2000 * 0.5, 1e-9);
  EXPECT_NEAR(number(ending, "volume_m3"), 0.5, 1e-12);
  const Ending page = talus(folder, {"check", "scene.toml"});
  EXPECT_TRUE(page.says("0.5 m3/m in cells of ")) << page.output;
  EXPECT_TRUE(page.says("steps: the fewest in that time, all as long as the first one")) << page.output;
  EXPECT_NEAR(number(ending, "height_m"), 0.5, 1e-12);
  const double modulus = 1e6 * 0.7 / (1.3 * 0.4);  // E (1 - nu) / ((1 + nu) (1 - 2 nu))
  EXPECT_NEAR(number(ending, "gravity_strain"), 2000 * 9.81 * 0.5 / modulus, 1e-9);
  EXPECT_NEAR(number(ending, "wave_speed_m_s"), std::sqrt(modulus / 2000), 1e-9);
  EXPECT_NEAR(number(ending, "step_s"), 0.6 * number(ending, "critical_step_s"), 1e-15);
  EXPECT_GT(number(ending, "burst_steps"), 10);
}

TEST(Check, TakesAPlaneSceneAsASliceBetweenRollers) {
  const Folder folder;
  folder.write("scene.toml", good_scene), folder.write("section.csv", good_section);
  const Ending flag = talus(folder, {"check", "scene.toml", "--json", "--slice"});
  ASSERT_EQ(flag.status, 0) << flag.output;
  EXPECT_TRUE(flag.says("\"one_element_slice\": true")) << flag.output;
  const Ending overrides = check(folder, {"dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller"});
  EXPECT_EQ(number(flag, "critical_step_s"), number(overrides, "critical_step_s"));
  EXPECT_EQ(number(flag, "mass_kg"), number(overrides, "mass_kg"));
}

TEST(Check, SaysWhatTheCriticalStepIsTakenFromAndWhy) {
  const Folder folder;
  const std::vector<std::string> in_3d{"dimension=3", "mesh.thickness=0.5", "mesh.layers=2",
                                       "boundary.front.kind=roller", "boundary.back.kind=roller"};
  const auto with = [&](const std::vector<std::string> &more) {
    std::vector<std::string> all = in_3d;
    all.insert(all.end(), more.begin(), more.end());
    return check(folder, all);
  };
  const Ending mesh = with({}), cells = with({"integrator.omega_max=cells"});
  EXPECT_TRUE(mesh.says("of the whole filled mesh (integrator.omega_max = \\\"auto\\\", on tetrahedra)"))
      << mesh.output;
  EXPECT_TRUE(cells.says("of the fastest filled cell (integrator.omega_max = \\\"cells\\\")")) << cells.output;
  EXPECT_GT(number(mesh, "step_s"), 1.5 * number(cells, "step_s"));
  const auto falls_back = [&](const Ending &ending, const std::string &why) {
    EXPECT_TRUE(ending.says("of the fastest filled cell (integrator.omega_max = \\\"auto\\\", and " + why))
        << ending.output;
  };
  falls_back(check(folder, {}), "in plane strain");
  falls_back(with({"mesh.layers=1"}), "in plane strain");
  falls_back(with({"integrator.step=1e-5"}), "integrator.step is fixed");
  falls_back(with({"integrator.fraction=0.81"}), "integrator.fraction is above 0.8");
  // a slip surface of 0.08 and of 8 m spreads by itself, below and above 1.5 times the height of 0.5 m
  const auto softening = [&](const char *shape_factor) {
    return with({"body.sand.cohesion=5e3", "body.sand.residual_cohesion=1e3", "body.sand.residual_friction_angle=25",
                 std::string("body.sand.shape_factor=") + shape_factor});
  };
  falls_back(softening("1000"), "where softening is brittle");
  EXPECT_TRUE(softening("10").says("on tetrahedra)"));
  folder.write("scene.toml", changed(good_scene, "density = 2000", "porosity = 0.4\ngrain_density = 2600"));
  std::vector<std::string> wet{"check",
                               "scene.toml",
                               "--json",
                               "--set",
                               "phases=saturated",
                               "body.sand.porosity=0.4",
                               "body.sand.grain_density=2650",
                               "body.sand.permeability=1e-10",
                               "water.table=[[0, 0.5], [2, 0.5]]"};
  wet.insert(wet.end(), in_3d.begin(), in_3d.end());
  falls_back(talus(folder, wet), "pore pressures of single cells scatter");
}

TEST(Check, FillsACellOnceThatTwoOfABodysRegionsName) {
  const Folder folder;
  EXPECT_NEAR(number(check(folder, {"body.sand.region=['sand', 'sand']"}), "mass_kg"), 1000, 1e-9);
}

TEST(Check, KnowsStagesByFiniteElements) {
  const Folder folder;
  const Ending ending = check(folder, {"stage.0.kind=quasi_static"});
  EXPECT_EQ(number(ending, "run_time_s"), 0);
  EXPECT_FALSE(ending.says("Gravity is applied at once")) << ending.output;
}

/// Soil that a stage adds has no particles yet: neither of it nor of a scene without other soil are numbers invented.
TEST(Check, SaysWhichSoilAStageAdds) {
  const Folder folder;
  folder.write("scene.toml", good_scene), folder.write("section.csv", good_section);
  const auto page = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"check", "scene.toml", "--set", "stage.0.kind=quasi_static"};
    for (const std::string &one : more) words.insert(words.end(), {"--set", one});
    return talus(folder, words);
  };
  const std::vector<std::string> fill{"body.fill.region=air", "body.fill.density=1800", "body.fill.law=linear_elastic",
                                      "body.fill.young_modulus=1e6", "body.fill.poisson_ratio=0.3"};
  std::vector<std::string> one = fill, all = fill;
  one.push_back("stage.0.add=[\"fill\"]"), all.push_back("stage.0.add=[\"fill\", \"sand\"]");
  for (const auto &[overrides, added, known] : {std::tuple{one, 1, true}, {all, 2, false}}) {
    const Ending ending = page(overrides);
    ASSERT_EQ(ending.status, 0) << ending.output;
    EXPECT_EQ(ending.count("added by a stage, not there at the start"), added) << ending.output;
    EXPECT_FALSE(ending.says("nan") || ending.says("-2147483648") || ending.says(" inf")) << ending.output;
    EXPECT_EQ(ending.says("Stages add all soil"), !known) << ending.output;
    EXPECT_EQ(ending.says("crossed by a wave"), known) << ending.output;
  }
}

TEST(Check, TellsThatARunBreaksOffAtOnce) {
  const Folder folder;
  const Ending ending = check(folder, {"body.sand.velocity=['1e200', '0']"});
  EXPECT_EQ(ending.status, 1);  // as the run itself ends
  EXPECT_TRUE(ending.says("The run breaks off in its first steps: the velocity is not finite near (")) << ending.output;
}

TEST(Check, TriesFunctionsOverStagesAndPlaces) {
  const Folder folder;
  const std::string belt = "boundary.base={kind='velocity', velocity=['0', '";
  EXPECT_FALSE(check(folder, {belt + "sqrt(0.06 - t)']}"}).says("A run ends where"));
  EXPECT_TRUE(check(folder, {belt + "sqrt(0.04 - t)']}"}).says("no number at t = 0.04"));
  EXPECT_TRUE(check(folder, {belt + "sqrt(0.7 - x)']}"})
                  .says("breaks off in its first steps: --set: boundary.base.velocity.1"));
}

TEST(Check, SaysHowStagesTakeABaseThatRemembersSlip) {
  const Folder folder;
  const std::string weakens = "boundary.base={kind='friction', friction_angle='30 - slip'}";
  EXPECT_FALSE(check(folder, {weakens}).says("boundary.base"));
  EXPECT_TRUE(check(folder, {weakens, "stage.0.kind=quasi_static"})
                  .says("Stage fall takes boundary.base at a slip of 0 and cold"));
  EXPECT_TRUE(check(folder, {weakens, "stage.0.gravity_ramp=0.01"}).says("counts slip and heat; softening = false"));
  EXPECT_TRUE(check(folder, {"boundary.base={kind='friction', friction_angle='30 - 100 * slip'}"})
                  .says("must be a number from 0 to 89 deg; it is -70 deg at slip = 1 m"));
}

/// A number without a unit counts in the unit of its key, which is not always the one that its writer had in mind.
TEST(Check, DoubtsValuesThatNoSoilHas) {
  const Folder folder;
  EXPECT_FALSE(check(folder, {"body.sand.cohesion=7 kPa"}).says("hardly any soil has"));
  EXPECT_TRUE(check(folder, {"body.sand.cohesion=7"}).says("body.sand.cohesion is 7 Pa, which hardly any soil has"));
  EXPECT_TRUE(check(folder, {"body.sand.friction_angle=0.47"}).says("body.sand.friction_angle is 0.47 deg"));
  EXPECT_TRUE(check(folder, {"body.sand.young_modulus=20"}).says("body.sand.young_modulus is 20 Pa"));
  EXPECT_TRUE(check(folder, {"body.sand.density=1.9"}).says("Is it in t/m3?"));
  EXPECT_TRUE(check(folder, {"body.sand.density=18"}).says("Is it in kN/m3 (key unit_weight)?"));
  const Ending nothing = check(folder, {"body.sand.density=0.01"});
  EXPECT_TRUE(nothing.says("density is 0.01 kg/m3, which hardly any soil has")) << nothing.output;
  EXPECT_FALSE(nothing.says("Is it in")) << "no unit makes it a soil";
}

/// Each number is asked for in the unit in which it is one of soils, and the density that follows from it is not.
TEST(Check, DoubtsUnitWeightsInTheUnitThatWasMeant) {
  const Folder folder;
  folder.write("section.csv", good_section);
  folder.write("scene.toml", changed(good_scene, "density = 2000", "unit_weight = 1900"));
  const auto asks = [&](const std::string &value, const std::string &question) {
    const Ending ending = talus(folder, {"check", "scene.toml", "--set", "body.sand.unit_weight=" + value});
    EXPECT_TRUE(ending.says("body.sand.unit_weight is ")) << ending.output;
    EXPECT_FALSE(ending.says("body.sand.density is")) << ending.output;
    EXPECT_EQ(ending.says("Is it in"), !question.empty()) << ending.output;
    EXPECT_TRUE(ending.says(question)) << value << ": " << ending.output;
  };
  asks("1900", "Is it in kg/m3 (key density)?");
  asks("90e3", "");
  EXPECT_FALSE(
      talus(folder, {"check", "scene.toml", "--set", "body.sand.unit_weight=19 kN/m3"}).says("hardly any soil"));
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
  EXPECT_TRUE(ending.says("The soil hangs over free space: nothing is below its faces at x = 0 to 1 m, y = 0.25 m"))
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
  const std::string drained = "phases=drained", few = "fewer than 4 cells over the depth";
  EXPECT_FALSE(says({"mesh.size=0.12"}, few));
  EXPECT_TRUE(says({"mesh.size=0.3"}, few));
  EXPECT_FALSE(says({"body.sand.tension_cutoff=1e3", "body.sand.cohesion=1e3"}, "has no effect"));
  EXPECT_TRUE(
      says({"body.sand.tension_cutoff=1e4", "body.sand.cohesion=1e3"}, "tension_cutoff is 1e+04 Pa and has no effect"));
  EXPECT_FALSE(says({drained, "water.table=[[0, 0.4], [2, 0.2]]"}, "water.table"));
  EXPECT_TRUE(says({drained, "water.table=[[0, 1000]]"}, "stands 999.5 m or more above the top of the soil"));
  EXPECT_TRUE(says({drained, "water.table=[[0, 1e5], [2, 1e3]]"}, "breaks off in its first steps"))
      << "a state that has broken off is not looked at";
  EXPECT_TRUE(says({drained, "water.table=[[0, 0.4]]", "water.density=1"}, "Is it in t/m3?"));
  EXPECT_TRUE(says({"gravity=9810"}, "Is it in mm/s2?"));
  EXPECT_TRUE(says({"gravity=9.81 ft/s2"}, "gravity is 2.99 m/s2; that of the earth is 9.81 m/s2. Is it 9.81 m/s2"));
  EXPECT_TRUE(says({"gravity=0.00981"}, "Is it 9.81 m/s2, and not mm/s2?"));
  EXPECT_TRUE(says({"gravity=490.5"}, "Is this 50 times as much meant, as in a centrifuge?"));
  for (const char *likely : {"gravity=9.81", "gravity=10", "gravity=32.2 ft/s2", "gravity=1.62", "gravity=0"})
    EXPECT_FALSE(says({likely}, "that of the earth")) << likely;
  EXPECT_TRUE(says({"body.sand.density=2.7"}, "a number without a unit counts in kg/m3. Is it in t/m3?"));
  const Ending in_grams = check(folder, {"body.sand.density=2700 g/m3"});
  EXPECT_TRUE(in_grams.says("hardly any soil has; the scene gives it as")) << in_grams.output;
  EXPECT_FALSE(in_grams.says("t/m3?")) << in_grams.output;
  EXPECT_TRUE(says({drained, "water.table=[[-9, 0.4], [-8, 0.2]]"}, "runs from x = -9 to -8 m, beside the soil"));
  EXPECT_TRUE(says({drained, "water.table=[[0, -1]]"}, "it gives no pore pressure"));
  EXPECT_FALSE(says({drained, "water.table=[[0, -1]]", "water.level=t"}, "it gives no pore pressure"));
  folder.write("scene.toml", changed(good_scene, "density = 2000", "unit_weight = 1900"));
  folder.write("section.csv", good_section);
  EXPECT_TRUE(talus(folder, {"check", "scene.toml"}).says("unit_weight is 1900 N/m3")) << "kg/m3";
  folder.write("mm.csv", "part,x,y\noutline,0,0\noutline,20e3,0\noutline,20e3,10e3\noutline,0,10e3\nregion_sand,5,5\n");
  EXPECT_TRUE(talus(folder, {"check", "scene.toml", "--set", "mesh.section=mm.csv", "--set", "mesh.size=1000"})
                  .says("Is the mesh in millimetres"));
}

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

/// A slide on a slope is as deep as it is thick, not as its range of elevations. A grid of the friction of its base has
/// to cover the ground downhill of it.
TEST(Check, LooksAtASlideOnASlope) {
  const Folder folder;
  const auto grid = [](int west, int columns, const std::function<double(double x)> &value) {
    std::ostringstream text;
    text << "ncols " << columns << "\nnrows 11\nxllcenter " << west << "\nyllcenter 0\ncellsize 10\n";
    for (int j = 0; j < 11; ++j)
      for (int i = 0; i < columns; ++i) text << value(west + 10 * i) << (i + 1 < columns ? " " : "\n");
    return text.str();
  };
  folder.write("ground.asc", grid(0, 21, [](double x) { return 200 - 0.5 * x; }));
  folder.write("scene.toml", R"toml(dimension = 3
up = "z"
gravity = 9.81
[mesh]
size = 4
[mesh.terrain]
file = "ground.asc"
air = 10
far_size = 8
[mesh.terrain.ellipsoid]
centre = [60, 50, 170]
semi_axes = [30, 20, 6]
dip = 26.565
dip_direction = 90
[grids]
bed = "bed.asc"
[body.debris]
region = "slide"
unit_weight = "20 kN/m3"
law = "mohr_coulomb"
young_modulus = "20 MPa"
poisson_ratio = 0.3
friction_angle = 30
cohesion = 0
[boundary.base]
kind = "friction"
friction_angle = "bed(x, y)"
[[stage]]
duration = 1
)toml");
  const auto look = [&](int west, int columns) {
    folder.write("bed.asc", grid(west, columns, [](double) { return 20; }));
    const Ending ending = talus(folder, {"check", "scene.toml", "--json"});
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const Ending whole = look(20, 19);  // what lies uphill is not asked for
  EXPECT_TRUE(whole.says("by mesh.terrain.far_size and mesh.size")) << "keys, no options: " << whole.output;
  EXPECT_FALSE(whole.says("--size"));
  EXPECT_TRUE(whole.says("cells grow to 8 m on the way"));
  const Ending halved = talus(folder, {"check", "scene.toml", "--json", "--set", "mesh.halvings=1"});
  EXPECT_FALSE(halved.says("on the way")) << "of 4 m they are smaller than the slide is thick: " << halved.output;
  const double exact =
      1 / std::hypot(std::cos(26.565 * std::acos(-1) / 180) / 6, std::sin(26.565 * std::acos(-1) / 180) / 30);
  EXPECT_NEAR(number(whole, "height_m"), exact, 3) << "to a cell; elevations range over 27 m";
  EXPECT_GE(number(whole, "longest_run_time_s"), number(whole, "run_time_s"));
  EXPECT_FALSE(whole.says("downhill"));
  const Ending part = look(20, 12);
  EXPECT_TRUE(part.says("bed.asc has no value at (13")) << part.output;
  EXPECT_TRUE(part.says("That place lies downhill of the soil")) << part.output;
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
        ending.says("water.table stands up to 0.6 m above the ground from x = 0 to 1 m and is not level there: "
                    "it lies between y = 0.6 and 0.9 m"))
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

/// A ditch from x = 0.5 to 1.5 m in ground at y = 0.5 m, 0.3 m deep.
TEST(Check, DoubtsPondsInHollowsOfTheGround) {
  const Folder folder;
  folder.write("ditch.csv",
               "part,x,y\noutline,0,0\noutline,2,0\noutline,2,1\noutline,0,1\ninterface0,0,0.5\ninterface0,0.5,0.5\n"
               "interface0,0.8,0.2\ninterface0,1.2,0.2\ninterface0,1.5,0.5\ninterface0,2,0.5\n"
               "region_sand,0.5,0.25\nregion_air,1,0.7\n");
  const auto advice = [&](const std::string &table, std::vector<std::string> overrides = {}) {
    overrides.insert(overrides.end(), {"phases=drained", "mesh.section=ditch.csv", "mesh.size=0.1", table,
                                       "boundary.right.kind=roller"});
    const Ending ending = check(folder, overrides);
    EXPECT_EQ(ending.status, 0) << ending.output;
    return ending;
  };
  const Ending level = advice("water.table=[[0, 0.4]]");
  EXPECT_TRUE(level.says("water.table makes a pond of up to 0.2 m in a hollow of the ground from x = 0.6"))
      << level.output;
  const char *doubt = "makes a pond of up to";
  EXPECT_TRUE(advice("water.table=[[0, 0.4], [2, 0.4]]").says(doubt)) << "no point in the hollow";
  EXPECT_TRUE(advice("water.table=[[0, 0.1]]", {"water.level=[[0, 0], [0.05, 0.3]]"}).says(doubt)) << "it rises";
  EXPECT_FALSE(advice("water.table=[[0, 0.4], [0.6, 0.4], [1.4, 0.4], [2, 0.4]]").says(doubt))
      << "points at the shores";
  EXPECT_FALSE(advice("water.table=[[0, 0.4], [0.7, 0.1], [1.3, 0.1], [2, 0.4]]").says(doubt)) << "below the bottom";
  EXPECT_FALSE(advice("water.table=[[0, 0.15]]").says(doubt));
  EXPECT_FALSE(advice("water.table=[[0, 0.4]]", {"water.open_water_load=false"}).says(doubt));
  EXPECT_FALSE(advice("water.table=[[0, 0.9]]").says(doubt)) << "a lake to both ends";
}

/// Undrained clay below a water table, and motion for days.
TEST(Check, DoubtsWaterOverSoilWithoutFriction) {
  const Folder folder;
  const auto doubted = [&](std::vector<std::string> overrides) {
    return check(folder, overrides).says("body.sand has no friction (friction_angle = 0)");
  };
  const std::vector<std::string> clay{"phases=drained", "water.table=[[0, 0.4]]", "body.sand.friction_angle=0",
                                      "body.sand.cohesion=5 kPa"};
  const auto with = [&](const std::vector<std::string> &more) {
    std::vector<std::string> all = clay;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  EXPECT_TRUE(doubted(clay));
  EXPECT_FALSE(doubted(with({"body.sand.friction_angle=20"})));
  EXPECT_FALSE(doubted(with({"water.table=[[0, -1]]"}))) << "no water in it";
  EXPECT_TRUE(doubted(with({"water.table=[[0, -1]]", "water.level=[[0, 0], [0.05, 1.2]]"}))) << "it rises";
  EXPECT_FALSE(doubted({"body.sand.friction_angle=0", "body.sand.cohesion=5 kPa"})) << "dry";
}

TEST(Check, DoubtsMotionOverDays) {
  const Folder folder;
  const char *doubt = "Stage fall lets the soil move for 3 d";
  EXPECT_TRUE(check(folder, {"stage.0.duration=3 d"}).says(doubt));
  EXPECT_FALSE(check(folder, {"stage.0.duration=20 h"}).says("lets the soil move for"));
  EXPECT_FALSE(check(folder, {"stage.0.duration=3 d", "stage.0.kind=quasi_static"}).says("lets the soil move for"));
}

/// A section of 20 m by 10 m that was drawn in millimetres; small cells in it are refused, with the same question.
TEST(Check, DoubtsSectionsInMillimetresBeforeTheirMesh) {
  const Folder folder;
  folder.write("millimetres.csv", "part,x,y\noutline,0,0\noutline,20000,0\noutline,20000,10000\noutline,0,10000\n");
  const Ending ending = talus(folder, {"mesh", "millimetres.csv", "--size", "2000", "-o", "a.msh"});
  EXPECT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("The mesh is 1e+04 m high; coordinates count in metres. Is the mesh in millimetres or feet?"))
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

/// Strain that is smoothed without the stress, where it matters.
TEST(Check, DoubtsNodalLockingOfSoilThatDilates) {
  const Folder folder;
  folder.write("section.csv", good_section);
  const char *doubt = "body.sand.dilation_angle and transfer.locking";
  EXPECT_TRUE(check(folder, {"transfer.locking=nodal", "body.sand.dilation_angle=5"}).says(doubt));
  EXPECT_FALSE(check(folder, {"transfer.locking=nodal"}).says(doubt));
  EXPECT_FALSE(check(folder, {"body.sand.dilation_angle=5"}).says(doubt));
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
  EXPECT_TRUE(ending.says(std::string(doubt) +
                          "0.3 m above the free surface of this soil and the open water on it, from x = 0 to 1 m"))
      << ending.output;
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
  const char *early = "water.suction acts from the first stage of seepage on, rain";
  EXPECT_TRUE(advice({"water.suction=5e4"}).says(early));
  EXPECT_FALSE(advice({"water.suction=5e4", seepage}).says(early));
  EXPECT_FALSE(advice({}).says(early));
  EXPECT_FALSE(advice({seepage, "boundary.ground={kind='impermeable', group='right'}"}).says(doubt)) << "a side";
  EXPECT_FALSE(advice({seepage, "boundary.ground={kind='rainfall', group='free_surface', intensity=0}"}).says(doubt));
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
  const char *left = "The soil ends with the mesh at x = 0 m, and no boundary names its face there, y = 0 to 0.5 m",
             *right = "The soil ends with the mesh at x = 1 m", *below = "Nothing holds the soil from below";
  const std::string elsewhere = "boundary.left.group=right", side = "boundary.base={kind='fixed', group='right'}";
  for (const int ranks : {1, 2}) EXPECT_TRUE(advice({still, elsewhere}, ranks).says(left));
  EXPECT_TRUE(advice({"stage.0.until=equilibrium", elsewhere}).says(left));
  EXPECT_FALSE(advice({elsewhere}).says(left)) << "run-out";
  EXPECT_FALSE(advice({still}).says(left));
  EXPECT_FALSE(advice({still}).says(right)) << "the mesh goes on beyond this face";
  EXPECT_FALSE(advice({still, "boundary.left={kind='traction', traction=[0, 0]}"}).says(left)) << "said to be free";
  EXPECT_FALSE(advice({}).says(below));
  for (const int ranks : {1, 2})
    EXPECT_TRUE(advice({side}, ranks).says(std::string(below) + ": its lowest faces, x = 0 to 1 m at y = 0 m"));
  EXPECT_FALSE(advice({"boundary.base={kind='friction', friction_angle=20}"}).says(below));
  folder.write("scene.toml", changed(good_scene, "density = 2000",
                                     "porosity = 0.4\ngrain_density = 2650\nhydraulic_conductivity = 1e-5"));
  const Ending seepage = talus(folder, {"check", "scene.toml", "--json", "--set", "phases=drained", "--set",
                                        "stage.0.kind=seepage", "--set", "water.table=[[0, 0.4]]", "--set", elsewhere});
  EXPECT_EQ(seepage.status, 0) << seepage.output;
  EXPECT_FALSE(seepage.says(left)) << "soil at rest";
}

/// The height of the soil is 0.5 m, its weight 2000 9.81 0.5 Pa = 9.81 kPa: c / (gamma H) is doubted below 0.001, 9.81
/// Pa, which is doubted at any height, and above 100. At 20 m the former is 392 Pa.
TEST(Check, DoubtsStrengthThatMakesNoSenseForItsHeight) {
  const Folder folder;
  const auto says = [&](const std::vector<std::string> &overrides, const char *text) {
    return check(folder, overrides).says(text);
  };
  EXPECT_FALSE(says({"body.sand.cohesion=0.9e6"}, "stands in any shape"));
  EXPECT_TRUE(says({"body.sand.cohesion=1e6"}, "times the weight of the soil, 9.81 kPa over its depth"));
  EXPECT_FALSE(says({"body.sand.cohesion=1e6", "body.sand.reduce_strength=false"}, "stands in any shape"));
  EXPECT_TRUE(says({"body.sand.cohesion=0.3e6"},
                   "The stiffness of body.sand, young_modulus = 1 MPa, is 3.333 times its cohesion"));
  EXPECT_FALSE(says({"body.sand.cohesion=0.1e6"}, "times its cohesion"));
  EXPECT_FALSE(says({"body.sand.young_modulus=5e9"}, "gives waves a speed of"));
  EXPECT_TRUE(says({"body.sand.young_modulus=50e9"}, "The stiffness of body.sand gives waves a speed of 5801 m/s"));
  EXPECT_FALSE(says({"body.sand.young_modulus=50e9", "body.sand.cohesion=2e6", "body.sand.reduce_strength=false"},
                    "gives waves a speed of"))
      << "rock";
  folder.write("high.csv", "part,x,y\noutline,0,0\noutline,20,0\noutline,20,20\noutline,0,20\nregion_sand,5,5\n");
  const auto high = [&](const std::vector<std::string> &overrides) {
    std::vector<std::string> all{"mesh.section=high.csv", "mesh.size=4"};
    all.insert(all.end(), overrides.begin(), overrides.end());
    return says(all, "it decides nothing");
  };
  EXPECT_TRUE(high({"body.sand.cohesion=32.6", "body.sand.friction_angle=20"}));
  EXPECT_FALSE(high({"body.sand.cohesion=400", "body.sand.friction_angle=20"}));
  EXPECT_FALSE(high({"body.sand.cohesion=100", "body.sand.friction_angle=33"})) << "sand with a trace of cohesion";
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

TEST(Check, FindsTheSameOnTwoRanks) {
  const Folder folder;
  const Ending one = check(folder, {}), two = check(folder, {}, 2);
  ASSERT_EQ(two.status, 0) << two.output;
  for (const char *key : {"cells", "nodes", "particles", "mass_kg", "critical_step_s", "height_m", "mean_quality"})
    EXPECT_NEAR(number(two, key), number(one, key), 1e-12 * number(one, key)) << key;
}

TEST(Check, GivesTheCriticalStepThatARunIsRefusedAt) {
  const Folder folder;
  const double critical = number(check(folder, {}), "critical_step_s");
  const auto run = [&](double step) {
    return talus(folder, {"run", "scene.toml", "-o", "results", "--no-pictures", "--set",
                          "integrator.step=" + std::to_string(step), "--set", "stage.0.duration=0.01"})
        .status;
  };
  EXPECT_EQ(run(1.02 * critical), 2);
  EXPECT_EQ(run(0.9 * critical), 0);
}

TEST(Check, WritesNothing) {
  const Folder folder;
  ASSERT_EQ(check(folder, {}).status, 0);
  for (const auto &entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename();
    EXPECT_TRUE(name == "scene.toml" || name == "section.csv" || name == "output") << name;
  }
}

// Sand that softens by 100 in cells of 0.25 m, under the weight of half its height:
// drop = 2000 9.81 0.25 (sin 30 - sin 20) Pa, L = 1.158 sqrt(3) 0.25 2 G / (2 (1 - nu) 100 drop), whatever the cells.
const std::vector<std::string> softening{"body.sand.residual_friction_angle=20", "body.sand.reference_size=0.25",
                                         "body.sand.shape_factor=100"};

std::vector<std::string> with(std::vector<std::string> overrides, const std::string &one) {
  overrides.push_back(one);
  return overrides;
}

TEST(Check, KnowsTheSlipSurfaceThatSpreads) {
  const Folder folder;
  const double degree = M_PI / 180, drop = 2000 * 9.81 * 0.25 * (0.5 - std::sin(20 * degree)), twice_G = 1e6 / 1.3;
  const double length = 1.158 * std::sqrt(3.) * 0.25 * twice_G / (1.4 * 100 * drop);
  EXPECT_NEAR(number(check(folder, softening), "critical_slip_length_m"), length, 1e-9 * length);
  for (const char *other : {"mesh.size=0.17", "body.sand.averaging_length=0.3"})
    EXPECT_NEAR(number(check(folder, with(softening, other)), "critical_slip_length_m"), length, 1e-9 * length)
        << other;
  EXPECT_NEAR(number(check(folder, with(softening, "body.sand.shape_factor=50")), "critical_slip_length_m"), 2 * length,
              1e-9 * length);
  EXPECT_EQ(number(check(folder, {}), "critical_slip_length_m"), 0);
}

TEST(Check, WarnsOfFlowFarFromTheNormal) {
  const Folder folder;
  const char *advice = "a load at failure is then not unique";
  const auto with_angles = [&](const char *phi, const char *psi) {
    return with(with(softening, std::string("body.sand.friction_angle=") + phi),
                std::string("body.sand.dilation_angle=") + psi);
  };
  EXPECT_TRUE(check(folder, with_angles("36", "5")).says(advice));
  EXPECT_TRUE(check(folder, with_angles("36", "5")).says("exceeds its dilation angle by 31 degrees"));
  EXPECT_FALSE(check(folder, with_angles("34", "5")).says(advice));
  EXPECT_FALSE(check(folder, {"body.sand.friction_angle=36"}).says(advice)) << "does not soften";
}

// tan(phi*) / tan(phi) = cos 36 cos 5 / (1 - sin 36 sin 5) = 0.849
TEST(Check, SaysWhatFlowFarFromTheNormalDoesToLoadsAndFactors) {
  const Folder folder;
  const char *load = "finds no more equilibrium is not unique",
             *factor = "so the factor of safety is that with the strength of Davis (1968), 0.85 of";
  const std::string gravity = "{name='gravity', kind='quasi_static', duration=1}";
  const auto angles = [](const char *phi, const std::string &last) {
    return std::vector<std::string>{std::string("body.sand.friction_angle=") + phi, "body.sand.dilation_angle=5", last};
  };
  const std::string loads = "stage=[" + gravity + ", {name='load', kind='quasi_static', duration=1}]";
  EXPECT_TRUE(check(folder, angles("36", loads))
                  .says("exceeds its dilation angle by 31 degrees: the load at which stage load finds"));
  EXPECT_FALSE(check(folder, angles("34", loads)).says(load));
  EXPECT_FALSE(check(folder, angles("36", "stage=[" + gravity + ", {name='slide', duration=1}]")).says(load))
      << "asks for no load";
  EXPECT_FALSE(check(folder, angles("36", loads)).says(factor)) << "asks for no factor";
  EXPECT_TRUE(check(folder, angles("36", "factor_of_safety.mechanisms=2")).says(factor));
  EXPECT_FALSE(check(folder, angles("34", "factor_of_safety.mechanisms=2")).says("strength of Davis"));
  const Ending softens =
      check(folder, with(with(with(softening, "body.sand.friction_angle=36"), "body.sand.dilation_angle=5"), loads));
  EXPECT_FALSE(softens.says(load)) << "said of its softening";
}

// the height is 0.5 m: a surface of 1.5 times that, 0.75 m, spreads at a shape factor of 475
TEST(Check, WarnsOfBrittleSoftening) {
  const Folder folder;
  const char *warning = "Softening of sand is brittle: a slip surface of about ";
  EXPECT_FALSE(check(folder, with(softening, "body.sand.shape_factor=450")).says(warning));
  EXPECT_TRUE(check(folder, with(softening, "body.sand.shape_factor=500")).says(warning));
  std::vector<std::string> words{"run", "scene.toml", "-o", "results", "--set"};
  words.insert(words.end(), softening.begin(), softening.end());
  words.emplace_back("body.sand.shape_factor=500");
  const Ending ending = talus(folder, words);
  ASSERT_EQ(ending.status, 0) << ending.output;
  for (const char *file : {"results/run.log", "results/report.html"}) {
    std::ostringstream text;
    text << std::ifstream(folder / file).rdbuf();
    EXPECT_NE(text.str().find(warning), std::string::npos) << file;
  }
}

/// Air in cells of 0.25 m loses its speed at 6e-6 / k 1/s, and its waves from cell to cell turn at 2300 rad/s.
TEST(Check, NamesGasThatDragHardlyHolds) {
  const Folder folder;
  folder.write("scene.toml", sound_scene("three-phase")), folder.write("section.csv", good_section);
  const auto page = [&](const std::string &permeability) {
    return talus(folder, {"check", "scene.toml", "--set", "body.sand.gas_permeability=" + permeability});
  };
  EXPECT_TRUE(page("1e-7").says("Gas moves through sand with hardly any drag"));
  EXPECT_FALSE(page("1e-9").says("hardly any drag"));
}

struct Case {
  const char *name;
  std::vector<std::string> overrides;
  const char *advice;
};

void PrintTo(const Case &one, std::ostream *out) { *out << one.name; }

const Case cases[] = {
    {"one_particle", {"body.sand.particles_per_cell=1"}, "One particle per cell in sand is too few"},
    {"locking", {"body.sand.poisson_ratio=0.48", "transfer.locking=none"}, "makes linear cells lock"},
    {"softening",
     {"body.sand.residual_friction_angle=20", "body.sand.shape_factor=10"},
     "softens without a reference_size"},
    {"average_that_cells_do_not_resolve",
     {"body.sand.residual_friction_angle=20", "body.sand.shape_factor=10", "body.sand.averaging_length=0.28"},
     "do not resolve its averaging_length of 0.28 m"},
    {"snap_back",
     {"body.sand.residual_friction_angle=20", "body.sand.shape_factor=5000", "body.sand.reference_size=0.25"},
     "snaps back"},
    {"soft_soil", {"body.sand.young_modulus=2e4"}, "The weight of the soil strains it by"},
    {"gravity_at_once", {}, "Gravity is applied at once"},
    {"rest_after_motion",
     {"stage=[{name='slide', duration=1}, {name='gravity', kind='quasi_static', duration=1}]"},
     "Stage gravity would bring the soil to rest under its weight, but comes after slide"},
    {"equilibrium_without_damping", {"stage.0.until=equilibrium"}, "waits for equilibrium without damping"},
    {"equilibrium_too_soon", {"stage.0.until=equilibrium", "stage.0.duration=0.1"}, "too short for equilibrium"},
    {"timid_step", {"integrator.step=1e-5"}, "of the critical step; without"},
    {"small_cells",
     {"mesh.refine=[{from = [0, 0], to = [0.1, 0.1], size = 0.02}]"},
     "in mesh.refine.0, determine the step"},
    {"remap_every_step", {"transfer.remap_interval=0"}, "A remap in every step costs"},
    {"slice", {"dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller"}, "A slice of one element"},
    {"ground_that_yields_at_rest",
     {"stage.0.kind=quasi_static", "body.sand.poisson_ratio=0.2"},
     "poisson_ratio above 0.25 (sin phi > 1 - 2 nu)"},
    {"dry", {}, "is right for soil without water"},
};

class Advice : public testing::TestWithParam<Case> {};

TEST_P(Advice, IsGivenWhereItIsDue) {
  const Folder folder;
  const Ending ending = check(folder, GetParam().overrides);
  EXPECT_EQ(ending.status, 0);
  EXPECT_TRUE(ending.says(GetParam().advice)) << ending.output;
}

TEST(NoAdvice, IsGivenWhereAllIsWell) {
  const Folder folder;
  const Ending ending = check(folder, {"gravity=0"});
  EXPECT_TRUE(ending.says("\"advice\": []")) << ending.output;
}

INSTANTIATE_TEST_SUITE_P(All, Advice, testing::ValuesIn(cases), [](const auto &one) { return one.param.name; });

}  // namespace
}  // namespace talus
