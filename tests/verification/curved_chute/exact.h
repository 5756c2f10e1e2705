#pragma once
/// Rigid sector of a ring, R - h < r < R, 2 delta wide, sliding on the circle of radius R: with theta the angle of its
/// middle from the lowest point, J / m = (R^2 + (R - h)^2) / 2 and r_c the distance of its centre of mass from the
/// centre of the circle, J theta'' = -m g r_c sin theta -+ R tan phi_b N, N = m (g cos theta + r_c theta'^2). The angle
/// 2 delta is small, so that N is the sum of the normal stress.
#include <algorithm>
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

/// Angle of the middle of the block [rad] at a time, from rest.
inline double angle_in_valley(double radius, double height, double half_width, double start, double friction, double g,
                              double time) {
  const double inner = radius - height,
               centre = 2. / 3 * (std::pow(radius, 3) - std::pow(inner, 3)) / (radius * radius - inner * inner) *
                        std::sin(half_width) / half_width,
               mass_over_inertia = 2 / (radius * radius + inner * inner);
  constexpr double step = 1e-4;
  double angle = start, rate = 0;
  const auto acceleration = [&](double at, double turning) {
    const double normal = g * std::cos(at) + centre * turning * turning,
                 most = mass_over_inertia * radius * friction * normal,
                 driving = -mass_over_inertia * g * centre * std::sin(at);
    if (turning == 0 && std::abs(driving) <= most) return 0.;
    return driving - std::copysign(most, turning != 0 ? turning : driving);
  };
  for (int n = 0; n < std::lround(time / step); ++n) {  // midpoint rule
    const double half = rate + step / 2 * acceleration(angle, rate);
    double next = rate + step * acceleration(angle + step / 2 * rate, half);
    if (rate * next < 0) next = 0;  // it stops, and friction holds it or not
    angle += step * (rate + next) / 2, rate = next;
  }
  return angle;
}

inline void curved_chute(Rung &rung) {
  constexpr double degree = M_PI / 180, radius = 5, height = 0.25, start = 56 * degree, friction_angle = 20 * degree;
  const auto exact = [&](double time) {
    return angle_in_valley(radius, height, 4 * degree, start, std::tan(friction_angle), 9.81, time);
  };
  struct Place {
    double angle, height;  ///< of the centre of mass [rad]; over the circle [m]
  };
  const auto place = [&](const Snapshot &snapshot) {
    const auto mass = component(snapshot, "mass"), x = component(snapshot, "position", 0),
               y = component(snapshot, "position", 1);
    double sums[3]{};
    for (size_t p = 0; p < mass.size(); ++p) sums[0] += mass[p], sums[1] += mass[p] * x[p], sums[2] += mass[p] * y[p];
    const double across = sums[1] / sums[0], below = radius - sums[2] / sums[0];
    return Place{std::atan2(across, below), radius - std::hypot(across, below)};
  };
  const auto fastest = [&](const Snapshot &snapshot, int dimension) {  // component of the velocity of a particle [m/s]
    double speed = 0;
    for (int d = 0; d < dimension; ++d)
      for (const double v : component(snapshot, "velocity", d)) speed = std::max(speed, std::abs(v));
    return speed;
  };
  struct Mesh {
    int dimension, layers;
    double size;
  };
  for (const auto [dimension, layers, size] :
       {Mesh{2, 1, 0.12}, Mesh{2, 1, 0.09}, Mesh{3, 1, 0.12}, Mesh{3, 4, 0.12}}) {
    const std::string name = name_of(dimension) + (layers > 1 ? ", " + number(layers) + " layers" : "") +
                             ", cells of " + number(size) + " m, ";
    for (const double time : {1., 2.6}) {
      std::vector<std::string> more{"mesh.size=" + number(size), "stage.0.duration=" + number(time)};
      if (dimension == 3)
        more.insert(more.end(), {"gravity=[0, -9.81, 0]", "mesh.layers=" + number(layers),
                                 "mesh.thickness=" + number(layers * size)});
      const Run run = rung.run(in_dimension(dimension, more));
      const Place from = place(run.start), to = place(run.end);
      rung.compare(name + (time == 1 ? "way after 1 s" : "way to its place of rest") + " [deg]",
                   (start - exact(time)) / degree, (from.angle - to.angle) / degree, 0.004);
      if (time == 1) continue;
      rung.compare(name + "rise over the base in cells", 0, (to.height - from.height) / size, 0.1, 1);
      rung.compare(name + "fastest particle at rest [m/s]", 0, fastest(run.end, dimension), 0.04, 1);
    }
  }
}

}  // namespace talus::rungs
