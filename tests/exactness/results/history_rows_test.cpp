// Rows of history.csv: output points in stages by finite elements are the places that the scene gives, and rows do not
// change the steps of the motion.
#include "../quasi_static/solved.h"

namespace talus {
namespace {

const std::string column = "gravity = 10\n" + box + R"(
density = 2000
[boundary.walls]
group = ["base", "left", "right"]
kind = "roller"
)";

/// A column under its weight sinks by a quadratic function of height, which elements of second order hold exactly: a
/// point shows it at its own place, between nodes as well as on an edge or a corner of the soil. The nearest particle
/// is 0.05 m away, where the displacement differs by a tenth and more.
TEST(HistoryRows, static_stages_show_the_place_itself) {
  const double modulus = 10e6 * 0.7 / (1.3 * 0.4), weight = 2000 * 10;
  const std::vector<std::pair<std::string, double>> points{
      {"[0.37, 0.61]", 0.61}, {"[0.5, 1]", 1}, {"[0, 1]", 1}, {"[1, 0.2]", 0.2}};
  std::string text = column + "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n";
  for (size_t i = 0; i < points.size(); ++i)
    text += "[output.point.p" + std::to_string(i) + "]\nposition = " + points[i].first + "\n";
  const HistoryTable history = solve(text).history;
  for (size_t i = 0; i < points.size(); ++i) {
    const std::string name = "p" + std::to_string(i);
    const double y = points[i].second, exact = weight / modulus * (y - y * y / 2);
    EXPECT_NEAR(history.column(name + "_displacement_m").back(), exact, 1e-12 * weight / modulus) << points[i].first;
    EXPECT_EQ(history.column(name + "_y_m").back(), y) << points[i].first;
    EXPECT_EQ(history.column(name + "_velocity_m_s").back(), 0) << points[i].first;
  }
}

/// Rows come with the first step that reaches their time, and the motion is the same to the last bit however many there
/// are.
TEST(HistoryRows, do_not_shorten_steps) {
  const std::string text = column + "[output.point.top]\nposition = [0.5, 1]\n[[stage]]\nduration = 0.1\n";
  const HistoryTable a = solve(text, {"output.history_interval=0.1"}).history,
                     b = solve(text, {"output.history_interval=7e-4"}).history;
  EXPECT_EQ(a.rows.size(), 2u) << "start and end";
  EXPECT_GT(b.rows.size(), 20u);
  EXPECT_EQ(a.column("step").back(), b.column("step").back());
  EXPECT_EQ(a.column("top_displacement_m").back(), b.column("top_displacement_m").back());
  const std::vector<double> times = b.column("time_s");
  const double step = 0.1 / b.column("step").back();
  for (size_t i = 1; i + 1 < times.size(); ++i) {
    const double due = 7e-4 * std::floor(times[i] / 7e-4 * (1 + 1e-9));  // the last row time that this step reached
    EXPECT_LT(times[i] - due, 1.01 * step) << i;
    EXPECT_GT(due, times[i - 1]) << i;
  }
}

}  // namespace
}  // namespace talus
