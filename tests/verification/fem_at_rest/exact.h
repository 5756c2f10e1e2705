#pragma once
/// A slope handed over in equilibrium keeps still: with elements that the motion of particles has too, forces on its
/// nodes vanish to the tolerance of Newton's iterations. Elements of second order leave what their stress is more than
/// those can balance.
#include <algorithm>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_at_rest(Rung &rung) {
  const auto largest = [&](const Run &run, double &speed, double &way) {
    speed = way = 0;
    const auto time = run.history.column("time_s");
    for (const char *point : {"crest", "face", "toe"}) {
      const auto v = run.history.column(std::string(point) + "_velocity_m_s"),
                 u = run.history.column(std::string(point) + "_displacement_m");
      for (size_t i = 0; i < time.size(); ++i)
        if (time[i] > 1) speed = std::max(speed, v[i]), way = std::max(way, u[i]);
    }
    for (int d = 0; d < 2; ++d) {
      for (double v : component(run.end, "velocity", d)) speed = std::max(speed, std::abs(v));
      for (double u : component(run.end, "displacement", d)) way = std::max(way, std::abs(u));
    }
  };
  double speed, way;
  struct Case {
    const char *name, *damping, *cohesion;  // 7 kPa: it yields in part; 1 MPa: it stays elastic
  };
  for (const auto &[name, damping, cohesion] : {Case{"yielding, without damping", "0", "7e3"},
                                                {"yielding, with damping 0.5", "0.5", "7e3"},
                                                {"elastic, without damping", "0", "1e6"},
                                                {"elastic, with damping 0.5", "0.5", "1e6"}}) {
    largest(rung.run({"stage.1.damping=" + std::string(damping), "body.soil.cohesion=" + std::string(cohesion)}), speed,
            way);
    // a sound wave of that speed carries a stress of a millionth of the weight; 1e-6 m is a ten-thousandth of what
    // gravity moved
    rung.compare(std::string(name) + ": largest speed in 10 s, m/s", 0, speed, 1e-6, 1);
    rung.compare(std::string(name) + ": largest displacement, m", 0, way, 1e-6, 1);
  }
  largest(rung.run({"quasi_static.elements=quadratic"}), speed, way);
  rung.report("from second order: largest speed, m/s", 0, speed, 1);
  rung.report("from second order: largest displacement, m", 0, way, 1);
}

}  // namespace talus::rungs
