#include "scene/describe.h"

#include <gtest/gtest.h>

#include <sstream>

#include "complaint.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {
namespace {

struct Soft {
  static constexpr const char *name = "soft";
  static constexpr const char *meaning = "a soft soil";
  double young_modulus = 0, poisson_ratio = 0, friction_angle = degree.si * 30;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.elasticity(young_modulus, poisson_ratio);
    v.number("friction_angle", friction_angle, degree, Range{0, 60}, "friction angle phi");
  }
};
struct Rigid {
  static constexpr const char *name = "rigid";
  template <class Visitor>
  void fields(Visitor &&) {}
};

Describer everything() {
  Describer describer;
  describe_scene(describer);
  describe_one_of<std::variant<Soft, Rigid>>(describer, "body.NAME", "law");
  return describer;
}

std::string printed(const std::string &key) {
  std::ostringstream out;
  everything().print(out, key);
  return out.str();
}

TEST(Describe, GivesEveryKeyAMeaningAndWhatIsAllowed) {
  const Describer describer = everything();
  int count = 0;
  for (const Describer::Block &block : describer.blocks())
    for (const Describer::Key &key : block.keys) {
      EXPECT_NE(key.meaning, "") << key.path;
      EXPECT_NE(key.allowed, "") << key.path;
      ++count;
    }
  EXPECT_GT(count, 60);
}

/// A file with the one key, whose value is of a type that no key takes (a date).
std::string file_with(const std::string &path) {
  std::vector<std::string> words;
  std::istringstream stream(path);
  for (std::string word; std::getline(stream, word, '.');) words.push_back(word);
  std::string value = "1979-05-27";
  for (std::size_t i = words.size(); i-- > 1;)
    value = words[i] == "N" ? "[" + value + "]" : "{" + words[i] + " = " + value + "}";
  return words[0] + " = " + value;
}

TEST(Describe, ListsOnlyKeysThatTheReaderKnows) {
  Describer describer;
  describe_scene(describer);
  for (const Describer::Block &block : describer.blocks())
    for (const Describer::Key &key : block.keys) {
      const std::string text = complaint([&] { parse_scene(file_with(key.path), "scene.toml"); });
      EXPECT_NE(text, "") << key.path;
      EXPECT_FALSE(contains(text, "is no known key")) << key.path << ": " << text;
    }
}

TEST(Describe, ShowsUnitRangeDefaultAndMeaning) {
  const std::string text = printed("stage.damping");
  EXPECT_TRUE(contains(text, "## [[stage]]")) << text;
  EXPECT_TRUE(contains(text, "number, 0 to 0.99")) << text;
  EXPECT_TRUE(contains(text, "local (Cundall) damping factor")) << text;
  EXPECT_TRUE(contains(printed("stage.duration"), "s, 0 to 1e12, usual 0 to 86400 | required"))
      << printed("stage.duration");
  EXPECT_TRUE(contains(printed("transfer.velocity"), "flip, pic | flip")) << printed("transfer.velocity");
}

TEST(Describe, ShowsAnglesInDegrees) { EXPECT_TRUE(contains(printed("friction_angle"), "| deg, 0 to 60 | 30 ")); }

TEST(Describe, FindsKeysByPathByLastWordAndByKind) {
  EXPECT_TRUE(contains(printed("body.density"), "total density"));
  EXPECT_TRUE(contains(printed("body.sand.density"), "total density"));
  EXPECT_FALSE(contains(printed("body.density"), "porosity n"));
  EXPECT_TRUE(contains(printed("density"), "density of the pore water"));
  EXPECT_TRUE(contains(printed("body"), "[[body.NAME.dense]]"));
  EXPECT_TRUE(contains(printed("soft"), "shear_modulus"));
  EXPECT_TRUE(contains(printed("law"), "\"soft\" |         | a soft soil"));
  EXPECT_TRUE(contains(printed("law"), "\"rigid\""));
  EXPECT_FALSE(contains(printed("law"), "shear_modulus"));
}

TEST(Describe, SuggestsTheNearestKey) {
  EXPECT_EQ(complaint([] { printed("porosty"); }), "no key `porosty` is known; did you mean `porosity`?");
  EXPECT_EQ(complaint([] { printed("stage.duratin"); }),
            "no key `stage.duratin` is known; did you mean `stage.duration`?");
  EXPECT_EQ(complaint([] { printed("qwertz"); }), "no key `qwertz` is known; `talus describe` prints them all");
}

}  // namespace
}  // namespace talus
