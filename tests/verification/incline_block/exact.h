#pragma once
/// Block on a plane inclined by beta: a = g (sin beta - tan phi_b cos beta) - c A / m while it slides, at rest when
/// this is negative. A friction angle that drops at t1 gives two constant accelerations.
#include <cmath>

#include "commands/rung.h"

namespace talus::rungs {

inline void incline_block(Rung &rung) {
  constexpr double g = 9.81, degree = 3.14159265358979323846 / 180, beta = 30 * degree, driving = g / 2,
                   mass_per_area = 1000;  // [kg/m2] of base
  const auto acceleration = [&](double phi, double adhesion) {
    return g * (std::sin(beta) - std::tan(phi * degree) * std::cos(beta)) - adhesion / mass_per_area;
  };
  // mean velocity down the plane at the end of a run [m/s]
  const auto speed = [](const Run &run) {
    const auto mass = component(run.end, "mass"), v = component(run.end, "velocity");
    double momentum = 0, total = 0;
    for (size_t p = 0; p < mass.size(); ++p) momentum += mass[p] * v[p], total += mass[p];
    return momentum / total;
  };
  for (const int dimension : {2, 3}) {
    const std::string space = name_of(dimension) + " ";
    const auto slide_run = [&](const std::string &friction, double adhesion, double duration, double damping) {
      std::vector<std::string> overrides{"boundary.base.friction_angle=" + friction,
                                         "boundary.base.adhesion=" + number(adhesion),
                                         "stage.0.duration=" + number(duration), "stage.0.damping=" + number(damping)};
      if (dimension == 3)
        overrides.insert(
            overrides.end(),
            {"gravity=[4.905, -8.495709211125343, 0]",
             "body.block.stress=[\"0\", \"-2000 * 8.495709211125343 * (0.5 - y)\", \"0\", \"0\", \"0\", \"0\"]"});
      return rung.run(in_dimension(dimension, overrides));
    };
    const auto slide = [&](const std::string &friction, double adhesion, double duration, double damping = 0) {
      return speed(slide_run(friction, adhesion, duration, damping));
    };
    // from 0.2 s on: until the shear stress at the base has built up, friction is less than it could be
    const auto measured = [&](const std::string &friction, double adhesion, double from, double to,
                              double damping = 0) {
      return (slide(friction, adhesion, to, damping) - slide(friction, adhesion, from, damping)) / (to - from);
    };
    const std::string drop = "[[0, 28], [0.7, 28], [0.700001, 15]]", of_driving = ", of g sin beta";
    rung.compare(space + "a, phi_b 20 deg" + of_driving, acceleration(20, 0) / driving,
                 measured("20", 0, 0.2, 1.5) / driving, 0.01, 1);
    rung.compare(space + "a, phi_b 28 deg" + of_driving, acceleration(28, 0) / driving,
                 measured(drop, 0, 0.2, 0.7) / driving, 0.01, 1);
    rung.compare(space + "a, dropped to 15 deg" + of_driving, acceleration(15, 0) / driving,
                 measured(drop, 0, 0.8, 1.5) / driving, 0.01, 1);
    rung.compare(space + "at rest, phi_b 35 deg, velocity over g sin beta t", 0, slide("35", 0, 1.5) / (1.5 * driving),
                 0.01, 1);
    rung.compare(space + "at rest, adhesion 6 kPa, velocity over g sin beta t", 0,
                 slide("0", 6000, 1.5) / (1.5 * driving), 0.01, 1);
    rung.compare(space + "a, phi_b 20 deg, adhesion 1 kPa" + of_driving, acceleration(20, 1000) / driving,
                 measured("20", 1000, 0.2, 1.5) / driving, 0.01, 1);
    rung.compare(space + "a, adhesion 3 kPa" + of_driving, acceleration(0, 3000) / driving,
                 measured("0", 3000, 0.2, 1.5) / driving, 0.01, 1);
    // ledger: friction and gravity along the way of the block's middle; the rest is what vibrations took
    const Run run = slide_run("20", 0, 1.5, 0);
    const auto mass = component(run.end, "mass"), way = component(run.end, "displacement");
    double sum = 0, total = 0;
    for (size_t i = 0; i < mass.size(); ++i) sum += mass[i] * way[i], total += mass[i];
    const double friction = run.history.column("work_base_J").back(),
                 gravity = run.history.column("work_gravity_J").back();
    const double width = total / 1000;  // 1 m in the plane, the slice's thickness in 3D
    rung.compare(space + "work of friction over its way [N]",
                 -mass_per_area * width * g * std::cos(beta) * std::tan(20 * degree), friction / (sum / total), 0.01);
    rung.compare(space + "work of gravity over its way [N]", total * driving, gravity / (sum / total), 0.01);
    rung.compare(space + "energy not accounted for, of the work of friction", 0,
                 run.history.column("dissipated_J").back() / friction, 0.02, 1);
    rung.report(space + "a, phi_b 20 deg, local damping 0.1" + of_driving, 0.9 * acceleration(20, 0) / driving,
                measured("20", 0, 0.2, 1.5, 0.1) / driving, 1);
  }
}

}  // namespace talus::rungs
