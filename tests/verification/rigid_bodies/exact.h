#pragma once
/// Rigid bodies on soil: a block that falls, rests, slides, sticks and topples; a smooth wall in sand (Rankine); a
/// strip footing on Tresca soil (Prandtl). Forces are those of the soil on the body, in 2D per metre of width.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

/// Mean of a column from one time to another.
inline double mean_between(const HistoryTable &history, const std::string &column, double from, double to) {
  const auto time = history.column("time_s"), value = history.column(column);
  double sum = 0, count = 0;
  for (size_t i = 0; i < time.size(); ++i)
    if (time[i] >= from && time[i] <= to) sum += value[i], count += 1;
  return sum / count;
}

/// Time at which a column reaches a value on its way down.
inline double time_when_below(const HistoryTable &history, const std::string &column, double value) {
  const auto time = history.column("time_s"), at = history.column(column);
  size_t i = 1;
  while (i + 1 < at.size() && at[i] > value) ++i;
  return time[i - 1] + (at[i - 1] - value) / (at[i - 1] - at[i]) * (time[i] - time[i - 1]);
}

/// Time that a block of width b and height h takes from one angle to another about its lower edge, from rest on a plane
/// inclined by `slope`: (b2 + h2) / 3 theta'' = g R sin(theta + slope - atan(b / h)), R half its diagonal.
inline double toppling_time(double b, double h, double slope, double from, double to) {
  constexpr double g = 9.81, step = 1e-5;
  const double pull = 1.5 * g / std::hypot(b, h), lean = slope - std::atan2(b, h);
  double angle = 0, rate = 0, begin = 0;
  for (double t = 0;; t += step) {
    if (angle < from) begin = t;
    if (angle >= to) return t - begin;
    rate += step * pull * std::sin(angle + lean), angle += step * rate;
  }
}

inline void rigid_bodies(Rung &rung) {
  constexpr double g = 9.81, degree = 3.14159265358979323846 / 180;
  const auto on_slope = [&](double slope, std::vector<std::string> more) {
    const double down = g * std::sin(slope * degree), across = g * std::cos(slope * degree);
    const std::string vertical = number(-2000 * across) + " * (1 - y)", lateral = vertical + " * 3 / 7";
    more.insert(more.end(),
                {"rigid.block.density=1500", "gravity=[" + number(down) + ", " + number(-across) + "]",
                 "body.soil.stress=[\"" + lateral + "\", \"" + vertical + "\", \"" + lateral + "\", \"0\"]"});
    return rung.run(more).history;
  };
  const auto column = [](const HistoryTable &history, const char *name) { return history.column(name).back(); };

  const HistoryTable falls = rung.run({"rigid.block.density=1500", "stage.0.duration=0.3",
                                       "rigid.block.polygon=[[0.5, 1.5], [1, 1.5], [1, 1.9]]"})
                                 .history;
  rung.compare("way of a free fall [m]", -g * 0.09 / 2, column(falls, "block_y_m") - falls.column("block_y_m").front(),
               0.01);

  const HistoryTable rests = on_slope(0, {"stage.0.damping=0.5"});
  rung.compare("force of the soil at rest [N]", 1500 * 0.5 * g, column(rests, "block_force_y_N"), 1e-3);
  rung.compare("its sinking after 0.3 s, of its height", 0,
               (column(rests, "block_y_m") - at_time(rests, "block_y_m", 0.3)) / 0.5, 1e-6, 1);

  const double driving = g / 2, slides = g * (0.5 - std::tan(20 * degree) * std::cos(30 * degree));
  const HistoryTable sliding = on_slope(30, {});
  rung.compare(
      "acceleration, slope of 30 deg, friction of 20 deg, over g sin 30 deg", slides / driving,
      (column(sliding, "block_velocity_x_m_s") - at_time(sliding, "block_velocity_x_m_s", 0.2)) / 0.3 / driving, 0.02,
      1);
  const HistoryTable sticking = on_slope(15, {"stage.0.damping=0.5"});
  rung.compare("velocity after 0.5 s, slope of 15 deg, friction of 20 deg, over g sin 15 deg 0.5 s", 0,
               column(sticking, "block_velocity_x_m_s") / (g * std::sin(15 * degree) * 0.5), 1e-3, 1);

  const std::string slender = "rigid.block.polygon=[[0.7, 1], [1.3, 1], [1.3, 2.8], [0.7, 2.8]]";
  const HistoryTable topples = on_slope(25, {slender, "rigid.block.friction_angle=35", "stage.0.duration=0.9"});
  rung.compare(
      "time to topple from 10 to 30 deg [s]", toppling_time(0.6, 1.8, 25 * degree, 10 * degree, 30 * degree),
      time_when_below(topples, "block_rotation_deg", -30) - time_when_below(topples, "block_rotation_deg", -10), 0.02);

  const auto wall = [&](const std::string &velocity) {
    return rung
        .run({"mesh.section=../../../meshes/rigid_wall.csv", "boundary.base.kind=roller", "body.soil.law=mohr_coulomb",
              "body.soil.cohesion=0", "body.soil.friction_angle=30", "body.soil.dilation_angle=30",
              "body.soil.stress=[\"-9810 * (1 - y)\", \"-19620 * (1 - y)\", \"-9810 * (1 - y)\", \"0\"]",
              "rigid.block.polygon=[[-0.3, -0.1], [0, -0.1], [0, 1.3], [-0.3, 1.3]]", "rigid.block.friction_angle=0",
              "rigid.block.velocity=[\"" + velocity + " * min(1, t / 0.2)\", 0]", "stage.0.duration=0.7",
              "stage.0.damping=0.2"})
        .history;
  };
  rung.compare("smooth wall pushed into sand of 30 deg, over Rankine's K_p gamma H2 / 2", 1,
               -mean_between(wall("0.015"), "block_force_x_N", 0.5, 0.6) / (3 * 9810), 0.03);
  rung.compare("smooth wall drawn away from it, over K_a gamma H2 / 2", 1,
               -mean_between(wall("-0.01"), "block_force_x_N", 0.5, 0.6) / (9810. / 3), 0.03);

  constexpr double cell = 0.1, cohesion = 1e4;
  const auto footing = [&](double friction, double adhesion) {
    const HistoryTable history =
        rung.run({"mesh.section=../../../meshes/rigid_footing.csv", "mesh.size=0.5",
                  "mesh.refine=[{from = [0, 3.4], to = [1.8, 4], size = 0.1}]", "gravity=0",
                  "body.soil.law=mohr_coulomb", "body.soil.young_modulus=40e6", "body.soil.poisson_ratio=0.49",
                  "body.soil.cohesion=1e4", "body.soil.friction_angle=0",
                  "body.soil.stress=[\"0\", \"0\", \"0\", \"0\"]",
                  "rigid.block.polygon=[[-1, 4], [1, 4], [1, 4.4], [-1, 4.4]]",
                  "rigid.block.friction_angle=" + number(friction), "rigid.block.adhesion=" + number(adhesion),
                  "rigid.block.velocity=[0, \"-0.01 * min(1, t / 0.1)\"]", "stage.0.duration=0.7",
                  "stage.0.damping=0.5"})
            .history;
    return mean_between(history, "block_force_y_N", 0.6, 0.7) / cohesion;
  };
  const double smooth = footing(0, 0), rough = footing(60, 2e4), prandtl = 2 + std::acos(-1.);
  rung.compare("smooth footing, N_c for the half width 1 + h / 2", prandtl, smooth / (1 + cell / 2), 0.02);
  rung.compare("rough footing, N_c for the half width 1 + h / 2", prandtl, rough / (1 + cell / 2), 0.02);
  rung.report("rough footing, N_c for its own half width", prandtl, rough);
}

}  // namespace talus::rungs
