// Advice of `talus check`, one case a line: it is given where it is due.
#include "check/check.h"

namespace talus {
namespace {

struct Case {
  const char *name;
  std::vector<std::string> overrides;
  const char *advice;
};

void PrintTo(const Case &one, std::ostream *out) { *out << one.name; }

const Case cases[] = {
    {"one_particle", {"body.sand.particles_per_cell=1"}, "particles_per_cell = 1 in body sand; usual 3 to 64"},
    {"softening",
     {"body.sand.residual_friction_angle=20", "body.sand.shape_factor=10"},
     "softens without a reference_size"},
    {"average_that_cells_do_not_resolve",
     {"body.sand.residual_friction_angle=20", "body.sand.shape_factor=10", "body.sand.averaging_length=0.28"},
     "do not resolve its averaging_length of 0.28 m"},
    {"gravity_at_once", {}, "gravity is applied at once"},
    {"rest_after_motion",
     {"stage=[{name='slide', duration=1}, {name='gravity', kind='quasi_static', duration=1}]"},
     "and stage gravity comes too late to prevent it"},
    {"no_relaxation", {"transfer.relaxation=0"}, "relaxation = 0 in [transfer]; usual 20 to 10000 [relaxation]"},
    {"load_after_the_end",
     {"functions.a=[[0, 0], [20, 0], [22, 1]]", "body.sand.body_acceleration=[\"a(t)\", \"0\"]"},
     "body.sand.body_acceleration changes from t = 20 s on, and the loads of the stages end at t = 0.05 s"},
    {"load_that_is_held",
     {"stage.0.hold_loads=true", "body.sand.body_acceleration=[\"sin(t)\", \"0\"]"},
     "changes from t = 0 s on, and the loads of the stages end at t = 0 s"},
    {"gravity_that_does_not_come",
     {"stage.0.gravity_ramp=0.1"},
     "stage.fall.gravity_ramp = 0.1 s is longer than the stage"},
    {"failure_that_is_not_found",
     {"stage.0.until=failure", "stage.0.failure_point=toe", "output.point.toe.position=[1, 0]",
      "stage.0.failure_time=0.1"},
     "stage.fall.failure_time = 0.1 s is longer than the stage"},
    {"earthquake_that_no_stage_has",
     {"earthquake=[{kind='ricker', amplitude=1, frequency=2}]"},
     "no stage has earthquake = true"},
    {"earthquake_that_drifts",
     {"earthquake=[{kind='sine', amplitude=1, frequency=2, duration=0.25}]", "stage.0.earthquake=true",
      "stage.0.duration=1"},
     "the record leaves the ground with"},
};

class Advice : public testing::TestWithParam<Case> {};

TEST_P(Advice, IsGivenWhereItIsDue) {
  const Folder folder;
  const Ending ending = check(folder, GetParam().overrides);
  EXPECT_EQ(ending.status, 0);
  EXPECT_TRUE(ending.says(GetParam().advice)) << ending.output;
}

TEST(NoAdvice, IsGivenWhereAllIsWell) {
  const Folder folder;
  const Ending ending = check(folder, {"gravity=0", "acknowledge=gravity"});
  EXPECT_TRUE(ending.says("\"advice\": []")) << ending.output;
}

INSTANTIATE_TEST_SUITE_P(All, Advice, testing::ValuesIn(cases), [](const auto &one) { return one.param.name; });

}  // namespace
}  // namespace talus
