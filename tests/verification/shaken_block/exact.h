#pragma once
/// Block on a plane that is shaken along itself: Newmark's sliding block (earthquake/newmark.h), whose yield
/// acceleration is g (tan phi_b cos beta - sin beta) downhill and g (tan phi_b cos beta + sin beta) uphill.
#include <cmath>

#include "earthquake/newmark.h"
#include "earthquake/sources.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void shaken_block(Rung &rung) {
  constexpr double g = 9.81, degree = 3.14159265358979323846 / 180;
  const auto way = [](const Run &run) {  // mean way down the plane [m]
    const auto mass = component(run.end, "mass"), x = component(run.end, "displacement");
    double sum = 0, total = 0;
    for (size_t p = 0; p < mass.size(); ++p) sum += mass[p] * x[p], total += mass[p];
    return sum / total;
  };
  struct Case {
    const char *name;
    double slope, friction;  ///< [deg]
    std::string motion;      ///< overrides of [[earthquake]], as TOML
    double duration;
    int dimension;
  };
  const std::string
      sine = "{kind = 'sine', amplitude = 4, frequency = 2, duration = 3, taper = 0.5}",
      strong = "{kind = 'sine', amplitude = 6, frequency = 1.5, last_frequency = 3, duration = 3, taper = 0.3}",
      record = "{kind = 'kanai_tajimi', amplitude = 5, duration = 10, rise = 1, strong = 5}";
  for (const Case &one :
       {Case{"level, sweep", 0, 20, strong, 4, 2}, Case{"20 deg, sine", 20, 30, sine, 4, 2},
        Case{"20 deg, record", 20, 30, record, 10.5, 2}, Case{"20 deg, sine, 3D", 20, 30, sine, 4, 3}}) {
    const double beta = one.slope * degree, normal = g * std::cos(beta), along = g * std::sin(beta);
    const std::string down = number(-normal), weight = "\"-2000 * " + number(normal) + " * (0.2 - y)\"";
    const bool solid = one.dimension == 3;
    const Run run = rung.run(in_dimension(
        one.dimension,
        {"gravity=[" + number(along) + ", " + down + (solid ? ", 0]" : "]"),
         "body.block.stress=[\"0\", " + weight + (solid ? ", \"0\", \"0\", \"0\", \"0\"]" : ", \"0\", \"0\"]"),
         "boundary.base.friction_angle=" + number(one.friction), "earthquake=[" + one.motion + "]",
         "stage.0.duration=" + number(one.duration)}));
    GroundMotion motion = read_motion(read_components("earthquake = [" + one.motion + "]")[0]);
    for (double &a : motion.acceleration) a = -a;  // positive uphill
    const double tangent = std::tan(one.friction * degree);
    const std::vector<double> exact = sliding_block(motion, normal * tangent - along, normal * tangent + along);
    double most = 0;
    for (const double x : exact) most = std::max(most, std::abs(x));
    rung.compare(std::string(one.name) + ", way of the block [m]", exact.back(), way(run), 0.01, most);
  }
}

}  // namespace talus::rungs
