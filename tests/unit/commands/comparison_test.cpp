// What the arguments of `talus compare` mean, and what a series converges to.
#include "commands/comparison.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace talus {
namespace {

TEST(Comparison, a_series_is_every_combination_of_its_values) {
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

TEST(Comparison, bad_series_are_refused) {
  for (const char *text : {"euler", ": a=1", "euler: a", "euler: =3", "euler: a=1,,2"})
    EXPECT_THROW(parse_series(text), SceneError) << text;
  EXPECT_THROW(parse_measure("crest@noon"), SceneError);
  EXPECT_THROW(parse_measure("max:crest@3"), SceneError);
}

TEST(Comparison, numbers_may_have_a_unit) {
  EXPECT_EQ(number_of("\"5 mm\""), 5);
  EXPECT_EQ(number_of("1e-3"), 1e-3);
  EXPECT_TRUE(std::isnan(number_of("euler")));
}

TEST(Comparison, lists_of_which_some_numbers_have_a_unit_are_refused) {
  EXPECT_EQ(unit_behind("\"5 mm\""), "mm");
  EXPECT_EQ(unit_behind("[0, 1 m]"), "");
  for (const char *good : {"a: k=4 kPa,8 kPa,12kPa", "a: k=4,8,12", "a: k=a,b", "a: k=[0, 1 m],[0, 2]"})
    EXPECT_NO_THROW(parse_series(good)) << good;
  for (const auto &[text, said] :
       {std::pair{"a: k=4,8,12 kPa",
                  "none at 4, which would be a number in the unit of the key: give all of them a "
                  "unit, such as 4 kPa,8 kPa,12 kPa, or none"},
        {"a: k=4 kPa,8", "has a unit at 4 kPa and none at 8"},
        {"a: k=4 kPa,1 MPa", "has values in kPa and in MPa"}})
    try {
      parse_series(text);
      ADD_FAILURE() << text;
    } catch (const SceneError &error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
}

TEST(Comparison, richardson_finds_the_limit_of_a_power) {
  std::vector<std::pair<double, double>> refined;
  for (const double h : {0.1, 0.2, 0.4}) refined.emplace_back(h, 7 + 3 * h * h);
  const Reference limit = extrapolate(refined);
  EXPECT_NEAR(limit.value, 7, 1e-12);
  EXPECT_NEAR(limit.uncertainty, 3 * 0.01, 1e-12);
}

TEST(Comparison, without_convergence_the_finest_run_is_as_uncertain_as_its_last_changes) {
  const Reference limit = extrapolate({{0.1, 5}, {0.2, 6}, {0.4, 5.5}, {NAN, 1}});
  EXPECT_EQ(limit.value, 5);
  EXPECT_EQ(limit.uncertainty, 1);
  EXPECT_TRUE(std::isinf(extrapolate({{0.1, 5}}).uncertainty));
  EXPECT_NEAR(extrapolate({{0.1, 5}, {0.2, 5.1}, {0.4, 4}}).uncertainty, 1.1, 1e-12)
      << "the last change may be small by chance";
  const Reference idle =
      extrapolate({{1e-4, 5}, {1e-3, 5}, {1e-2, 5}, {1e-1, 5.2}});  // a tolerance that stability overrules
  EXPECT_EQ(idle.value, 5);
  EXPECT_NEAR(idle.uncertainty, 0.2, 1e-12);
  EXPECT_TRUE(std::isinf(extrapolate({{0.1, 5}, {0.2, 5}}).uncertainty));
  const Reference chance =  // order 5 in the last three runs, but the fourth turns back
      extrapolate({{0.05, 12.0638}, {0.1, 12.0541}, {0.2, 11.7065}, {0.4, 11.7174}});
  EXPECT_EQ(chance.value, 12.0638);
  EXPECT_NEAR(chance.uncertainty, 0.3476, 1e-12);
}

TEST(Comparison, after_the_end_of_a_run_at_rest_its_last_row_counts) {
  const std::string folder = testing::TempDir(), path = folder + "history.csv";
  const auto value = [&](const std::string &stage, const char *kind, const std::string &measure) {
    std::ofstream(path) << "time_s,step,stage,x_m\n0,0,start,0\n1,5,fall,4\n2,9,slide,2\n";
    std::ofstream(folder + "events.jsonl")
        << to_lines({{event::remark, "slide", {}, false, 0, 0, "slide"}, {kind, "", {}, false, 2, 2, stage}});
    return value_of(path, parse_measure(measure));
  };
  for (const char *kind : {event::rest, event::slow, event::equilibrium}) {
    EXPECT_EQ(value("slide", kind, "x_m@30"), 2) << kind;
    EXPECT_TRUE(std::isnan(value("fall", kind, "x_m@30"))) << kind;
  }
  for (const char *kind : {event::duration_over, event::equilibrium_lost, event::remark})
    EXPECT_TRUE(std::isnan(value("slide", kind, "x_m@30"))) << kind;
  EXPECT_EQ(value("slide", event::remark, "x_m@1.5"), 3);
  std::remove(path.c_str()), std::remove((folder + "events.jsonl").c_str());
}

TEST(Comparison, measures_are_read_off_a_history) {
  const std::string path = testing::TempDir() + "comparison_history.csv";
  std::ofstream(path) << "time_s,step,stage,x_m\n0,0,start,0\n1,5,fall,4\n2,9,fall,2\n";
  EXPECT_EQ(value_of(path, parse_measure("x_m")), 2);
  EXPECT_EQ(value_of(path, parse_measure("x_m@0.5")), 2);
  EXPECT_EQ(value_of(path, parse_measure("x_m@2")), 2);
  EXPECT_EQ(value_of(path, parse_measure("max:x_m")), 4);
  EXPECT_THROW(value_of(path, parse_measure("y_m")), SceneError);
  std::remove(path.c_str());
}

TEST(Comparison, sentences_that_differ_in_numbers_and_their_signs_are_one) {
  EXPECT_EQ(without_numbers("moves by -1.5e-3 m at (4, -2)"), "moves by # m at (#, #)");
  EXPECT_EQ(without_numbers("moves by 20 m at (-4, 0.5)"), "moves by # m at (#, #)");
  EXPECT_NE(without_numbers("moves by 20 m"), without_numbers("moves by 20 s"));
}

}  // namespace
}  // namespace talus
