#pragma once
/// Pulses that reach a non-reflecting face: straight on, dashpots of rho c_p take all of their energy; at an angle they
/// reflect a part (Lysmer & Kuhlemeyer 1969).
#include "tests/verify/rung.h"

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
      more.insert(more.end(),
                  {"body.soil.velocity=[\"-0.001 * exp(-((x - 0.5) / 0.1)^2)\", \"0 * x\", \"0 * x\"]",
                   "body.soil.stress=[\"-10 * exp(-((x - 0.5) / 0.1)^2)\", \"0\", \"0\", \"0\", \"0\", \"0\"]"});
    rung.compare(space + "energy left, non-reflecting end", 0, energy(rung.run(in_dimension(dimension, more))), 0.01,
                 1);
    more.push_back("boundary.left.kind=free_field");
    rung.compare(space + "energy left, free-field end", 0, energy(rung.run(in_dimension(dimension, more))), 0.01, 1);
    more.back() = "boundary.left.kind=roller";
    rung.compare(space + "energy left, fixed end", 1, energy(rung.run(in_dimension(dimension, more))), 0.02, 1);
  }
  // a ring of pressure from the middle of a square: it meets the faces at 0 to 45 degrees
  const std::string ring = " * exp(-((x - 0.5)^2 + (y - 0.5)^2) / 0.01)";
  const std::vector<std::string> square{
      "mesh.section=../../../meshes/box.csv",
      "mesh.size=0.02",
      "body.soil.poisson_ratio=0.25",
      "body.soil.stress=[\"0\", \"0\", \"0\", \"0\"]",
      "body.soil.velocity=[\"0.01 * (x - 0.5)" + ring + "\", \"0.01 * (y - 0.5)" + ring + "\"]",
      "stage.0.duration=0.15"};
  const auto with = [&](const std::string &kind) {
    std::vector<std::string> all = square;
    for (const char *side : {"left", "right", "base", "surface"})
      all.push_back(std::string("boundary.") + side + ".kind=" + kind);
    return energy(rung.run(all));
  };
  rung.compare("2D energy left, ring in a square, non-reflecting", 0, with("non_reflecting"), 0.03, 1);
  rung.report("2D energy left, ring in a square, rollers", 1, with("roller"), 1);
  std::vector<std::string> between_columns = square;
  for (const auto &[side, kind] : {std::pair("left", "free_field"),
                                   {"right", "free_field"},
                                   {"base", "non_reflecting"},
                                   {"surface", "non_reflecting"}})
    between_columns.push_back(std::string("boundary.") + side + ".kind=" + kind);
  rung.compare("2D energy left, ring in a square, free-field sides", 0, energy(rung.run(between_columns)), 0.03, 1);
  // plane SV waves in ground that goes on behind tied sides: at an angle dashpots send back what the matching of
  // tractions says, |B|^2 = 0.0287 at 45 degrees for Poisson's ratio 0.25; the pressure wave dies out along the base
  const auto plane_wave = [&](bool oblique) {
    const std::string wave =
        (oblique ? "sin(12 * pi * (x - y))" : "sin(6 * pi * y)") + std::string(" * exp(-((y - 0.6) / 0.15)^2)");
    const double speed = std::sqrt(40.), impedance = 1000 * speed, a = 0.001;  // of the body below: E = 1e5, nu = 0.25
    const std::string v = number(oblique ? a / std::sqrt(2.) : a) + " * " + wave, none = "0 * x",
                      stress = number(a * impedance) + " * " + wave;
    return energy(rung.run(
        {"mesh.section=../../../meshes/box.csv", oblique ? "mesh.size=0.0125" : "mesh.size=0.02",
         "body.soil.poisson_ratio=0.25", "body.soil.velocity=[\"" + v + "\", \"" + (oblique ? v : none) + "\"]",
         oblique ? "body.soil.stress=[\"-" + stress + "\", \"" + stress + "\", \"0\", \"0\"]"
                 : "body.soil.stress=[\"0\", \"0\", \"0\", \"" + stress + "\"]",
         "boundary.base.kind=non_reflecting", "boundary.left.group=[\"left\", \"right\"]", "boundary.left.kind=tied",
         "boundary.surface.kind=non_reflecting", std::string("stage.0.duration=") + (oblique ? "0.26" : "0.18")}));
  };
  rung.compare("2D energy left, SV wave straight on, tied sides", 0, plane_wave(false), 0.02, 1);
  rung.report("2D energy left, packet of SV waves around 45 degrees, tied sides", 0.0287, plane_wave(true), 1);
  // a block under its weight: a support holds the base at first, then its reaction
  for (const int dimension : {2, 3}) {
    std::vector<std::string> block{"mesh.section=../../../meshes/box.csv",
                                   "mesh.size=0.1",
                                   "gravity=10",
                                   "body.soil.poisson_ratio=0.25",
                                   "body.soil.young_modulus=1e6",
                                   "boundary.base.kind=non_reflecting",
                                   "boundary.left.kind=roller",
                                   "boundary.right.group=right",
                                   "boundary.right.kind=roller",
                                   "boundary.surface.kind=traction",
                                   "boundary.surface.pressure=0",
                                   "stage.0.duration=3",
                                   "stage.0.until=equilibrium",
                                   "stage.0.gravity_ramp=0.1",
                                   "stage.0.damping=0.3",
                                   "stage.0.hold_loads=true",
                                   "stage.0.reset_displacement=true",
                                   "stage.1.duration=0.5"};
    for (const char *field : {"stress", "velocity"}) {
      const int components = field[0] == 's' ? (dimension == 2 ? 4 : 6) : dimension;
      std::string zeros;
      for (int k = 0; k < components; ++k) zeros += (k ? ", " : "") + std::string("\"0\"");
      block.push_back("body.soil." + std::string(field) + "=[" + zeros + "]");
    }
    const Run run = rung.run(in_dimension(dimension, block));
    double moved = 0;
    for (const double u : component(run.end, "displacement", 1)) moved = std::max(moved, std::abs(u));
    constexpr double modulus = 1e6 * 0.75 / (1.25 * 0.5), settlement = 1000 * 10 / modulus / 2;
    rung.compare(name_of(dimension) + " base that held and lets go: largest displacement over settlement by weight", 0,
                 moved / settlement, 0.03, 1);
  }
}

}  // namespace talus::rungs
