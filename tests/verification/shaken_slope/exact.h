#pragma once
/// Slopes that keep their strength beside Newmark's sliding block (earthquake/newmark.h). Where a mechanism w yields at
/// the horizontal inertia k(w), power says of its acceleration under a shaking a that int rho w . w = (a - k(w) g) int
/// rho w_x. So the way of the block is int rho u . u / int rho u_x of the displacements u that a mechanism of one shape
/// has made, whatever its shape.
#include <cmath>

#include "earthquake/newmark.h"
#include "earthquake/sources.h"
#include "tests/verify/rung.h"

namespace talus::rungs {

inline void shaken_slope(Rung &rung) {
  constexpr double g = 9.81, degree = M_PI / 180;
  const auto downhill = [](const std::string &motion) {
    GroundMotion ground = read_motion(read_components("earthquake = [" + motion + "]")[0]);
    for (double &a : ground.acceleration) a = -a;
    return ground;
  };
  // of a mechanism, from the displacements; the ground moves along (x, y) of the scene
  const auto way = [](const Run &run, double x, double y) {
    const auto u = component(run.end, "displacement"), v = component(run.end, "displacement", 1),
               m = component(run.end, "mass");
    double energy = 0, along = 0;
    for (std::size_t p = 0; p < m.size(); ++p)
      energy += m[p] * (u[p] * u[p] + v[p] * v[p]), along += m[p] * (x * u[p] + y * v[p]);
    return energy / along;
  };
  // a layer of 1 m on the row of cells that yields, half of which moves with it; psi = phi
  constexpr double beta = 20 * degree, height = 1.05, density = 2000;
  struct Layer {
    const char *name;
    double cohesion, friction;  ///< [Pa], [deg]
    std::string motion;
  };
  const std::string pulses = "{kind = 'sine', amplitude = 2.6, frequency = 2, duration = 3, taper = 0.5",
                    noise = "{kind = 'kanai_tajimi', amplitude = 5, duration = 3.4, rise = 0.5, strong = 2";
  for (const Layer &one : {Layer{"Tresca, sine", 10e3, 0, pulses}, Layer{"Tresca, record", 10e3, 0, noise},
                           Layer{"Mohr-Coulomb, sine", 5e3, 16, pulses}}) {
    const double friction = std::tan(one.friction * degree);
    const double yield = (one.cohesion / (density * height) + g * (friction * std::cos(beta) - std::sin(beta))) /
                         (std::cos(beta) + friction * std::sin(beta));
    const std::string normal = number(-density * g * std::cos(beta)) + " * (1.1 - y)\"",
                      shear = "\"" + number(density * g * std::sin(beta)) + " * (1.1 - y)\"",
                      stress = ".stress=[\"" + normal + ", \"" + normal + ", \"" + normal + ", " + shear + "]";
    const Run run = rung.run(
        {"gravity=[" + number(g * std::sin(beta)) + ", " + number(-g * std::cos(beta)) + "]", "mesh.section=layer.csv",
         "mesh.size=0.1", "body.soil.young_modulus=2e8", "body.soil.cohesion=" + number(one.cohesion),
         "body.soil.friction_angle=" + number(one.friction), "body.soil.dilation_angle=" + number(one.friction),
         "body.soil" + stress,
         "body.layer={region='layer', density=2000, law='linear_elastic', young_modulus=2e8, poisson_ratio=0.35}",
         "body.layer" + stress, "boundary.sides.kind=tied",
         "earthquake=[" + one.motion + ", direction=[" + number(std::cos(beta)) + ", " + number(std::sin(beta)) + "]}]",
         "stage=[{duration=" + number(3.5) + ", earthquake=true}]"});
    rung.compare(std::string("infinite slope, ") + one.name + ": way [m]",
                 sliding_block(downhill(one.motion + "}"), yield).back(), way(run, std::cos(beta), std::sin(beta)),
                 0.05);
  }
  // a slope whose strength is divided by its factor under the inertia k, so that it yields at k
  constexpr double k = 0.165;
  const auto slope = [&](const std::string &name, double strength, double angle, const std::string &motion,
                         double size) {
    const auto soil = [&](double divisor) {
      const double friction = std::atan(std::tan(angle * degree) / divisor) / degree;
      return std::vector<std::string>{"mesh.size=" + number(size), "body.soil.cohesion=" + number(strength / divisor),
                                      "body.soil.friction_angle=" + number(friction),
                                      "body.soil.dilation_angle=" + number(friction)};
    };
    std::vector<std::string> still = soil(1), shaken;
    still.push_back(
        "stage=[{kind='quasi_static', duration=1}, {kind='quasi_static', duration=1, "
        "seismic_coefficient=[" +
        number(k) + ", 0]}]");
    shaken = soil(rung.factor_of_safety(still).value());
    shaken.push_back("earthquake=[" + motion + "]");
    rung.report(name + ", cells of " + number(size) + " m: way [m]", sliding_block(downhill(motion), k * g).back(),
                way(rung.run(shaken), 1, 0));
  };
  const std::string sine = "{kind='sine', amplitude=2.4, frequency=1, duration=4, taper=1}",
                    record =
                        "{kind='kanai_tajimi', amplitude=3, duration=4.4, ground_frequency=1.5, rise=0.5, strong=3}";
  slope("Tresca slope, sine", 46e3, 0, sine, 2);
  if (!rung.longer()) return;
  for (const double size : {1.4, 1., 0.7}) slope("Tresca slope, sine", 46e3, 0, sine, size);
  slope("Tresca slope, record", 46e3, 0, record, 1);
  for (const double size : {2., 1.4, 1.}) slope("Mohr-Coulomb slope, sine", 16e3, 25, sine, size);
}

}  // namespace talus::rungs
