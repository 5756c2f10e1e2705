#pragma once
/// Pulses that reach a non-reflecting face: straight on, dashpots of rho c_p take all of their energy; at an angle they
/// reflect a part (Lysmer & Kuhlemeyer 1969).
#include "commands/rung.h"

namespace talus::rungs {

inline void leaving_waves(Rung &rung) {
  const auto energy = [](const Run &run) {
    const auto kinetic = run.history.column("kinetic_J"), strain = run.history.column("strain_J");
    return (kinetic.back() + strain.back()) / (kinetic.front() + strain.front());
  };
  for (const int dimension : {2, 3}) {
    const std::string space = name_of(dimension) + " ";
    std::vector<std::string> more{"mesh.size=" + number(dimension == 2 ? 0.0125 : 0.025)};
    if (dimension == 3)
      more.insert(more.end(), {"body.soil.velocity=[\"-0.001 * exp(-((x - 0.5) / 0.1)^2)\", \"0 * x\", \"0 * x\"]",
                               "body.soil.stress=[\"-10 * exp(-((x - 0.5) / 0.1)^2)\", \"0\", \"0\", \"0\", \"0\", \"0\"]"});
    rung.compare(space + "energy left, non-reflecting end", 0, energy(rung.run(in_dimension(dimension, more))), 0.01, 1);
    more.push_back("boundary.left.kind=roller");
    rung.compare(space + "energy left, fixed end", 1, energy(rung.run(in_dimension(dimension, more))), 0.02, 1);
  }
  // a ring of pressure from the middle of a square: it meets the faces at 0 to 45 degrees
  const std::string ring = " * exp(-((x - 0.5)^2 + (y - 0.5)^2) / 0.01)";
  const std::vector<std::string> square{"mesh.section=../../../meshes/box.csv", "mesh.size=0.02", "body.soil.poisson_ratio=0.25",
                                        "body.soil.stress=[\"0\", \"0\", \"0\", \"0\"]",
                                        "body.soil.velocity=[\"0.01 * (x - 0.5)" + ring + "\", \"0.01 * (y - 0.5)" + ring + "\"]",
                                        "stage.0.duration=0.15"};
  const auto with = [&](const std::string &kind) {
    std::vector<std::string> all = square;
    for (const char *side : {"left", "right", "base", "surface"}) all.push_back(std::string("boundary.") + side + ".kind=" + kind);
    return energy(rung.run(all));
  };
  rung.compare("2D energy left, ring in a square, non-reflecting", 0, with("non_reflecting"), 0.03, 1);
  rung.report("2D energy left, ring in a square, rollers", 1, with("roller"), 1);
}

}  // namespace talus::rungs
