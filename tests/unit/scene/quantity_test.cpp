#include "scene/quantity.h"

#include <gtest/gtest.h>

#include "complaint.h"
#include "scene/words.h"

namespace talus {
namespace {

constexpr Unit unit_weight{"N/m3", 1, {1, -2, -2, 0}};
constexpr Unit cubic_metre_per_second{"m3/s", 1, {0, 3, -1, 0}};

TEST(Quantity, NamesTheUnitThatIsMeantAndTheDecimalPoint) {
  EXPECT_NE(complaint([] { parse_quantity("7 kpa"); }).find("did you mean `kPa`?"), std::string::npos);
  EXPECT_NE(complaint([] { parse_quantity("7 KPa"); }).find("did you mean `kPa`?"), std::string::npos);
  EXPECT_NE(complaint([] { parse_quantity("7,0 kPa"); }).find("decimals are written with a point"), std::string::npos);
  EXPECT_TRUE(looks_like_quantity("7,0 kPa"));
}

TEST(Quantity, ReadsEveryUsualSpellingOfAUnit) {
  const struct {
    const char *text;
    Unit unit;
    double expected;
  } table[] = {
      {"20 MPa", pascal, 20e6},
      {"20MPa", pascal, 20e6},
      {"  5 kN/m2 ", pascal, 5e3},
      {"5 kN/m^2", pascal, 5e3},
      {"5 kN/m²", pascal, 5e3},
      {"5 kN m-2", pascal, 5e3},
      {"2 bar", pascal, 2e5},
      {"3 mbar", pascal, 300},
      {"4 kg/(m s2)", pascal, 4},
      {"1.3e-4 s", second, 1.3e-4},
      {"5 ms", second, 5e-3},
      {"10 min", second, 600},
      {"1 day", second, 86400},
      {"2 h", second, 7200},
      {"1 year", second, 31557600},
      {"30 deg", degree, 30},
      {"30°", degree, 30},
      {"0.5 m/s", metre_per_second, 0.5},
      {"36 km/h", metre_per_second, 10},
      {"1 cm/min", metre_per_second, 1e-2 / 60},
      {"9.81 m/s2", metre_per_second_squared, 9.81},
      {"0.3 g", metre_per_second_squared, 0.3 * 9.80665},
      {"9.81 m/s/s", metre_per_second_squared, 9.81},
      {"2650 kg/m3", kilogram_per_cubic_metre, 2650},
      {"2.65 g/cm3", kilogram_per_cubic_metre, 2650},
      {"2.65 t/m³", kilogram_per_cubic_metre, 2650},
      {"20 kN/m3", unit_weight, 20e3},
      {"10 ft", metre, 3.048},
      {"1 psf", pascal, 47.88025898033584},
      {"1 psi", pascal, 6894.757293168361},
      {"1 pcf", unit_weight, 157.0874638462462},
      {"1e-3 Pa s", pascal_second, 1e-3},
      {"1e-3 Pa*s", pascal_second, 1e-3},
      {"1e-3 Pa·s", pascal_second, 1e-3},
      {"1 mPa.s", pascal_second, 1e-3},
      {"3 l/s", cubic_metre_per_second, 3e-3},
      {"1 darcy", square_metre, 9.869233e-13},
      {"7 µm2", square_metre, 7e-12},
      {"2.7 MJ/(m3 K)", joule_per_cubic_metre_kelvin, 2.7e6},
      {"2 W/m/K", watt_per_metre_kelvin, 2},
      {"58 kPa/K", pascal_per_kelvin, 58e3},
      {"40 %", one, 0.4},
      {"0.3", one, 0.3},
      {"+.5e1", pascal, 5},
      {"-2 mm", metre, -2e-3},
  };
  for (const auto &[text, unit, expected] : table)
    EXPECT_NEAR(in_unit(text, unit), expected, 1e-12 * std::abs(expected)) << text;
}

TEST(Quantity, TakesAPlainNumberInTheUnitOfItsKey) { EXPECT_EQ(in_unit("30", degree), 30); }

TEST(Quantity, KeepsANumberInTheUnitOfItsKeyToTheLastBit) {
  EXPECT_EQ(in_unit("60 deg", degree), 60);
  EXPECT_EQ(in_unit("0.3 s", second), 0.3);
  EXPECT_EQ(in_unit("2650 kg/m3", kilogram_per_cubic_metre), 2650);
}

TEST(Quantity, ConvertsRadiansToDegrees) { EXPECT_NEAR(in_unit("0.5 rad", degree), 28.6478897565412, 1e-12); }

TEST(Quantity, RefusesWhatIsNoQuantity) {
  for (const char *text : {"", "MPa", "20 MPaa", "20 foo", "1..2", "inf", "nan", "1e999", "5 m/", "5 m^", "5 m^x",
                           "5 (m", "5 m)", "5 *m", "1,5 m", "5 m99", "twenty"})
    EXPECT_NE(complaint([&] { (void)parse_quantity(text); }), "") << text;
}

TEST(Quantity, RefusesParenthesesWithoutEnd) {  // each of them takes room on the stack
  EXPECT_EQ(in_unit("1 " + std::string(20, '(') + "Pa" + std::string(20, ')'), pascal), 1);
  EXPECT_TRUE(
      contains(complaint([] { (void)in_unit("1 " + std::string(1000000, '('), pascal); }), "nested too deeply"));
}

TEST(Quantity, RefusesAnotherDimension) {
  EXPECT_EQ(complaint([] { (void)in_unit("5 m", pascal); }), "its unit must measure the same as Pa");
  EXPECT_EQ(complaint([] { (void)in_unit("5 m", one); }), "it is a number without a unit");
}

TEST(Quantity, HintsWhereTwoQuantitiesAreOftenConfused) {
  const auto hint = [](const char *text, Unit unit) { return complaint([&] { (void)in_unit(text, unit); }); };
  EXPECT_TRUE(contains(hint("1e-3 m/s", square_metre), "that is a hydraulic_conductivity"));
  EXPECT_TRUE(contains(hint("1e-12 m2", metre_per_second), "that is a permeability"));
  EXPECT_TRUE(contains(hint("20 kN/m3", kilogram_per_cubic_metre), "that is a unit weight; divide by g"));
  EXPECT_TRUE(contains(hint("2000 kg/m3", unit_weight), "that is a density; multiply by g"));
  EXPECT_TRUE(contains(hint("5 kN", pascal), "that is a force"));
  EXPECT_TRUE(contains(hint("30 %", degree), "that is a slope"));
}

TEST(Quantity, IsToldFromAnExpression) {
  for (const char *text : {"5", "-1.5e3", "5 MPa", "2 t", "40 %", "3 1/s", "30°"})
    EXPECT_TRUE(looks_like_quantity(text)) << text;
  for (const char *text : {"2 * t", "t", "-x", "1 - y / table", "info(t)", "(3)", "3 / t", "2*pi"})
    EXPECT_FALSE(looks_like_quantity(text)) << text;
}

TEST(Shortest, WritesNumbersAsPeopleDo) {
  EXPECT_EQ(shortest(0.3), "0.3");
  EXPECT_EQ(shortest(30), "30");
  EXPECT_EQ(shortest(1e12), "1e12");
  EXPECT_EQ(shortest(1e-5), "1e-5");
  EXPECT_EQ(shortest(-1.5e-12), "-1.5e-12");
}

TEST(EditDistance, CountsEditsAndSwaps) {
  EXPECT_EQ(edit_distance("law", "law"), 0);
  EXPECT_EQ(edit_distance("law", "lwa"), 1);
  EXPECT_EQ(edit_distance("porosity", "porosty"), 1);
  EXPECT_EQ(edit_distance("", "abc"), 3);
}

TEST(Nearest, IsEmptyWhenNothingIsNear) {
  EXPECT_EQ(nearest("porsity", {"density", "porosity"}), "porosity");
  EXPECT_EQ(nearest("colour", {"density", "porosity"}), "");
}

}  // namespace
}  // namespace talus
