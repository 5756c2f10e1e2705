#pragma once
/// Column between smooth walls under a load q that moves its face by several cells: sigma = E_c ln(lambda) = -q, so the
/// face moves by H [exp(-q / E_c) - 1], and the base bears q times the width.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void loaded_face(Rung &rung) {
  constexpr double E = 180e3, nu = 0.2, q = 20e3, width = 0.3;
  const double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  const auto check = [&](const std::string &what, const std::string &face, const std::vector<std::string> &overrides) {
    const Run run = rung.run(overrides);
    rung.compare("2D " + what + ": way of the face [m]", std::exp(-q / modulus) - 1,
                 run.history.column(face + "_displacement_y_m").back(), 0.02);
    rung.compare("2D " + what + ": force on the base [N]", q * width, run.history.column("base_force_y_N").back(),
                 0.01);
  };
  check("pressure", "load", {});
  check("dead load", "dead",
        {"boundary.load.pressure=0", "boundary.dead.group=load", "boundary.dead.kind=traction",
         "boundary.dead.traction=[\"0\", \"-20e3 * min(1, t / 0.5)\"]"});
}

}  // namespace talus::rungs
