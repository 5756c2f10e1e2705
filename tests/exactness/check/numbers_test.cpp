// Numbers of `talus check` are those of a run, and it writes nothing.
#include <functional>
#include <sstream>

#include "check/check.h"

namespace talus {
namespace {

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
  EXPECT_NEAR(number(ending, "wave_speed_m_s"), std::sqrt(modulus / 2000), 1e-9);
  EXPECT_NEAR(number(ending, "step_s"), 0.6 * number(ending, "critical_step_s"), 1e-15);
  EXPECT_GT(number(ending, "burst_steps"), 10);
}

/// Bodies bear the weight in series: a tenth of the height with a hundredth of the stiffness lies on top here.
TEST(Check, StacksBodiesOfALayer) {
  const Folder folder;
  const std::string soft =
      "[body.soft]\nregion = \"soft\"\ndensity = 2000\nlaw = \"linear_elastic\"\n"
      "young_modulus = \"10 kPa\"\npoisson_ratio = 0.3\n";
  folder.write("scene.toml", changed(good_scene, "[body.sand]", soft + "[body.sand]"));
  folder.write("section.csv",
               "part,x,y\noutline,0,0\noutline,1,0\noutline,1,0.5\noutline,0,0.5\ninterface0,0,0.45\n"
               "interface0,1,0.45\nregion_sand,0.5,0.25\nregion_soft,0.5,0.475\n");
  const Ending ending = talus(folder, {"check", "scene.toml", "--json"});
  ASSERT_EQ(ending.status, 0) << ending.output;
  const double modulus = 1e6 * 0.7 / (1.3 * 0.4), stack = modulus / (0.9 + 0.1 * 100);
  EXPECT_NEAR(number(ending, "modulus_Pa"), stack, 1e-9 * stack);
  EXPECT_NEAR(number(ending, "transit_s"), 0.5 * (0.9 + 0.1 * 10) / std::sqrt(modulus / 2000), 1e-9);
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

/// docs/theory/earthquakes.md (9.4): the step of a stage is that of its fastest cell under Rayleigh damping, and a run
/// takes it. A fixed step has to be below that.
TEST(Check, SaysWhatDampingDoesToTheStep) {
  const Folder folder;
  const std::vector<std::string> damping{"body.sand.damping_ratio=0.05", "stage.0.damping_frequencies=[2, 8]"};
  const Ending damped = check(folder, damping), free = check(folder, {});
  ASSERT_EQ(damped.status, 0) << damped.output;
  const double critical = number(damped, "critical_step_s"), omega = 2 / critical, two_pi = 2 * M_PI;
  const double alpha = 2 * 0.05 * two_pi * 2 * 8 / 10, beta = 2 * 0.05 / (two_pi * 10);
  const double ratio = (alpha + beta * omega * omega) / (2 * omega);
  EXPECT_EQ(critical, number(free, "critical_step_s"));
  EXPECT_EQ(number(free, "damped_critical_step_s"), 0);
  const double stable = number(damped, "damped_critical_step_s");
  EXPECT_NEAR(stable / critical, std::sqrt(1 + ratio * ratio) - ratio, 1e-6);
  const Ending page = talus(folder, {"check", "scene.toml", "--set", damping[0], "--set", damping[1]});
  EXPECT_TRUE(page.says("by Rayleigh damping at 2 and 8 Hz")) << page.output;
  std::vector<std::string> fixed = damping;
  fixed.push_back("integrator.step=" + std::to_string(1.01 * stable));
  EXPECT_TRUE(check(folder, fixed).says("less for Rayleigh damping"));
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

/// Implicit pressure pays where water is stiffer than the soil, of M = 1.35 MPa here, and is left where it is refused.
TEST(Check, ChoosesHowPorePressureGoesInTime) {
  const Folder folder;
  folder.write("scene.toml", sound_scene("saturated")), folder.write("section.csv", good_section);
  const auto with = [&](const std::string &one) {
    return talus(folder, {"check", "scene.toml", "--json", "--set", "water.pressure=auto", one});
  };
  const Ending stiff = with("water.bulk_modulus=2.2 GPa"), soft = with("water.bulk_modulus=1 MPa");
  EXPECT_TRUE(stiff.says("pore pressure is implicit in time")) << stiff.output;
  EXPECT_TRUE(soft.says("pore pressure is explicit in time")) << soft.output;
  EXPECT_EQ(number(stiff, "critical_step_s"), number(with("water.pressure=implicit"), "critical_step_s"));
  EXPECT_LT(number(soft, "critical_step_s"), number(stiff, "critical_step_s"));
  EXPECT_TRUE(with("boundary.base.kind=friction").says("boundary.base.kind rubs on the soil after"));
  EXPECT_TRUE(with("boundary.right.kind=non_reflecting").says("pore pressure is implicit in time"));
  EXPECT_TRUE(with("integrator.kind=arkode").says("only with integrator.kind = \\\"euler\\\""));
}

/// A run by the same choice says it in its log, with the iterations of the solves.
TEST(Check, IsFollowedByARunThatSaysHowPressureWasFound) {
  const Folder folder;
  folder.write("scene.toml", sound_scene("saturated")), folder.write("section.csv", good_section);
  const Ending run = talus(folder, {"run", "scene.toml", "--no-pictures", "--set", "water.pressure=auto"});
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_TRUE(run.says("pore pressure is implicit in time")) << run.output;
  EXPECT_TRUE(run.says(" iterations per step and ")) << run.output;
  EXPECT_TRUE(run.says("; 0 of ")) << run.output;
}

TEST(Check, FillsACellOnceThatTwoOfABodysRegionsName) {
  const Folder folder;
  EXPECT_NEAR(number(check(folder, {"body.sand.region=['sand', 'sand']"}), "mass_kg"), 1000, 1e-9);
}

TEST(Check, KnowsStagesByFiniteElements) {
  const Folder folder;
  const Ending ending = check(folder, {"stage.0.kind=quasi_static"});
  EXPECT_EQ(number(ending, "run_time_s"), 0);
  EXPECT_FALSE(ending.says("gravity is applied at once")) << ending.output;
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
    EXPECT_EQ(ending.says("stages add all soil"), !known) << ending.output;
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

TEST(Check, DoubtsABaseThatSlipsBeforeTheLoads) {
  const Folder folder;
  const std::string weakens = "boundary.base={kind='friction', friction_angle='30 - slip'}";
  EXPECT_FALSE(check(folder, {weakens}).says("boundary.base"));
  EXPECT_TRUE(check(folder, {weakens, "stage.0.gravity_ramp=0.01"}).says("counts slip and heat; softening = false"));
  EXPECT_TRUE(check(folder, {"boundary.base={kind='friction', friction_angle='30 - 100 * slip'}"})
                  .says("must be a number from 0 to 89 deg; it is -70 deg at slip = 1 m"));
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
  EXPECT_NEAR(number(whole, "height_m"), 4. / 3 * exact, 4)
      << "twice the mean of a bowl, to a cell; elevations range over 27 m";
  EXPECT_GE(number(whole, "longest_run_time_s"), number(whole, "run_time_s"));
  EXPECT_FALSE(whole.says("downhill"));
  const Ending part = look(20, 12);
  EXPECT_TRUE(part.says("bed.asc has no value at (13")) << part.output;
  EXPECT_TRUE(part.says("That place lies downhill of the soil")) << part.output;
  // so has one of the water table
  folder.write("bed.asc", grid(20, 19, [](double) { return 20; }));
  folder.write("water.asc", grid(20, 12, [](double x) { return 190 - 0.5 * x; }));
  const Ending wet =
      talus(folder, {"check", "scene.toml", "--json", "--set", "phases=drained", "--set", "grids.water=water.asc",
                     "--set", "water.table=water(x, y)", "--set", "body.debris.saturated_unit_weight=21 kN/m3"});
  EXPECT_TRUE(wet.says("water.asc has no value at (13")) << wet.output;
  EXPECT_TRUE(wet.says("That place lies downhill of the soil")) << wet.output;
  EXPECT_FALSE(wet.says("above the ground")) << "ten metres below it, and rims are no ponds: " << wet.output;
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
    EXPECT_TRUE(name == "scene.toml" || name == "section.csv") << name;
  }
}

}  // namespace
}  // namespace talus
