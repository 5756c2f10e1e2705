// The library of materials: every material is a valid soil, and the scene has precedence key by key.
#include "scene/materials.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "physics/laws/frictional_strength.h"
#include "physics/laws/law.h"
#include "physics/pores/retention.h"
#include "scene/body_source.h"
#include "scene/describe.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {
namespace {

/// A scene whose body has these lines.
Scene with(const std::string &body, const std::vector<std::string> &overrides = {}) {
  return parse_scene("gravity = 9.81\n[mesh]\nfile = \"slope.msh\"\n[body.soil]\nregion = \"hill\"\n" + body +
                         "\n[[stage]]\nname = \"fall\"\nduration = 1\n",
                     "slope.toml", overrides);
}

std::string complaint_about(const std::string &body) {
  try {
    read_law(with(body).body[0].law);
  } catch (const SceneError &error) {
    return error.what();
  }
  return "";
}

TEST(Materials, AreAllValid) {
  for (const Material &one : soils()) {
    const Scene scene = with(std::string("material = \"") + one.name + "\"");
    const Law law = read_law(scene.body[0].law);
    EXPECT_STREQ(law_name(law), "mohr_coulomb") << one.name;
    EXPECT_EQ(law_problem(law, 2), "") << one.name;
    EXPECT_TRUE(scene.body[0].porosity > 0.2 || scene.body[0].density > 1700) << one.name;
    for (const MaterialKey &key : one.keys) EXPECT_TRUE(*key.source || key.key == std::string("law")) << key.key;
  }
  for (const Material &one : retention_curves()) {
    const Scene scene =
        with(std::string("material = \"silt\"\n[body.soil.retention]\nmaterial = \"") + one.name + "\"");
    Retention curve;
    read_one_of(scene.body[0].retention, "curve", curve);
    EXPECT_TRUE(std::holds_alternative<VanGenuchten>(curve)) << one.name;
  }
}

// loam: alpha = 0.036 1/cm, n = 1.56, theta_r = 0.078 of 0.43; P_0 = 9.81 kN/m3 / 3.6 1/m
TEST(Materials, ConvertVanGenuchtensParameters) {
  const Scene scene = with("material = \"silt\"\n[body.soil.retention]\nmaterial = \"loam\"\nshape = 0.4");
  Retention curve;
  read_one_of(scene.body[0].retention, "curve", curve);
  const auto loam = std::get<VanGenuchten>(curve);
  EXPECT_NEAR(loam.reference_suction, 9810 / 3.6, 1);
  EXPECT_NEAR(loam.residual_saturation, 0.078 / 0.43, 1e-3);
  EXPECT_EQ(loam.shape, 0.4) << "the scene has precedence";
}

TEST(Materials, GiveWayToTheScene) {
  const auto friction = [](const Scene &scene) {
    return frictional_strength(read_law(scene.body[0].law))->friction_angle * 180 / std::numbers::pi;
  };
  EXPECT_NEAR(friction(with("material = \"loose_sand\"")), 32, 1e-9);
  EXPECT_NEAR(friction(with("material = \"loose_sand\"\nfriction_angle = 29")), 29, 1e-9);
  EXPECT_NEAR(friction(with("material = \"loose_sand\"", {"body.soil.material=dense_sand"})), 42, 1e-9);
  const BodySource heavy = with("material = \"loose_sand\"\ndensity = 1900").body[0];
  EXPECT_EQ(heavy.density, 1900);
  EXPECT_EQ(heavy.porosity, 0) << "a density excludes porosity and grain density";
  EXPECT_EQ(complaint_about("material = \"loose_sand\"\nshear_modulus = 1e6\npoisson_ratio = 0.2"), "");
}

TEST(Materials, AreRefusedWithTheNearestName) {
  EXPECT_EQ(complaint_about("material = \"lose_sand\"").substr(0, 74),
            "slope.toml line 6: body.soil.material = \"lose_sand\" (name of the library o");
  EXPECT_NE(complaint_about("material = \"lose_sand\"").find("did you mean `loose_sand`?"), std::string::npos);
  EXPECT_NE(complaint_about("material = 3").find("must be one of loose_sand"), std::string::npos);
  EXPECT_NE(complaint_about("material = \"silt\"\nlaw = \"linear_elastic\"").find("leave one of them out"),
            std::string::npos);
}

TEST(Materials, AreDescribed) {
  Describer describer;
  describe_materials(describer);
  std::ostringstream text;
  describer.print(text, "soft_clay");
  EXPECT_NE(text.str().find("12.5 to 25 kPa"), std::string::npos) << text.str();
  EXPECT_NE(text.str().find("Terzaghi & Peck (1967)"), std::string::npos) << text.str();
}

}  // namespace
}  // namespace talus
