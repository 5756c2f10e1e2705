#pragma once
/// A damped elastic column stands still after 100 time constants tau of the relaxation, docs/theory (4.9) to (4.11):
/// exp(-100) of its first velocity is left, which is less than round-off.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void at_rest(Rung &rung) {
  const auto claim = [&](const std::string &name, const std::vector<std::string> &overrides, double tolerance = 1e-12) {
    const Run run = rung.run(overrides);
    const auto speed = [](const Snapshot &snapshot) {
      double largest = 0;
      for (double v : component(snapshot, "velocity", 0)) largest = std::max(largest, std::abs(v));
      for (double v : component(snapshot, "velocity", 1)) largest = std::max(largest, std::abs(v));
      return largest;
    };
    const double start = speed(run.start);
    const double energy = run.history.column("kinetic_J").front();
    rung.compare(name + ": largest velocity of a particle", 0, speed(run.end), tolerance, start);
    rung.compare(name + ": largest velocity of a node", 0, run.nodal_speed, tolerance, start);
    rung.compare(name + ": kinetic energy", 0, run.history.column("kinetic_J").back(), tolerance * tolerance, energy);
  };
  constexpr double E = 180e3, nu = 0.2, rho = 0.7 * 2650;
  const double wave_speed = std::sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho);
  // The smallest altitude is at most the edge of 0.1 m, so these are 100 time constants or more.
  const auto lasting = [&](double relaxation, std::vector<std::string> more) {
    more.push_back("transfer.relaxation=" + number(relaxation));
    more.push_back("stage.0.duration=" + number(100 * relaxation * 0.1 / wave_speed));
    return more;
  };
  for (const std::string interval : {"0", "0.001", "0.1", "0.3"})
    claim("2D, remap interval " + interval, in_dimension(2, lasting(40, {"transfer.remap_interval=" + interval})));
  claim("2D, default relaxation", in_dimension(2, lasting(400, {})));
  claim("3D", in_dimension(
                  3, lasting(40, {"body.soil.velocity=['0.5*sin(91*x+17*y+57*z)', '0.5*cos(73*y-29*x+57*z)', '0']"})));
  claim("2D, pic", in_dimension(2, lasting(40, {"transfer.velocity=pic"})));
  claim("2D, arkode", in_dimension(2, lasting(40, {"integrator.kind=arkode"})));
  claim("2D, forward-euler", in_dimension(2, lasting(40, {"integrator.kind=forward-euler"})));
  claim("2D, saturated",
        in_dimension(2, lasting(40, {"phases=saturated", "body.soil.permeability=1e-8", "water.bulk_modulus=1e6"})),
        1e-7);
}

}  // namespace talus::rungs
