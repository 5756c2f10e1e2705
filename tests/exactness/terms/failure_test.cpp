// A stage ends at failure when its point has passed the speed and soil stores no more of its energy, theory 5.3.
#include <gtest/gtest.h>

#include "scene/reader.h"
#include "simulation.h"

namespace talus {
namespace {

/// The event that ends the flight of a block, thrown upwards with 1 m/s under gravity of 10 m/s2.
Event failure_of_flight(const std::string &velocity, const std::string &failure_time, double *end) {
  const std::string text = R"(
dimension = 2
gravity = 10
[mesh]
section = "flight.csv"
size = 0.25
[body.soil]
region = "block"
density = 2000
law = "linear_elastic"
young_modulus = "100 MPa"
poisson_ratio = 0
velocity = ["0", ")" + velocity +
                           R"("]
[output.point.top]
position = [0.75, 0.95]
[[stage]]
duration = 0.4
until = "failure"
failure_point = "top"
failure_speed = 0.5
failure_time = )" + failure_time +
                           R"(
[integrator]
step = 1e-4
)";
  const Scene scene = parse_scene(text, std::string(TALUS_MESHES) + "/scene.toml");
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  *end = simulation->time();
  return simulation->events().empty() ? Event{} : simulation->events()[0];
}

/// The block is fast at first and receives no energy while it rises: that is no failure. It falls, and stores nothing of
/// what its weight brings: that is one, at the time at which it passes the speed.
TEST(Failure, is_told_by_energy_that_is_not_stored) {
  double end;
  const Event event = failure_of_flight("1", "0.03", &end);
  EXPECT_NE(event.text.find("stored less than a fifth"), std::string::npos) << event.text;
  EXPECT_NEAR(event.time, 0.15, 2e-4) << "up with 1 m/s, so down with 0.5 m/s after 0.15 s";
  EXPECT_NEAR(event.load_time, event.time, 1e-12);
  EXPECT_NEAR(end, 0.183, 3.1e-3) << "half of failure_time after its mean velocity has passed the speed, in tenths of 3 ms";
}

/// The same block rings while it falls: its top speeds up by 0.1 m/s in a tenth and swings by up to 0.4 m/s. Its mean
/// velocity in a tenth rises all the same. The last swing displaces it by less than 0.2 mm, 0.02 m/s over a tenth.
TEST(Failure, is_told_though_the_point_vibrates) {
  double end;
  const Event event = failure_of_flight("1 + 1.6 * (y - 0.75)", "0.1", &end);
  EXPECT_NEAR(event.time, 0.15, 5e-3);
  EXPECT_NEAR(end, 0.26, 1.02e-2);
}

}  // namespace
}  // namespace talus
