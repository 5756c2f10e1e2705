// Values and measures as they are typed.
#include "commands/values.h"

#include <gtest/gtest.h>

namespace talus {
namespace {

TEST(Values, a_series_is_every_combination_of_its_values) {
  const Series series =
      parse_series("arkode: integrator.kind=arkode; integrator.order=3,4; body.a.velocity=[1, 2],[3, 4]");
  EXPECT_EQ(series.name, "arkode");
  const auto runs = products(series);
  ASSERT_EQ(runs.size(), 4u);
  EXPECT_EQ(runs[0],
            (std::vector<std::string>{"integrator.kind=arkode", "integrator.order=3", "body.a.velocity=[1, 2]"}));
  EXPECT_EQ(runs[3],
            (std::vector<std::string>{"integrator.kind=arkode", "integrator.order=4", "body.a.velocity=[3, 4]"}));
  EXPECT_EQ(products(parse_series("as it is:")).size(), 1u);
}

TEST(Values, bad_series_are_refused) {
  for (const char *text : {"euler", ": a=1", "euler: a", "euler: =3", "euler: a=1,,2"})
    EXPECT_THROW(parse_series(text), SceneError) << text;
  EXPECT_THROW(parse_measure("crest@noon"), SceneError);
  EXPECT_THROW(parse_measure("max:crest@3"), SceneError);
}

TEST(Values, numbers_may_have_a_unit) {
  EXPECT_EQ(typed("\"5 mm\"").number, 5);
  EXPECT_EQ(typed("\"5 mm\"").unit, "mm");
  EXPECT_EQ(typed("1e-3").number, 1e-3);
  EXPECT_TRUE(std::isnan(typed("euler").number));
  EXPECT_EQ(typed("[0, 1 m]").unit, "");
}

TEST(Values, lists_of_which_some_numbers_have_a_unit_are_refused) {
  for (const char *good : {"a: k=4 kPa,8 kPa,12kPa", "a: k=4,8,12", "a: k=a,b", "a: k=[0, 1 m],[0, 2]"})
    EXPECT_NO_THROW(parse_series(good)) << good;
  for (const auto &[text, said] :
       {std::pair{"a: k=4,8,12 kPa", "has numbers without a unit and in kPa: give all of them one unit, or none"},
        {"a: k=4 kPa,1 MPa", "has numbers in MPa and in kPa"}})
    try {
      parse_series(text);
      ADD_FAILURE() << text;
    } catch (const SceneError &error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace talus
