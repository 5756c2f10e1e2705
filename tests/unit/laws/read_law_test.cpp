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
  const auto &soil = std::get<MohrCoulomb>(law);
  EXPECT_DOUBLE_EQ(soil.young_modulus, 1e7);
  EXPECT_DOUBLE_EQ(soil.cohesion, 2e4);
  EXPECT_DOUBLE_EQ(soil.friction_angle, 30 * degree.si);
  EXPECT_DOUBLE_EQ(soil.reference_size, 0.2);
  EXPECT_EQ(soil.residual_cohesion, 0);
  EXPECT_LT(soil.residual_friction_angle, 0);
  EXPECT_FALSE(cohesionless(law));
  EXPECT_DOUBLE_EQ(constrained_modulus(law), 12e6);
}

TEST(ReadLaw, knows_cohesionless_soil) {
  const std::string rest = "young_modulus = 1e7\npoisson_ratio = 0.3\ncohesion = 0\nfriction_angle = 30\n";
  EXPECT_TRUE(cohesionless(read("law = \"drucker_prager\"\ncone = \"inner\"\n" + rest)));
  EXPECT_TRUE(cohesionless(read("law = \"mohr_coulomb\"\n" + rest)));
  EXPECT_FALSE(cohesionless(read("law = \"linear_elastic\"\nyoung_modulus = 1e7\npoisson_ratio = 0.3\n")));
}

/// Alonso et al. (2015), Table 3: its B and A go with kPa; without a unit they would be 1000 times too large.
TEST(ReadLaw, takes_rates_per_pressure) {
  const std::string rest =
      "law = \"mohr_coulomb\"\nyoung_modulus = 1e7\npoisson_ratio = 0.3\ncohesion = \"1 kPa\"\nfriction_angle = 23\n"
      "suction_cohesion = \"15 kPa\"\n";
  const Law law = read(rest + "suction_cohesion_rate = \"0.0007 1/kPa\"\nsuction_friction_rate = \"0.0001 deg/kPa\"\n");
  EXPECT_TRUE(reads_suction(law));
  EXPECT_DOUBLE_EQ(std::get<MohrCoulomb>(law).suction_cohesion_rate, 7e-7);
  EXPECT_DOUBLE_EQ(std::get<MohrCoulomb>(law).suction_friction_rate, 1e-7 * degree.si);
  EXPECT_THROW(read(rest + "suction_cohesion_rate = 0.0007\n"), SceneError);
  EXPECT_THROW(read(rest + "suction_cohesion_rate = \"0.0007 kPa\"\n"), SceneError);
}

TEST(ReadLaw, complains_about_parameters_that_contradict_each_other) {
  EXPECT_EQ(complaint(""), "");
  EXPECT_NE(complaint("dilation_angle = 31").find("dilation_angle must not exceed"), std::string::npos);
  EXPECT_NE(complaint("residual_cohesion = \"6 kPa\"\nshape_factor = 1").find("residual_cohesion must not"),
            std::string::npos);
  EXPECT_NE(complaint("residual_friction_angle = 31\nshape_factor = 1").find("residual_friction_angle must not"),
            std::string::npos);
  EXPECT_NE(complaint("residual_cohesion = 0").find("shape_factor"), std::string::npos);
  EXPECT_NE(complaint("residual_dilation_angle = 1\nshape_factor = 1").find("residual_dilation_angle must not"), std::string::npos);
  EXPECT_NE(complaint("suction_cohesion = \"15 kPa\"").find("go together"), std::string::npos);
  EXPECT_NE(complaint("cohesionn = 0").find("cohesionn"), std::string::npos);
}

}  // namespace
}  // namespace talus
