// A stage ends at failure when its point has passed the speed and goes on to accelerate, docs/theory section 5.3.
#include <gtest/gtest.h>

#include "scene/reader.h"
#include "simulation.h"

namespace talus {
namespace {

/// A block thrown upwards is fast at first and slows down: that is no failure. It falls faster and faster: that is one,
/// at the time at which it passes the speed.
TEST(Failure, is_told_by_a_point_that_keeps_accelerating) {
  Scene scene = parse_scene(R"(
dimension = 2
gravity = 10
[mesh]
section = "flight.csv"
size = 0.25
[body.soil]
region = "block"
density = 2000
law = "linear_elastic"
young_modulus = "1 MPa"
poisson_ratio = 0.3
velocity = ["0", "1"]
[output.point.middle]
position = [0.75, 0.75]
[[stage]]
duration = 0.25
until = "failure"
failure_point = "middle"
failure_speed = 0.5
failure_time = 0.03
[integrator]
step = 1e-4
)",
                            std::string(TALUS_MESHES) + "/scene.toml");
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  ASSERT_EQ(simulation->events().size(), 1u);
  const Event &event = simulation->events()[0];
  EXPECT_NE(event.text.find("kept accelerating"), std::string::npos) << event.text;
  EXPECT_NEAR(event.time, 0.15, 2e-4) << "up with 1 m/s, so down with 0.5 m/s after 0.15 s";
  EXPECT_NEAR(simulation->time(), 0.18, 2e-4) << "watched for 0.03 s";
}

}  // namespace
}  // namespace talus
