#include "scene/reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "complaint.h"

namespace talus {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

enum class Colour { red, green };

struct Grain {
  std::string name;
  double size = nan;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("size", size, metre, Range{0, 1}, "size of a grain");
  }
};

struct Strict {
  template <class Visitor>
  void fields(Visitor &&) {}
  std::string problem() const { return "always wrong"; }
};

/// One key of every sort.
struct Toy {
  double cohesion = 7, friction_angle = 0;
  int count = 1;
  bool wet = false;
  std::string title;
  std::vector<std::string> region;
  Colour colour = Colour::red;
  std::vector<double> place;
  std::vector<std::vector<double>> line;
  Function load, angle;
  std::vector<Function> velocity;
  Grain grain{"", 0.5};
  std::vector<Grain> sort, layer;
  Strict strict;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("cohesion", cohesion, pascal, Range{0, 1e9}, "cohesion c");
    v.number("friction_angle", friction_angle, degree, Range{0, 60}, "friction angle phi");
    v.integer("count", count, Range{1, 8}, "number of things");
    v.flag("wet", wet, "is it wet");
    v.text("title", title, "what it is");
    v.texts("region", region, "where it is");
    v.choice("colour", colour, {{"red", Colour::red}, {"green", Colour::green}}, "colour of it");
    v.point("place", place, metre, "place of it");
    v.points("line", line, metre, "line through it");
    v.function("load", load, pascal, Range{-1e6, 1e6}, of::place_and_time, "load on it");
    v.function("angle", angle, degree, Range{-90, 90}, of::time, "angle of it");
    v.functions("velocity", velocity, metre_per_second, of::place, "velocity of it");
    v.table("grain", grain, "grain of it");
    v.named("sort", sort, "sorts of it");
    v.list("layer", layer, "layers of it");
    v.table("strict", strict, "a table that is always wrong");
  }
};

Toy read(const std::string &text, const std::vector<std::string> &overrides = {}) {
  Toy toy;
  TableReader::from_text(text, "toy.toml", overrides).fill(toy);
  return toy;
}

std::string refusal(const std::string &text, const std::vector<std::string> &overrides = {}) {
  return complaint([&] { read(text, overrides); });
}

TEST(TableReader, LeavesDefaultsWhereKeysAreAbsent) {
  const Toy toy = read("");
  EXPECT_EQ(toy.cohesion, 7);
  EXPECT_EQ(toy.grain.size, 0.5);
  EXPECT_FALSE(toy.load.given());
}

TEST(TableReader, StoresSIAndRadians) {
  const Toy toy = read("cohesion = '5 kPa'\nfriction_angle = 30\n");
  EXPECT_EQ(toy.cohesion, 5e3);
  EXPECT_DOUBLE_EQ(toy.friction_angle, M_PI / 6);
}

TEST(TableReader, ReadsEverySortOfKey) {
  const Toy toy = read(R"(
count = 3
wet = true
title = "a hill"
region = ["crest", "toe"]
colour = "green"
place = [1, "2 km"]
line = [[0, 1], ["10 cm", 3]]
velocity = [1, "2 * x"]
grain = {size = "2 mm"}
[sort.sand]
size = 0.001
[sort.gravel]
size = 0.01
[[layer]]
size = 0.1
[[layer]]
size = 0.2
)");
  EXPECT_EQ(toy.count, 3);
  EXPECT_TRUE(toy.wet);
  EXPECT_EQ(toy.title, "a hill");
  EXPECT_EQ(toy.region, (std::vector<std::string>{"crest", "toe"}));
  EXPECT_EQ(toy.colour, Colour::green);
  EXPECT_EQ(toy.place, (std::vector<double>{1, 2000}));
  EXPECT_EQ(toy.line, (std::vector<std::vector<double>>{{0, 1}, {0.1, 3}}));
  ASSERT_EQ(toy.velocity.size(), 2u);
  EXPECT_EQ(toy.velocity[1](4, 0, 0, 0), 8);
  EXPECT_EQ(toy.grain.size, 2e-3);
  ASSERT_EQ(toy.layer.size(), 2u);
  EXPECT_EQ(toy.layer[1].size, 0.2);
}

TEST(TableReader, KeepsNamedTablesInTheOrderOfTheFile) {
  const Toy toy = read("[sort.sand]\nsize = 0.1\n[sort.gravel]\nsize = 0.2\n[sort.clay]\nsize = 0.3\n");
  ASSERT_EQ(toy.sort.size(), 3u);
  EXPECT_EQ(toy.sort[0].name, "sand");
  EXPECT_EQ(toy.sort[1].name, "gravel");
  EXPECT_EQ(toy.sort[2].name, "clay");
}

TEST(TableReader, TakesASingleValueForAList) {
  const Toy toy = read("region = 'crest'\nplace = '3 m'\nvelocity = 2\n");
  EXPECT_EQ(toy.region, std::vector<std::string>{"crest"});
  EXPECT_EQ(toy.place, std::vector<double>{3});
  ASSERT_EQ(toy.velocity.size(), 1u);
  EXPECT_EQ(toy.velocity[0](0), 2);
}

TEST(TableReader, NamesFileLineKeyValueMeaningRangeAndUnit) {
  EXPECT_EQ(refusal("\n\nfriction_angle = 95\n"),
            "toy.toml line 3: friction_angle = 95 (friction angle phi) must be a number from 0 to 60 deg");
  EXPECT_EQ(refusal("[sort.sand]\nsize = '3 m'\n"),
            "toy.toml line 2: sort.sand.size = \"3 m\" (size of a grain) must be a number from 0 to 1 m");
  EXPECT_EQ(refusal("[[layer]]\nsize = 0\n[[layer]]\nsize = 2"),
            "toy.toml line 4: layer.1.size = 2 (size of a grain) must be a number from 0 to 1 m");
}

TEST(TableReader, IncludesTheEndsOfARange) {
  EXPECT_DOUBLE_EQ(read("friction_angle = '60 deg'").friction_angle, M_PI / 3);
  EXPECT_EQ(read("cohesion = '1 GPa'").cohesion, 1e9);
  EXPECT_NE(refusal("friction_angle = 60.001"), "");
}

TEST(TableReader, SaysWhyAUnitDoesNotFit) {
  EXPECT_EQ(
      refusal("cohesion = '5 m'"),
      "toy.toml line 1: cohesion = \"5 m\" (cohesion c) must be a number from 0 to 1e9 Pa; its unit must measure the "
      "same as Pa");
}

TEST(TableReader, RefusesNumbersThatAreNotFinite) {
  for (const char *value : {"nan", "inf", "-inf", "'nan'", "'inf'"}) {
    EXPECT_NE(refusal(std::string("cohesion = ") + value), "") << value;
    EXPECT_NE(refusal(std::string("place = ") + value), "") << value;
    EXPECT_NE(refusal(std::string("load = ") + value), "") << value;
  }
}

TEST(TableReader, RefusesAWrongTypeAndSaysWhatWasExpected) {
  const struct {
    const char *text, *expected;
  } table[] = {
      {"cohesion = true", "must be a number from 0 to 1e9 Pa"},
      {"cohesion = [1]", "must be a number from 0 to 1e9 Pa"},
      {"cohesion = 1979-05-27", "must be a number from 0 to 1e9 Pa"},
      {"count = 1.5", "must be a whole number from 1 to 8"},
      {"count = 9", "must be a whole number from 1 to 8"},
      {"count = '3'", "must be a whole number from 1 to 8"},
      {"wet = 1", "must be true or false"},
      {"title = 1", "must be a text in quotes"},
      {"region = [1]", "region.0 = 1 (where it is) must be a text in quotes or a list of texts"},
      {"colour = 1", "must be one of red, green"},
      {"place = 'here'", "must be a number in m"},
      {"line = 1", "must be a list of points"},
      {"line = [1, 2]", "must be a point, a list of coordinates"},
      {"load = true", "a list of [t, value] points or an expression"},
      {"load = [1, 2]", "a list of [t, value] points or an expression"},
      {"load = [[1, 2, 3]]", "must be a point [t, value]"},
      {"grain = 1", "must be a table, [grain]"},
      {"sort = 1", "must be a table, [sort]"},
      {"sort.sand = 1", "must be a table with a name of your choice, [sort.NAME]"},
      {"layer = 1", "must be a list of tables, [[layer]]"},
      {"[layer]\nsize = 1", "must be a list of tables, [[layer]]"},
  };
  for (const auto &[text, expected] : table)
    EXPECT_TRUE(contains(refusal(text), expected)) << text << ": " << refusal(text);
}

TEST(TableReader, RefusesAnUnknownChoiceAndSuggestsTheNearest) {
  EXPECT_EQ(refusal("colour = 'gren'"),
            "toy.toml line 1: colour = \"gren\" (colour of it) must be one of red, green; did you mean `green`?");
}

TEST(TableReader, RefusesAnUnknownKeyAndSuggestsTheNearest) {
  EXPECT_EQ(refusal("cohesion = 1\nfrction_angle = 3"),
            "toy.toml line 2: frction_angle is no known key; did you mean `friction_angle`?");
  EXPECT_EQ(refusal("[grain]\nsize = 1\nweight = 3"), "toy.toml line 3: grain.weight is no known key; known are size");
}

TEST(TableReader, RefusesAMissingRequiredKey) {
  EXPECT_EQ(refusal("count = 1\n[sort.sand]\n"),
            "toy.toml line 2: sort.sand needs size (size of a grain), a number from 0 to 1 m");
}

TEST(TableReader, RefusesIntegersThatADoubleRounds) {
  EXPECT_TRUE(contains(refusal("cohesion = 9007199254740993"), "must be a number from 0 to 1e9 Pa"));
}

TEST(TableReader, RefusesMalformedToml) {
  EXPECT_TRUE(contains(refusal("count = 1\ncohesion = = 2\n"), "toy.toml line 2: "));
  EXPECT_TRUE(contains(refusal("count = 1\ncount = 2\n"), "toy.toml line 2: "));
}

TEST(TableReader, SaysWhichFileCannotBeRead) {
  EXPECT_EQ(complaint([] { TableReader::from_file("no/such.toml"); }),
            "cannot read no/such.toml: No such file or directory");
  EXPECT_EQ(complaint([] { TableReader::from_file("/"); }), "cannot read /: it is a directory");
}

// ---- functions ----

/// Reading the memory of a process from address 0 is an input/output error, though the file can be opened.
TEST(TableReader, SaysThatReadingFailedHalfWay) {
  EXPECT_TRUE(
      contains(complaint([] { (void)read_text("/proc/self/mem"); }), "cannot read /proc/self/mem: Input/output"));
}

TEST(TableReader, ReadsAFunctionAsQuantityTableOrExpression) {
  EXPECT_EQ(read("load = '5 kPa'").load(0), 5e3);
  EXPECT_EQ(read("load = [[0, 0], ['1 min', '2 kPa']]").load(30), 1e3);
  EXPECT_EQ(read("load = '2 * x + t'").load(3, 0, 0, 1), 7);
}

TEST(TableReader, ScalesAnExpressionByTheUnitOfItsKey) {
  EXPECT_DOUBLE_EQ(read("angle = '30 * t'").angle(1), M_PI / 6);
  EXPECT_DOUBLE_EQ(read("angle = [[0, 30]]").angle(1), M_PI / 6);
}

TEST(TableReader, ChecksNumbersAndTablesOfAFunctionAgainstItsRange) {
  EXPECT_TRUE(contains(refusal("load = '2 MPa'"), "must be a number from -1e6 to 1e6 Pa"));
  EXPECT_TRUE(contains(refusal("load = [[0, 0],\n[1, 2e6]]"), "toy.toml line 2: load.1.1 = 2e6"));
  EXPECT_TRUE(contains(refusal("load = [[0, 0], [0, 1]]"), "the times of a table must rise"));
}

TEST(TableReader, RefusesVariablesThatAKeyDoesNotKnow) {
  EXPECT_TRUE(
      contains(refusal("count = 1\nangle = 'x + t'"),
               "toy.toml line 2: angle = \"x + t\" (angle of it) must be a number from -90 to 90 deg, a list of "
               "[t, value] points or an expression of t; it cannot depend on x"));
  EXPECT_TRUE(contains(refusal("velocity = ['t', '0']"), "an expression of x, y, z; it cannot depend on t"));
  EXPECT_TRUE(contains(refusal("velocity = [[[0, 1], [1, 2]]]"), "must be a number in m/s or an expression"));
  EXPECT_TRUE(contains(refusal("load = 'table'"), "it cannot depend on table"));
}

TEST(TableReader, KeepsTheFirstValueOfAFunctionThatItsKeyDoesNotAdmit) {
  const auto after = [](const std::string &text, auto &&evaluate) {
    Toy toy;
    TableReader reader = TableReader::from_text(text, "toy.toml");
    reader.fill(toy);
    evaluate(toy);
    return reader.function_fault();
  };
  EXPECT_EQ(after("angle = '100 * t'", [](const Toy &toy) { toy.angle(0.9), toy.angle(-0.9); }), "");
  EXPECT_EQ(after("count = 1\nangle = '100 * t'", [](const Toy &toy) { toy.angle(0.5), toy.angle(1), toy.angle(2); }),
            "toy.toml line 2: angle = \"100 * t\" must be a number from -90 to 90 deg; it is 100 deg at t = 1 s");
  EXPECT_EQ(
      after("load = 'sqrt(x - t)'", [](const Toy &toy) { toy.load(2, 7, 0, 3); }),
      "toy.toml line 1: load = \"sqrt(x - t)\" must be a number from -1e6 to 1e6 Pa; it is no number at x = 2 m, t = "
      "3 s");
  EXPECT_TRUE(
      contains(after("velocity = ['0', '1/y']", [](const Toy &toy) { toy.velocity[1](2, 0, 0, 0); }), "it is inf"));
}

TEST(TableReader, RefusesABadExpressionAtItsLine) {
  const std::string text = refusal("count = 1\nload = '2 *+* t'");
  EXPECT_TRUE(contains(text, "toy.toml line 2: load = \"2 *+* t\" (load on it)")) << text;
  EXPECT_TRUE(contains(text, "Unexpected operator")) << text;
}

TEST(TableReader, TakesAQuantityOfTheWrongUnitForNoExpression) {
  EXPECT_TRUE(contains(refusal("load = '2 m'"), "its unit must measure the same as Pa"));
}

TEST(TableReader, CallsTheFunctionsOfTheSceneInExpressions) {
  const std::string functions = "[functions]\nrain = [[0, 0], ['10 s', '5 kPa']]\ntwice = '2 * rain(t)'\n";
  EXPECT_DOUBLE_EQ(read("load = 'twice(t) * (x < 1)'\n" + functions).load(5), 5e3);
  EXPECT_EQ(read("load = 'twice(t) * (x < 1)'\n" + functions).load(1, 0, 0, 5), 0);
  const std::string units = "[functions]\nh = [[0, '100 Pa'], [1, 0], [2, '2 kPa'], [3, '3 kN/m2']]\n";
  EXPECT_DOUBLE_EQ(read("load = 'h(t)'\n" + units).load(2.5), 2500);
  EXPECT_TRUE(
      contains(refusal("[functions]\nh = [[0, '100 Pa'], [1, '2 m']]"), "line 2: functions.h.1.1 = \"2 m\" (") &&
      contains(refusal("[functions]\nh = [[0, 0], [1, 1], [2, '2 m']]"),
               "must be a quantity of the same dimension as functions.h.1.1 = 1; all values"));
}

/// Expressions count angles in degrees, so that is what a function gives that they call.
TEST(TableReader, GivesAnglesOfNamedFunctionsInDegrees) {
  const double radian = 3.14159265358979323846 / 180;
  for (const char *of :
       {"[[0, '30 deg'], [1, '30 deg']]", "30", "'30 deg'", "[[0, '30 deg'], [1, '0.52359877559829887 rad']]"})
    EXPECT_NEAR(read("angle = 'phi(t)'\n[functions]\nphi = " + std::string(of)).angle(0.5), 30 * radian, 1e-12) << of;
  const std::string rate = "[functions]\nrate = '2 deg/kPa'\n";
  EXPECT_NEAR(read("angle = '1000 * rate(t)'\n" + rate).angle(0), 2 * radian, 1e-12);
}

TEST(TableReader, RefusesNamedFunctionsThatAreNone) {
  EXPECT_TRUE(contains(refusal("[functions]\nrain = 'x'"), "a named function cannot depend on x"));
  EXPECT_TRUE(contains(refusal("[functions]\nt = 1"), "must be named by letters"));
  EXPECT_TRUE(contains(refusal("[functions]\na-b = 1"), "must be named by letters"));
  EXPECT_TRUE(contains(refusal("[functions]\nrain = '5 foo'"), "`foo` is no unit"));
  EXPECT_TRUE(contains(refusal("functions = 1"), "must be a table, [functions]"));
}

TEST(TableReader, SaysThatNumbersOfExpressionsHaveNoUnits) {
  for (const char *angle : {"10 deg * (t < 3600)", "10 deg * sin(t)"})
    EXPECT_TRUE(contains(refusal("angle = '" + std::string(angle) + "'"),
                         "numbers in an expression have no units: they count in deg"))
        << angle;
}

// ---- overrides ----

TEST(Overrides, ReplaceAValueWhereverItIs) {
  const std::string text = "place = [1, 2]\n[sort.sand]\nsize = 0.1\n[[layer]]\nsize = 0.1\n[[layer]]\nsize = 0.2\n";
  EXPECT_EQ(read(text, {"sort.sand.size=0.3"}).sort[0].size, 0.3);
  EXPECT_EQ(read(text, {"layer.1.size=0.4"}).layer[1].size, 0.4);
  EXPECT_EQ(read(text, {"place.1=7"}).place[1], 7);
  EXPECT_EQ(read(text, {"grain.size=0.6"}).grain.size, 0.6);
  EXPECT_EQ(read(text, {"count=2", "count=3"}).count, 3);
}

TEST(Overrides, TakeTomlValuesAndBareWords) {
  EXPECT_EQ(read("", {"place=[3, '4 km']"}).place, (std::vector<double>{3, 4000}));
  EXPECT_EQ(read("", {"wet=true"}).wet, true);
  EXPECT_EQ(read("", {"cohesion=5 kPa"}).cohesion, 5e3);
  EXPECT_EQ(read("", {"title=the \"old\" hill"}).title, "the \"old\" hill");
  EXPECT_EQ(read("", {"colour=green"}).colour, Colour::green);
  EXPECT_EQ(read("", {"load=2 * t"}).load(3), 6);
}

TEST(Overrides, ArePlacedInComplaints) {
  EXPECT_EQ(refusal("friction_angle = 3", {"friction_angle=95"}),
            "--set: friction_angle = 95 (friction angle phi) must be a number from 0 to 60 deg");
  EXPECT_EQ(refusal("", {"grain.sze=3"}), "--set: grain.sze is no known key; did you mean `size`?");
  EXPECT_EQ(refusal("", {"place=[1, nan]"}), "--set: place.1 = nan (place of it) must be a number in m");
}

TEST(Overrides, RefuseWhatIsNoKeyWithValue) {
  EXPECT_TRUE(contains(refusal("", {"count"}), "write key.path=value"));
  EXPECT_TRUE(contains(refusal("", {"=3"}), "write key.path=value"));
  EXPECT_TRUE(contains(refusal("", {"a..b=3"}), "write key.path=value"));
  EXPECT_TRUE(contains(refusal("[[layer]]\nsize = 1", {"layer.1.size=1"}), "no such entry `1`"));
  EXPECT_TRUE(contains(refusal("count = 1", {"count.a=1"}), "no such entry `a`"));
}

// ---- elasticity ----

struct Elastic {
  double young_modulus = nan, poisson_ratio = nan;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.elasticity(young_modulus, poisson_ratio);
  }
};

Elastic read_elastic(const std::string &text) {
  Elastic elastic;
  TableReader::from_text(text, "toy.toml").fill(elastic);
  return elastic;
}

TEST(Elasticity, IsTheSameFromEveryPairOfConstants) {
  const std::string E = "young_modulus = 26e6\n", nu = "poisson_ratio = 0.3\n", G = "shear_modulus = '10 MPa'\n";
  const std::string K = "bulk_modulus = " + std::to_string(26e6 / 1.2) + "\n";
  for (const std::string &pair : {E + nu, E + G, E + K, nu + G, nu + K, G + K}) {
    EXPECT_NEAR(read_elastic(pair).young_modulus, 26e6, 1) << pair;
    EXPECT_NEAR(read_elastic(pair).poisson_ratio, 0.3, 1e-7) << pair;
  }
}

TEST(Elasticity, NeedsExactlyTwoConstants) {
  const auto refusal = [](const std::string &text) { return complaint([&] { read_elastic(text); }); };
  EXPECT_EQ(refusal(""),
            "toy.toml: the scene needs exactly two of young_modulus, poisson_ratio, shear_modulus, bulk_modulus; "
            "it has none");
  EXPECT_TRUE(contains(refusal("young_modulus = 1e6"), "it has young_modulus"));
  EXPECT_TRUE(contains(refusal("young_modulus = 1e6\npoisson_ratio = 0\nshear_modulus = 5e5"),
                       "it has young_modulus, poisson_ratio, shear_modulus"));
}

TEST(Elasticity, RefusesUnstablePairs) {
  const auto refusal = [](const std::string &text) { return complaint([&] { read_elastic(text); }); };
  EXPECT_TRUE(contains(refusal("young_modulus = 1e6\nshear_modulus = 1e5"), "give Poisson's ratio 4"));
  EXPECT_TRUE(contains(refusal("young_modulus = 1e6\npoisson_ratio = 0.5"),
                       "line 2: poisson_ratio = 0.5 (Poisson's ratio nu) must lie above -1 and below 0.5"));
  EXPECT_TRUE(contains(refusal("shear_modulus = 1e6\npoisson_ratio = -1"), "must lie above -1 and below 0.5"));
  EXPECT_TRUE(contains(refusal("young_modulus = 0\npoisson_ratio = 0.3"), "must be a number from"));
}

// ---- deferred tables ----

struct Loose {
  static constexpr const char *name = "loose";
  double peak = 1, residual = 1;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("peak", peak, pascal, Range{0, 10}, "peak strength");
    v.number("residual", residual, pascal, Range{0, 10}, "residual strength");
  }
  std::string problem() const { return residual > peak ? "residual must not exceed peak" : ""; }
};
struct Dense {
  static constexpr const char *name = "dense";
  double density = required_density;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.number("density", density, one, Range{0, 1}, "relative density");
  }
  static constexpr double required_density = nan;
};
using Law = std::variant<Loose, Dense>;

/// A body with its law, and a table that may be absent.
struct Owner {
  std::vector<double> place;
  DeferredTable law, solver;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.point("place", place, metre, "place");
    v.deferred_table("solver", solver, "solver");
    v.deferred("law", law, "law");
  }
};

Owner read_owner(const std::string &text) {
  Owner owner;
  TableReader::from_text(text, "toy.toml").fill(owner);
  return owner;
}

Law read_law(const std::string &text) {
  Law law;
  read_one_of(read_owner(text).law, "law", law);
  return law;
}

TEST(ReadOneOf, PicksTheAlternativeByItsName) {
  const Law law = read_law("place = 1\nlaw = 'dense'\ndensity = 0.4\n");
  ASSERT_TRUE(std::holds_alternative<Dense>(law));
  EXPECT_EQ(std::get<Dense>(law).density, 0.4);
}

TEST(ReadOneOf, ReadsTheSameTableTwice) {
  const Owner owner = read_owner("law = 'loose'\npeak = 3");
  for (int i = 0; i < 2; ++i) {
    Law law = Dense{};
    read_one_of(owner.law, "law", law);
    EXPECT_EQ(std::get<Loose>(law).peak, 3);
  }
}

TEST(ReadOneOf, RefusesAnUnknownKindAndSuggestsTheNearest) {
  const std::string text = complaint([] { read_law("law = 'lose'"); });
  EXPECT_TRUE(contains(text, "toy.toml line 1: law = \"lose\"")) << text;
  EXPECT_TRUE(contains(text, "must be one of loose, dense; did you mean `loose`?")) << text;
}

TEST(ReadOneOf, NeedsTheKeyThatTheTableAnnounces) {
  EXPECT_EQ(complaint([] { read_law("peak = 1"); }), "toy.toml: the scene needs law, one of loose, dense");
}

TEST(ReadOneOf, RefusesKeysOfAnotherKindAndRequiresItsOwn) {
  EXPECT_TRUE(contains(complaint([] { read_law("law = 'dense'\ndensity = 1\npeak = 1"); }),
                       "line 3: peak is no known key; known are grids, functions, place, solver, law, density"));
  EXPECT_TRUE(contains(complaint([] { read_law("law = 'dense'"); }), "needs density"));
  EXPECT_TRUE(contains(complaint([] { read_law("law = 'dense'\ndensty = 1"); }), "did you mean it by `densty`?"));
}

TEST(ReadOneOf, AsksTheAlternativeForProblemsBetweenItsKeys) {
  EXPECT_EQ(complaint([] { read_law("law = 'loose'\npeak = 1\nresidual = 2"); }),
            "toy.toml line 3: residual = 2 must not exceed peak");
  EXPECT_EQ(complaint([] { read_law("law = 'loose'\npeak = 0.5"); }), "toy.toml: residual must not exceed peak");
  EXPECT_EQ(refusal("count = 1\n[strict]\n"), "toy.toml line 2: strict: always wrong");
}

TEST(ReadOneOf, TakesTheFirstAlternativeForAnAbsentTableOrKey) {
  Law law = Dense{};
  read_one_of(read_owner("").solver, "law", law);
  EXPECT_EQ(std::get<Loose>(law).peak, 1);
  read_one_of(read_owner("[solver]\npeak = 2").solver, "law", law);
  EXPECT_EQ(std::get<Loose>(law).peak, 2);
}

}  // namespace
}  // namespace talus
