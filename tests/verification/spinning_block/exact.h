#pragma once
/// A block that spins freely keeps its linear and angular momentum and its centre of mass.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void spinning_block(Rung &rung) {
  struct Momentum {
    double x = 0, y = 0, spin = 0, mass = 0, momentum = 0;  // centre of mass, angular momentum about it, sums
  };
  const auto measure = [](const Snapshot &s) {
    const auto m = component(s, "mass"), x = component(s, "position", 0), y = component(s, "position", 1),
               vx = component(s, "velocity", 0), vy = component(s, "velocity", 1);
    Momentum sum;
    double px = 0, py = 0;
    for (size_t p = 0; p < m.size(); ++p)
      sum.mass += m[p], sum.x += m[p] * x[p], sum.y += m[p] * y[p], px += m[p] * vx[p], py += m[p] * vy[p];
    sum.x /= sum.mass, sum.y /= sum.mass, sum.momentum = std::hypot(px, py);
    for (size_t p = 0; p < m.size(); ++p) sum.spin += m[p] * ((x[p] - sum.x) * vy[p] - (y[p] - sum.y) * vx[p]);
    return sum;
  };
  const double speed = 5 * 0.25;  // of the middle of a face [m/s]
  const auto claim = [&](const std::string &which, const std::vector<std::string> &overrides, double loss) {
    const Run run = rung.run(overrides);
    const Momentum start = measure(run.start), end = measure(run.end);
    rung.compare(which + ": change of linear momentum over m V", 0,
                 std::abs(end.momentum - start.momentum) / (start.mass * speed), 1e-11, 1);
    rung.compare(which + ": drift of the centre of mass over the width", 0,
                 std::hypot(end.x - start.x, end.y - start.y) / 0.5, 1e-11, 1);
    rung.compare(which + ": angular momentum after two turns over the initial", 1, end.spin / start.spin, loss);
  };
  // tolerances of what is lost: README.md
  claim("default", {}, 0.3);
  claim("flip", {"transfer.relaxation=0"}, 0.12);
  claim("flip, half the cell size", {"transfer.relaxation=0", "mesh.size=0.025"}, 0.035);
}

}  // namespace talus::rungs
