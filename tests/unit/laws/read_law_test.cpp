#include <gtest/gtest.h>

#include "physics/laws/laws.h"
#include "scene/reader.h"

namespace talus {
namespace {

struct Soil {
  DeferredTable law;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.deferred("law", law, "soil model");
  }
};

Law read(const std::string &text) {
  Soil soil;
  TableReader::from_text(text, "slope.toml").fill(soil);
  return read_law(soil.law);
}

/// What is complained about `text` appended to a sound law.
std::string complaint(const std::string &text) {
  try {
    read(
        "law = \"mohr_coulomb\"\nyoung_modulus = \"10 MPa\"\npoisson_ratio = 0.3\ncohesion = \"5 kPa\"\nfriction_angle "
        "= 30\n" +
        text);
  } catch (const SceneError &error) {
    return error.what();
  }
  return "";
}

TEST(ReadLaw, fills_the_law_that_is_named) {
  const Law law = read(
      "law = \"mohr_coulomb\"\nyoung_modulus = \"10 MPa\"\npoisson_ratio = 0.25\ncohesion = \"20 kPa\"\n"
      "friction_angle = 30\nresidual_cohesion = 0\nshape_factor = 500\nreference_size = \"20 cm\"\n");
  const auto &soil = *law.as<MohrCoulomb>();
  EXPECT_DOUBLE_EQ(soil.young_modulus, 1e7);
  EXPECT_DOUBLE_EQ(soil.cohesion, 2e4);
  EXPECT_DOUBLE_EQ(soil.friction_angle, 30 * degree.si);
  EXPECT_DOUBLE_EQ(soil.reference_size, 0.2);
  EXPECT_EQ(soil.residual_cohesion, 0);
  EXPECT_LT(soil.residual_friction_angle, 0);
  EXPECT_DOUBLE_EQ(constrained_modulus(law), 12e6);
}

TEST(ReadLaw, knows_soil_that_comes_apart) {
  const std::string elastic = "young_modulus = 1e7\npoisson_ratio = 0.3\n";
  for (const char *law : {"drucker_prager", "mohr_coulomb", "hencky_mohr_coulomb"}) {
    const std::string soil = "law = \"" + std::string(law) + "\"\n" + elastic;
    EXPECT_TRUE(comes_apart(read(soil + "cohesion = 0\nfriction_angle = 30\n")));
    EXPECT_TRUE(comes_apart(read(soil + "cohesion = 10\nfriction_angle = 30\n")));
    EXPECT_TRUE(comes_apart(read(soil + "cohesion = 0\nfriction_angle = 0\n")));
    EXPECT_FALSE(comes_apart(read(soil + "cohesion = 10\nfriction_angle = 0\n"))) << "it bears any tension";
  }
  EXPECT_TRUE(
      comes_apart(read("law = \"mohr_coulomb\"\ncohesion = 10\nfriction_angle = 0\ntension_cutoff = 5\n" + elastic)));
  EXPECT_FALSE(comes_apart(read("law = \"linear_elastic\"\n" + elastic)));
}

/// Alonso et al. (2015), Table 3: its B and A go with kPa; without a unit they would be 1000 times too large.
TEST(ReadLaw, takes_rates_per_pressure) {
  const std::string rest =
      "law = \"mohr_coulomb\"\nyoung_modulus = 1e7\npoisson_ratio = 0.3\ncohesion = \"1 kPa\"\nfriction_angle = 23\n"
      "suction_cohesion = \"15 kPa\"\n";
  const Law law = read(rest + "suction_cohesion_rate = \"0.0007 1/kPa\"\nsuction_friction_rate = \"0.0001 deg/kPa\"\n");
  EXPECT_TRUE(reads_suction(law));
  EXPECT_DOUBLE_EQ(law.as<MohrCoulomb>()->suction_cohesion_rate, 7e-7);
  EXPECT_DOUBLE_EQ(law.as<MohrCoulomb>()->suction_friction_rate, 1e-7 * degree.si);
  EXPECT_THROW(read(rest + "suction_cohesion_rate = 0.0007\n"), SceneError);
  EXPECT_THROW(read(rest + "suction_cohesion_rate = \"0.0007 kPa\"\n"), SceneError);
}

/// Each fault is named by file, line, key, value and what is allowed.
TEST(ReadLaw, refuses_bad_parameters_of_every_law) {
  const std::string elastic = "young_modulus = 1e7\npoisson_ratio = 0.3\n",
                    soil = elastic + "cohesion = 5e3\nfriction_angle = 30\n";
  const std::string clay =
      "compression_slope = 0.2\nswelling_slope = 0.04\ncritical_stress_ratio = 1\npoisson_ratio = 0.3\nvoid_ratio = 1\n"
      "preconsolidation_pressure = 1e5\n";
  const std::string grains = elastic + "static_friction = 0.4\nlimiting_friction = 0.6\ngrain_size = 1e-3\n";
  const std::string mud = elastic + "viscosity = 10\nyield_stress = 100\n";
  struct Fault {
    std::string law, keys, from, to;
    std::vector<std::string> words;
  };
  std::vector<Fault> faults;
  for (const char *law : {"mohr_coulomb", "drucker_prager", "hencky_mohr_coulomb", "hencky_drucker_prager"}) {
    faults.push_back({law, soil, "cohesion = 5e3", "cohesion = -1", {"line 4: cohesion = -1", "0 to 1e9 Pa"}});
    faults.push_back({law, soil, "cohesion = 5e3", "cohesion = nan", {"line 4: cohesion = nan", "0 to 1e9 Pa"}});
    faults.push_back(
        {law, soil, "friction_angle = 30", "friction_angle = 90", {"line 5: friction_angle = 90", "0 to 70 deg"}});
    faults.push_back({law,
                      soil,
                      "friction_angle = 30",
                      "friction_angle = 30\ndilation_angle = 31",
                      {"line 6: dilation_angle = 31 must not exceed friction_angle, 30 deg"}});
    faults.push_back({law,
                      soil,
                      "friction_angle = 30",
                      "friction_angle = 30\nresidual_cohesion = 6e3\nshape_factor = 1",
                      {"line 6: residual_cohesion = 6000 must not exceed cohesion, 5000 Pa"}});
    faults.push_back({law,
                      soil,
                      "friction_angle = 30",
                      "friction_angle = 30\nresidual_friction_angle = 31\nshape_factor = 1",
                      {"line 6: residual_friction_angle = 31 must not exceed friction_angle, 30 deg"}});
    faults.push_back({law,
                      soil,
                      "friction_angle = 30",
                      "friction_angle = 30\nresidual_dilation_angle = 1\nshape_factor = 1",
                      {"line 6: residual_dilation_angle = 1 must not exceed dilation_angle, 0 deg"}});
    faults.push_back({law,
                      soil,
                      "friction_angle = 30",
                      "friction_angle = 30\nresidual_cohesion = 0",
                      {"needs a shape_factor above 0"}});
    faults.push_back({law,
                      soil,
                      "friction_angle = 30",
                      "friction_angle = 30\nshape_factor = -1",
                      {"line 6: shape_factor = -1", "0 to 1e6"}});
  }
  for (const char *law : {"linear_elastic", "mohr_coulomb", "drucker_prager", "mu_i", "newtonian", "bingham",
                          "hencky_elastic", "hencky_mohr_coulomb", "hencky_drucker_prager"}) {
    const std::string keys = law == std::string("mu_i")              ? grains
                             : law == std::string("newtonian")       ? elastic + "viscosity = 10\n"
                             : law == std::string("bingham")         ? mud
                             : std::string(law).ends_with("elastic") ? elastic
                                                                     : soil;
    faults.push_back(
        {law, keys, "poisson_ratio = 0.3", "poisson_ratio = 0.5", {"line 3: poisson_ratio = 0.5", "below 0.5"}});
    faults.push_back(
        {law, keys, "poisson_ratio = 0.3", "poisson_ratio = 0.6", {"line 3: poisson_ratio = 0.6", "-1 to 0.5"}});
    faults.push_back({law, keys, "young_modulus = 1e7", "young_modulus = 0", {"line 2: young_modulus = 0", "Pa"}});
  }
  faults.push_back({"mohr_coulomb",
                    soil,
                    "friction_angle = 30",
                    "friction_angle = 30\ntension_cutoff = -2",
                    {"line 6: tension_cutoff = -2"}});
  faults.push_back({"drucker_prager",
                    soil,
                    "friction_angle = 30",
                    "friction_angle = 30\ncone = \"outter\"",
                    {"line 6: cone", "did you mean `outer`?"}});
  faults.push_back({"cam_clay",
                    clay,
                    "compression_slope = 0.2",
                    "compression_slope = 0.04",
                    {"line 2: compression_slope = 0.04 must exceed swelling_slope, 0.04"}});
  faults.push_back(
      {"cam_clay", clay, "poisson_ratio = 0.3", "poisson_ratio = 0.5", {"line 5: poisson_ratio = 0.5", "0 to 0.49"}});
  faults.push_back(
      {"cam_clay", clay, "swelling_slope = 0.04", "swelling_slope = 0", {"line 3: swelling_slope = 0", "1e-5 to 10"}});
  faults.push_back({"cam_clay",
                    clay,
                    "critical_stress_ratio = 1",
                    "critical_stress_ratio = 0",
                    {"line 4: critical_stress_ratio = 0"}});
  faults.push_back({"cam_clay", clay, "void_ratio = 1", "void_ratio = -1", {"line 6: void_ratio = -1", "0.01 to 20"}});
  faults.push_back({"cam_clay",
                    clay,
                    "preconsolidation_pressure = 1e5",
                    "preconsolidation_pressure = 0",
                    {"line 7: preconsolidation_pressure = 0"}});
  faults.push_back({"mu_i",
                    grains,
                    "limiting_friction = 0.6",
                    "limiting_friction = 0.3",
                    {"line 5: limiting_friction = 0.3 must not be below static_friction, 0.4"}});
  faults.push_back({"mu_i", grains, "grain_size = 1e-3", "grain_size = 0", {"line 6: grain_size = 0", "m"}});
  faults.push_back({"newtonian",
                    elastic + "viscosity = 10\n",
                    "viscosity = 10",
                    "viscosity = 0",
                    {"line 4: viscosity = 0", "Pa s"}});
  faults.push_back(
      {"bingham", mud, "yield_stress = 100", "yield_stress = -1", {"line 5: yield_stress = -1", "0 to 1e9 Pa"}});
  for (const Fault &fault : faults) {
    std::string keys = fault.keys;
    const std::string sound = "law = \"" + fault.law + "\"\n" + keys;
    EXPECT_NO_THROW(read(sound)) << sound;
    keys.replace(keys.find(fault.from), fault.from.size(), fault.to);
    std::string said = "nothing";
    try {
      read("law = \"" + fault.law + "\"\n" + keys);
    } catch (const SceneError &error) {
      said = error.what();
    }
    EXPECT_NE(said.find("slope.toml"), std::string::npos) << said;
    for (const std::string &word : fault.words)
      EXPECT_NE(said.find(word), std::string::npos) << fault.law << ": " << said << "\nlacks " << word;
  }
}

TEST(ReadLaw, complains_about_parameters_that_contradict_each_other) {
  EXPECT_EQ(complaint(""), "");
  EXPECT_NE(complaint("dilation_angle = 31").find("dilation_angle = 31 must not exceed"), std::string::npos);
  EXPECT_NE(complaint("residual_cohesion = \"6 kPa\"\nshape_factor = 1").find("residual_cohesion = \"6 kPa\" must not"),
            std::string::npos);
  EXPECT_NE(complaint("residual_friction_angle = 31\nshape_factor = 1").find("residual_friction_angle = 31 must not"),
            std::string::npos);
  EXPECT_NE(complaint("residual_cohesion = 0").find("shape_factor"), std::string::npos);
  EXPECT_NE(complaint("residual_dilation_angle = 1\nshape_factor = 1").find("residual_dilation_angle = 1 must not"),
            std::string::npos);
  EXPECT_NE(complaint("suction_cohesion = \"15 kPa\"").find("go together"), std::string::npos);
  EXPECT_NE(complaint("cohesionn = 0").find("cohesionn"), std::string::npos);
}

}  // namespace
}  // namespace talus
