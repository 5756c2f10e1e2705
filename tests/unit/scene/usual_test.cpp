// Values that are allowed and not usual, and doubts that a scene acknowledges.
#include "scene/usual.h"

#include <gtest/gtest.h>

#include <cmath>

#include "complaint.h"
#include "scene/describe.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {
namespace {

/// A scene of one body and two stages: lines 1 to 18.
std::string scene_with(const std::string &top, const std::string &body, const std::string &gravity,
                       const std::string &slide) {
  return top + "\n[mesh]\nfile = \"a.msh\"\n[body.sand]\nregion = \"sand\"\n" + body +
         "\nlaw = \"rigid\"\n[[stage]]\nname = \"gravity\"\nduration = 10\n" + gravity +
         "\n[[stage]]\nname = \"slide\"\nduration = 10\n" + slide + "\n";
}

/// The sentences of all doubts.
std::string doubts(const std::string &text) {
  const Scene scene = parse_scene(text, "slope.toml");
  std::string all;
  for (const auto &[path, doubt] : scene.root->unusual()) all += (all.empty() ? "" : "\n") + doubt.text();
  return all;
}

std::string in_body(const std::string &body) { return doubts(scene_with("", body, "", "")); }
std::string in_slide(const std::string &slide) { return doubts(scene_with("", "density = 2000", "", slide)); }

TEST(Usual, IsSaidOfAValueOutside) {
  EXPECT_EQ(in_slide("damping = 0.1"), "");
  EXPECT_EQ(in_slide("damping = 0.7"),
            "slope.toml line 15: damping = 0.7 in stage \"slide\"; usual 0 to 0.1 [damping]");
  EXPECT_EQ(in_body("density = 2000\nk0 = 10"), "slope.toml line 7: k0 = 10 in body sand; usual 0.2 to 3, or 0 [k0]");
  EXPECT_EQ(doubts(scene_with("gravity = [0, -98.1]", "density = 2000", "", "")),
            "slope.toml line 1: gravity = 98.1 m/s2; usual 9.7 to 10 m/s2 [gravity]")
      << "the magnitude";
  EXPECT_EQ(doubts(scene_with("gravity = 0", "density = 2000", "", "")),
            "slope.toml line 1: gravity = 0 m/s2; usual 9.7 to 10 m/s2 [gravity]");
  EXPECT_EQ(
      doubts(scene_with("phases = \"drained\"\nwater = {viscosity = 1}", "density = 2000\nporosity = 0.3", "", "")),
      "slope.toml line 2: viscosity = 1 Pa s in [water]; usual 2e-4 to 0.002 Pa s [viscosity]");
}

TEST(Usual, DependsOnWhatAStageDoes) {
  const auto gravity = [](const std::string &keys) { return doubts(scene_with("", "density = 2000", keys, "")); };
  EXPECT_NE(gravity("damping = 0.7"), "");
  EXPECT_EQ(gravity("damping = 0.7\nuntil = \"equilibrium\""), "");
  EXPECT_EQ(gravity("damping = 0.7\ngravity_ramp = 2"), "");
  EXPECT_NE(in_slide("damping = 0.9\nuntil = \"equilibrium\""), "");
  const std::string days = scene_with("", "density = 2000", "", "");
  const auto lasting = [&](const std::string &keys) {
    return doubts(std::string(days).replace(days.rfind("duration = 10"), 13, keys));
  };
  EXPECT_EQ(lasting("duration = \"20 h\""), "");
  EXPECT_NE(lasting("duration = \"3 d\"").find("duration = 259200 s in stage \"slide\"; usual 0 to 86400 s"),
            std::string::npos);
  EXPECT_EQ(lasting("duration = \"3 d\"\nkind = \"quasi_static\""), "");
}

TEST(Usual, AsksForTheUnitThatMayHaveBeenMeant) {
  const auto ends = [](const std::string &text, const std::string &end) { EXPECT_TRUE(text.ends_with(end)) << text; };
  ends(in_body("density = 2"), "; usual 800 to 3500 kg/m3; is it in t/m3? [density]");
  ends(in_body("density = \"2 kg/m3\""), "; usual 800 to 3500 kg/m3 [density]");
  ends(in_body("density = 0.01"), "; usual 800 to 3500 kg/m3 [density]");
  ends(doubts(scene_with("gravity = 32.2", "density = 2000", "", "")), "; is it in ft/s2? [gravity]");
  EXPECT_EQ(unit_meant(7, pascal, Usual{20, 1e8}), "kPa");
  EXPECT_EQ(unit_meant(0.47, degree, Usual{5, 50}), "rad");
  EXPECT_EQ(unit_meant(2, metre_per_second, Usual{0, 1e-4}), "mm/h");
}

/// Points of a table are values of their key; the first that is not usual is said.
TEST(Usual, LooksAtTables) {
  const Scene scene =
      parse_scene(scene_with("phases = \"drained\"\nwater = {table = [[0, 1]], excess = [[0, 0], [1, 2e8], [2, 3e8]]}",
                             "density = 2000", "", ""),
                  "slope.toml");
  ASSERT_EQ(scene.root->unusual().count("water.excess"), 1u);
  EXPECT_EQ(scene.root->unusual().at("water.excess").sentence,
            "slope.toml line 2: excess = 2e+08 Pa in [water]; usual -1e7 to 1e7 Pa");
}

struct Table {
  double off = -1, on = 5;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("off", off, one, Range{-1, 10, {1, 2}}, "a key whose default has a meaning of its own");
    v.number("on", on, one, Range{-1, 10, {1, 2, or_zero}}, "a key that 0 turns off");
  }
};

TEST(Usual, IsNotAskedOfADefault) {
  const auto doubted = [](const std::string &text) {
    TableReader reader = TableReader::from_text(text, "a.toml");
    Table table;
    reader.fill(table);
    return reader.unusual().size();
  };
  EXPECT_EQ(doubted(""), 0u);
  EXPECT_EQ(doubted("off = -1\non = 5"), 0u);
  EXPECT_EQ(doubted("off = -0.5\non = 0"), 1u);
  EXPECT_EQ(doubted("on = 2"), 0u);
}

TEST(Acknowledge, KnowsTheNamesOfDoubts) {
  const auto named = [](const std::string &name) {
    return scene_with("acknowledge = [\"" + name + "\"]", "density = 2000", "", "damping = 0.7");
  };
  const Scene scene = parse_scene(named("damping"), "slope.toml");
  EXPECT_TRUE(scene.acknowledges("damping"));
  EXPECT_FALSE(scene.acknowledges("gravity"));
  EXPECT_NO_THROW((void)parse_scene(named("gravity"), "slope.toml")) << "where nothing is doubtful";
  const std::string said = complaint([&] { (void)parse_scene(named("dampin"), "slope.toml"); });
  EXPECT_EQ(said, "slope.toml line 1: acknowledge = [\"dampin\"] names no doubt by dampin; did you mean `damping`?");
}

/// The page of keys shows it beside the range.
TEST(Usual, IsDescribed) {
  Describer describer;
  describe_scene(describer);
  std::ostringstream out;
  describer.print(out, "stage.damping");
  EXPECT_NE(out.str().find("number, 0 to 0.99, usual 0 to 0.1"), std::string::npos) << out.str();
}

}  // namespace
}  // namespace talus
