// `talus record` and `talus newmark` as a user calls them, with a record and a slope whose answers are known.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "csv_table.h"
#include "scene.h"

namespace talus {
namespace {

constexpr double pulse = 4, duration = 0.5;  // of the record [m/s2], [s]

/// An elastic block on a rough plane of 10 degrees, along which x runs: its factor of safety under an inertia k is
/// cos 10 tan 25 / (sin 10 + k).
const std::string block_on_a_plane = R"(title = "a block on a plane"
gravity = [1.703529, -9.660974]
[mesh]
section = "section.csv"
size = 0.5
[body.block]
region = "sand"
density = 2000
law = "linear_elastic"
young_modulus = "100 MPa"
poisson_ratio = 0
[boundary.base]
kind = "friction"
friction_angle = 25
[[stage]]
kind = "quasi_static"
duration = 1
)";

std::string record_of(double acceleration) {
  std::string text = "time [s], acceleration [m/s2]\n";
  for (int k = 0; k <= 50; ++k) text += std::to_string(0.01 * k) + ", " + std::to_string(acceleration) + "\n";
  return text;
}

class Earthquake : public testing::Test {
 protected:
  Earthquake() {
    folder_.write("section.csv", good_section);
    folder_.write("block.toml", block_on_a_plane);
    folder_.write("up.csv", record_of(-pulse));
    folder_.write("weak.csv", record_of(-1));
  }
  Ending talus(std::vector<std::string> words) const {
    words.insert(words.end(), {"--no-pictures", "-o", "out"});
    return talus::talus(folder_, words);
  }
  double number(const Row &row, const std::string &column) const { return std::stod(row.at(column)); }
  const Folder folder_;
};

TEST_F(Earthquake, IsShownByRecord) {
  const Ending ending = talus({"record", "up.csv", "--set", "scale=-0.5"});
  ASSERT_EQ(ending.status, 0) << ending.output;
  EXPECT_TRUE(ending.says("peak acceleration                 2 m/s2 = 0.2039 g")) << ending.output;
  EXPECT_TRUE(ending.says("peak velocity                     1 m/s")) << ending.output;
  EXPECT_TRUE(ending.says("peak displacement              0.25 m")) << ending.output;
  EXPECT_TRUE(ending.says("warning: ")) << "it leaves the ground with a velocity\n" << ending.output;
  const auto rows = csv_table(folder_ / "out/up.csv");
  ASSERT_EQ(rows.size(), 51u);
  EXPECT_NEAR(number(rows.back(), "velocity_m_s"), 1, 1e-9);
  EXPECT_NEAR(number(rows.back(), "arias_m_s"), M_PI / (2 * 9.80665) * 4 * duration, 1e-6);
  EXPECT_FALSE(csv_table(folder_ / "out/up_spectrum.csv").empty());
}

TEST_F(Earthquake, ThatIsMissingIsSaid) {
  for (const std::vector<std::string> &words :
       {std::vector<std::string>{"record", "block.toml"}, {"newmark", "block.toml"}}) {
    const Ending ending = talus(words);
    EXPECT_NE(ending.status, 0);
    EXPECT_TRUE(ending.says("no [[earthquake]]")) << ending.output;
  }
}

/// The yield coefficient of a rigid block, and under a pulse A over a time T, at whose end the block still slides, the
/// way (A - N) A T^2 / 2 N of Newmark (1965), of two records of one name and in one table.
TEST_F(Earthquake, SlidesABlockUntilItIsAtRest) {
  const Ending ending = talus({"newmark", "block.toml", "--record", "up.csv", "weak.csv", "./up.csv"});
  ASSERT_EQ(ending.status, 0) << ending.output;
  const double exact = std::cos(M_PI / 18) * std::tan(M_PI / 7.2) - std::sin(M_PI / 18);
  std::ifstream file(folder_ / "out/newmark.json");
  const auto found = nlohmann::json::parse(file);
  const double coefficient = found["yield_coefficient"];
  EXPECT_NEAR(coefficient, exact, 0.01 * exact) << "half of the brackets of two factors";
  const double N = 9.80665 * coefficient, way = (pulse - N) * pulse * duration * duration / (2 * N);
  const auto rows = csv_table(folder_ / "out/newmark.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_NEAR(number(rows[0], "rigid_block_m"), way, 1e-6 * way);
  EXPECT_EQ(number(rows[0], "reversed_m"), 0);
  EXPECT_EQ(number(rows[1], "rigid_block_m"), 0);
  EXPECT_EQ(number(rows[2], "rigid_block_m"), number(rows[0], "rigid_block_m"));
  EXPECT_EQ(rows[2].at("motion"), "up_2");
  const auto history = csv_table(folder_ / "out/up.csv");
  EXPECT_GT(history.size(), 51u) << "until the block is at rest";
  EXPECT_NEAR(number(history.back(), "way_m"), way, 1e-6 * way);
  EXPECT_TRUE(ending.says("of the 3 motions")) << ending.output;
}

}  // namespace
}  // namespace talus
