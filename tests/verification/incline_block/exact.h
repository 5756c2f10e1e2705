#pragma once
/// Block on a plane inclined by beta: a = g (sin beta - tan phi_b cos beta) - c A / m while it slides, at rest when
/// this is negative. A friction angle that drops at t1 gives two constant accelerations. Friction that depends on the
/// slip of the base at a place, or on its heat, is integrated over the places that the block covers, docs/theory (6.7).
#include <cmath>
#include <functional>
#include <vector>

#include "tests/verify/rung.h"

namespace talus::rungs {

/// Mean acceleration between two times of a rigid block that slides from rest over places which remember it. At a place
/// friction is a (normal stress) - b; `a` and `b` depend on its slip and on its excess pressure p over the mean normal
/// stress, `rate` is dp / dslip. Friction at the base and inertia at half the height tilt the normal stress: linear
/// along the base, its middle shifted by friction over normal force times half the height.
struct RememberingBase {
  std::function<double(double slip)> a;
  std::function<double(double p)> b;
  std::function<double(double normal, double p)> rate;

  double mean_acceleration(double along, double across, double t0, double t1) const {
    constexpr double step = 5e-4, width = 0.005, length = 1, height = 0.5;
    std::vector<double> slip(1000, 0), p(1000, 0);
    double s = 0, v = 0, v0 = 0;
    for (int n = 0; n < std::lround(t1 / step); ++n) {
      if (n == std::lround(t0 / step)) v0 = v;
      double sum_a = 0, tilt_a = 0, sum_b = 0;
      int count = 0;
      const auto each = [&](auto &&visit) {
        for (int i = 0; i < 1000; ++i)
          if (const double xi = ((i + 0.5) * width - s) / length; xi > 0 && xi < 1) visit(i, xi - 0.5);
      };
      each([&](int i, double xi) { sum_a += a(slip[i]), tilt_a += a(slip[i]) * xi, sum_b += b(p[i]), ++count; });
      const double ratio = (sum_a - sum_b) / (count - 6 * height / length * tilt_a), tilt = 6 * height / length * ratio;
      v += step * (along - across * ratio), s += step * v;
      each([&](int i, double xi) { slip[i] += step * v, p[i] += step * v * rate(1 + tilt * xi, p[i]); });
    }
    return (v - v0) / (t1 - t0);
  }
};

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
    std::vector<std::string> more;  // overrides
    const auto slide_run = [&](const std::string &friction, double adhesion, double duration, double damping) {
      std::vector<std::string> overrides{"boundary.base.friction_angle=" + friction,
                                         "boundary.base.adhesion=" + number(adhesion),
                                         "stage.0.duration=" + number(duration), "stage.0.damping=" + number(damping)};
      overrides.insert(overrides.end(), more.begin(), more.end());
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
    if (dimension == 2) {
      constexpr double cold = 0.45, decay = 0.4;
      const double along = g * std::sin(beta), across = g * std::cos(beta);
      const auto none = [](auto...) { return 0.; };
      const RememberingBase weakens{[](double slip) { return 0.4 - 0.2 * slip; }, none, none};
      const std::string fine = "mesh.size=0.05";  // the rims of the block are known to a cell
      more = {fine};
      rung.compare(space + "a, tan phi_b = 0.4 - 0.2 slip" + of_driving,
                   weakens.mean_acceleration(along, across, 0.2, 1.2) / driving,
                   measured("180 / pi * atan(0.4 - 0.2 * slip)", 0, 0.2, 1.2) / driving, 0.02, 1);
      // undrained and adiabatic
      const RememberingBase heats{[](double) { return cold; }, [](double p) { return cold * p; },
                                  [](double normal, double p) { return (normal - p) / decay; }};
      more = {fine,
              "boundary.base.kind=heated_friction",
              "boundary.base.thickness=0.01",
              "boundary.base.heat_capacity=2.7e6",
              "boundary.base.thermal_conductivity=0",
              "boundary.base.hydraulic_conductivity=0",
              "boundary.base.storage=1e-9",
              "boundary.base.thermal_pressurisation=" + number(2.7e6 * 0.01 / (cold * decay))};
      rung.compare(space + "a, heated base, tan phi_b = 0.45, L* = 0.4 m" + of_driving,
                   heats.mean_acceleration(along, across, 0.2, 1.2) / driving,
                   measured("180 / pi * atan(0.45)", 0, 0.2, 1.2) / driving, 0.02, 1);
      more.clear();
    }
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
