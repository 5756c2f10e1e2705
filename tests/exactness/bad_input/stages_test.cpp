// What stages and functions of time refuse, some of it in the middle of a run.
#include <gtest/gtest.h>

#include "scene.h"

namespace talus {
namespace {

constexpr const char *dry_part =
    "[mesh]\nsection = \"section.csv\"\nsize = 0.25\n[body.sand]\nregion = \"sand\"\ndensity = 2000";
constexpr const char *wet_part =
    "[mesh]\nsection = \"section.csv\"\nsize = 0.25\n[water]\ntable = [[0, 0.5], [2, 0.5]]\n[body.sand]\nregion = "
    "\"sand\"\n"
    "porosity = 0.4\ngrain_density = 2600\npermeability = 1e-10";

/// A drained scene with a seepage stage, and what does not go with it.
TEST(Seepage, OfDrainedSoilIsChecked) {
  const Folder folder;
  folder.write("section.csv", good_section);
  const std::string wet =
      changed(changed(changed(good_scene, dry_part, wet_part), "gravity", "phases = \"drained\"\ngravity"),
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
  const std::string wet = changed(changed(good_scene, dry_part, wet_part), "gravity", "phases = \"drained\"\ngravity");
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

}  // namespace
}  // namespace talus
