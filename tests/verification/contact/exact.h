#pragma once
/// Contact between groups of bodies: an elastic block on elastic ground slides with Coulomb's friction, a = g (sin beta
/// - tan phi cos beta), and sticks on slopes below phi; two elastic bars of one kind that collide exchange their
/// velocities, and touch for 2 L / c.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void contact(Rung &rung) {
  constexpr double g = 9.81, degree = 3.14159265358979323846 / 180, phi = 20 * degree, settled = 1, weight = 4000 * g;
  const auto on_slope = [&](double slope, std::vector<std::string> more) {
    more.push_back("gravity=[" + number(g * std::sin(slope * degree)) + ", " + number(-g * std::cos(slope * degree)) +
                   "]");
    return rung.run(more).history;
  };
  const auto mean = [](const HistoryTable &history, const std::string &column, double from) {
    const auto time = history.column("time_s"), value = history.column(column);
    double sum = 0, count = 0;
    for (size_t k = 0; k < time.size(); ++k)
      if (time[k] > from) sum += value[k], count += 1;
    return sum / count;
  };
  const auto slides = [&](double slope, const std::string &size) {
    const HistoryTable history = on_slope(slope, {"mesh.size=" + size});
    const std::string which = "slope of " + number(slope) + " deg, cells of " + size + " m, ";
    const double exact = g * (std::sin(slope * degree) - std::tan(phi) * std::cos(slope * degree)) / 2;
    const double way =
        history.column("middle_displacement_x_m").back() - at_time(history, "middle_displacement_x_m", settled);
    const double normal = mean(history, "joint_force_y_N", settled + 0.3),
                 along = -mean(history, "joint_force_x_N", settled + 0.3);
    rung.compare(which + "friction of the block over Coulomb's", 1, along / normal / std::tan(phi), 0.08);
    rung.compare(which + "normal force over its weight's", 1, normal / (weight * std::cos(slope * degree)), 0.05);
    rung.compare(which + "way in 1 s over the exact one", 1, way / exact, 0.12);
  };
  slides(30, "0.1");
  slides(30, "0.15");
  slides(35, "0.1");
  if (rung.longer()) slides(30, "0.07"), slides(25, "0.1");
  for (const double slope : {5., 15.}) {
    const HistoryTable history = on_slope(slope, {});
    rung.compare("slope of " + number(slope) + " deg, velocity after 1 s, of g sin beta", 0,
                 history.column("middle_velocity_m_s").back() / (g * std::sin(slope * degree)), 2e-3, 1);
  }

  const double across = std::cos(27 * degree) / 2, up = std::sin(27 * degree) / 2, wave = 2 / std::sqrt(1000.);
  const auto moving = [&](double sign) {
    return "=[\"" + number(sign * across) + "\", \"" + number(sign * up) + "\"]";
  };
  std::vector<std::string> bars{"mesh.section=../../../meshes/two_bars.csv",
                                "mesh.size=0.05",
                                "gravity=0",
                                "body.a.region=a",
                                "body.b.region=b",
                                "body.a.velocity" + moving(1),
                                "body.b.velocity" + moving(-1),
                                "contact.joint.friction_angle=0",
                                "stage.0.duration=0.1",
                                "stage.0.gravity_ramp=0",
                                "stage.0.damping=0",
                                "stage.1.duration=0.1",
                                "output.history_interval=0.001",
                                "output.point.middle.position=[-0.4, -0.2]"};
  for (const std::string body : {"body.a.", "body.b."})
    bars.insert(bars.end(), {body + "density=1000", body + "young_modulus=1e6", body + "poisson_ratio=0"});
  const HistoryTable history = rung.run(bars).history;
  const auto time = history.column("time_s"), x = history.column("joint_force_x_N"),
             y = history.column("joint_force_y_N"), kinetic = history.column("kinetic_J"),
             strain = history.column("strain_J");
  std::vector<double> force;
  for (size_t k = 0; k < x.size(); ++k) force.push_back(std::hypot(x[k], y[k]));
  const double noticed = 0.1 * *std::ranges::max_element(force);
  double impulse = 0, first = 0, last = 0;
  for (size_t k = 1; k < time.size(); ++k) {
    impulse += force[k] * (time[k] - time[k - 1]);
    if (force[k] > noticed && first == 0) first = time[k - 1];
    if (force[k] > noticed) last = time[k];
  }
  rung.compare("bars, impulse over twice the momentum of one", 1, impulse / 400, 0.08);
  rung.compare("bars, energy after over before", 1, (kinetic.back() + strain.back()) / kinetic.front(), 0.1);
  rung.compare("bars, time in contact over 2 L / c", 1, (last - first) / wave, 0.25);
  rung.compare("bars, first contact, gap in cells", 0, (0.05 - first) / 0.05, 0.2, 1);
}

}  // namespace talus::rungs
