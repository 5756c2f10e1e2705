// Pores as scenes write them, and what is complained about.
#include <gtest/gtest.h>

#include "fixtures.h"
#include "scene/reader.h"

namespace talus {
namespace {

std::string complaint(const std::string &text) {
  try {
    soil_of(text);
  } catch (const SceneError &error) {
    return error.what();
  }
  return "";
}
void expect(const std::string &text, const std::vector<std::string> &words) {
  for (const std::string &word : words) EXPECT_NE(complaint(text).find(word), std::string::npos) << complaint(text);
}

TEST(ReadPores, takes_permeability_or_conductivity) {
  EXPECT_NEAR(soil_of("permeability = \"1e-12 m2\"").permeability(), 1e-12, 1e-26);
  EXPECT_NEAR(soil_of("hydraulic_conductivity = \"1e-5 m/s\"").permeability(), 1e-12, 1e-26);
  EXPECT_EQ(soil_of("permeability = 1e-12").gas_permeability(), 1e-12);
  EXPECT_EQ(soil_of("permeability = 1e-12\ngas_permeability = 1e-11").gas_permeability(), 1e-11);
}

TEST(ReadPores, refuses_a_conductivity_as_permeability) {
  expect("permeability = \"1e-5 m/s\"", {"slope.toml line 3", "permeability", "hydraulic_conductivity", "m2"});
  expect("hydraulic_conductivity = \"1e-12 m2\"", {"permeability", "m/s"});
}

TEST(ReadPores, refuses_curves_that_are_none) {
  const std::string table = "[retention]\ncurve = \"tabulated\"\n";
  expect(table + "suctions = [0, 1e3, 2e3]\nsaturations = [1, 0.5, 0.6]\n", {"line 3", "monotone", "point 3"});
  expect(table + "suctions = [0, 2e3, 1e3]\nsaturations = [1, 0.5, 0.4]\n", {"monotone", "point 3"});
  expect(table + "suctions = [0, 1e3]\nsaturations = [0.9, 0.4]\n", {"first point must be saturated"});
  expect(table + "suctions = [0, 1e3]\nsaturations = [1]\n", {"as many"});
  expect("[retention]\ncurve = \"van_genuchten\"\nreference_suction = 1e3\nshape = 1.5\n", {"shape", "0.95"});
  expect("[retention]\ncurve = \"van_genuchten\"\nreference_suction = \"1 m\"\nshape = 0.5\n", {"reference_suction"});
  expect("[retention]\ncurve = \"van_genuchten\"\nreference_suction = 1e3\nshape = 0.5\nresidual_saturation = 1.2\n",
         {"residual_saturation", "0.9"});
  expect("[retention]\ncurve = \"van_gnuchten\"\n", {"did you mean `van_genuchten`"});
}

}  // namespace
}  // namespace talus
