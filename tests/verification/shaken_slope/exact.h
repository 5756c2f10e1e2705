#pragma once
/// Slopes that keep their strength beside Newmark's sliding block (earthquake/newmark.h). Where a mechanism w yields at
/// the horizontal inertia k(w), power says of its acceleration under a shaking a that int rho w . w = (a - k(w) g) int
/// rho w_x. So the way of the block is int rho u . u / int rho u_x of the displacements u that a mechanism of one shape
/// has made, whatever its shape. What cells make of k is found from energies, in an acceleration that grows slowly.
#include <algorithm>
#include <cmath>

#include "earthquake/column_response.h"
#include "earthquake/newmark.h"
#include "earthquake/sources.h"
#include "tests/verify/rung.h"

namespace talus::rungs::shaken_slopes {

constexpr double g = 9.81, degree = M_PI / 180;

/// A motion of the scene, positive where its inertia points along x.
inline GroundMotion downhill(const std::string &motion) {
  GroundMotion ground = read_motion(read_components("earthquake = [" + motion + "]")[0]);
  for (double &a : ground.acceleration) a = -a;
  return ground;
}

/// Moments of the displacements at the end of a run; the ground has moved along (x, y) of the scene.
struct Moved {
  double square = 0, along = 0;  ///< int rho u . u, int rho u_x
  double way() const { return square / along; }
};
inline Moved moved(const Run &run, double x = 1, double y = 0) {
  const auto u = component(run.end, "displacement"), v = component(run.end, "displacement", 1),
             m = component(run.end, "mass");
  Moved sums;
  for (std::size_t p = 0; p < m.size(); ++p)
    sums.square += m[p] * (u[p] * u[p] + v[p] * v[p]), sums.along += m[p] * (x * u[p] + y * v[p]);
  return sums;
}

/// k g of a slope over the way that it has gone.
struct Resistance {
  std::vector<double> way, acceleration;
  double at(double x) const {
    const auto after = static_cast<std::size_t>(std::upper_bound(way.begin(), way.end(), x) - way.begin());
    if (after == 0 || after == way.size()) return after ? acceleration.back() : acceleration.front();
    const double share = (x - way[after - 1]) / (way[after] - way[after - 1]);
    return std::lerp(acceleration[after - 1], acceleration[after], share);
  }
};

/// From the work of the inertia a, which is a int rho u_x, and from what of it becomes kinetic energy.
inline Resistance resistance_of(const Run &ramp) {
  constexpr double elastic = 0.002;  // way until cells yield [m]
  const Moved end = moved(ramp);
  const auto a = ramp.history.column("ground_acceleration_x_m_s2"), gravity = ramp.history.column("work_gravity_J"),
             height = ramp.history.column("potential_J"), kinetic = ramp.history.column("kinetic_J");
  Resistance found;
  double along = 0;
  for (std::size_t row = 1; row < a.size(); ++row) {
    const double inertia = -(a[row] + a[row - 1]) / 2;
    const double work = gravity[row] - gravity[row - 1] + height[row] - height[row - 1];
    if (!(inertia > 0 && work > 0)) continue;
    const double way = (along + work / inertia / 2) * end.square / (end.along * end.along);
    along += work / inertia;
    if (way < elastic) continue;
    found.way.push_back(way);
    found.acceleration.push_back(inertia * (1 - (kinetic[row] - kinetic[row - 1]) / work));
  }
  return found;
}

/// Newmark's block of that resistance.
inline double way_of_block(const GroundMotion &motion, const Resistance &resistance) {
  constexpr int parts = 20;  // of a step of the motion
  const double dt = motion.step / parts;
  double x = 0, v = 0;
  for (std::size_t k = 0; k + 1 < motion.acceleration.size() || v > 0; ++k)
    for (int part = 0; part < parts; ++part) {
      const double share = (part + 0.5) / parts;
      const double a =
          k + 1 < motion.acceleration.size() ? std::lerp(motion.acceleration[k], motion.acceleration[k + 1], share) : 0;
      v = std::max(0., v + dt * (a - resistance.at(x)));
      x += dt * v;
    }
  return x;
}

/// A layer of 1 m on the row of cells that yields, half of which moves with it.
struct Layer {
  const char *name;
  double cohesion, friction, dilation;  ///< [Pa], [deg]
  std::string motion;
  double damping;  ///< ratio of the soil [-]
};
inline std::vector<std::string> scene_of(const Layer &layer, double beta) {
  constexpr double density = 2000;
  const std::string normal = number(-density * g * std::cos(beta)) + " * (1.1 - y)\"",
                    shear = "\"" + number(density * g * std::sin(beta)) + " * (1.1 - y)\"",
                    stress = ".stress=[\"" + normal + ", \"" + normal + ", \"" + normal + ", " + shear + "]",
                    direction = "[" + number(std::cos(beta)) + ", " + number(std::sin(beta)) + "]",
                    ratio = ", damping_ratio=" + number(layer.damping);
  return {"gravity=[" + number(g * std::sin(beta)) + ", " + number(-g * std::cos(beta)) + "]",
          "mesh.section=layer.csv",
          "mesh.size=0.1",
          "body.soil.young_modulus=2e8",
          "body.soil.cohesion=" + number(layer.cohesion),
          "body.soil.friction_angle=" + number(layer.friction),
          "body.soil.dilation_angle=" + number(layer.dilation),
          "body.soil.damping_ratio=" + number(layer.damping),
          "body.soil" + stress,
          "body.layer={region='layer', density=2000, law='linear_elastic', young_modulus=2e8, poisson_ratio=0.35" +
              ratio + "}",
          "body.layer" + stress,
          "boundary.sides.kind=tied",
          "earthquake=[" + layer.motion + ", direction=" + direction + "}]",
          std::string("stage=[{duration=3.5, earthquake=true") +
              (layer.damping > 0 ? ", damping_frequencies=[0.05, 60]}]" : "}]")};
}

/// Soil with psi < phi slides with the strength of Davis (1968) along the slope, where inertia also lifts it: its way
/// is 1 + tan beta tan phi* times that of the block. With psi = phi the way of above has this already.
inline void compare_layer(Rung &rung, const Layer &layer, bool claims) {
  constexpr double beta = 20 * degree, height = 1.05, density = 2000;
  const double phi = layer.friction * degree, psi = layer.dilation * degree;
  const double davis = std::cos(psi) * std::cos(phi) / (1 - std::sin(psi) * std::sin(phi));
  const double cohesion = davis * layer.cohesion, friction = davis * std::tan(phi);
  const double yield = (cohesion / (density * height) + g * (friction * std::cos(beta) - std::sin(beta))) /
                       (std::cos(beta) + friction * std::sin(beta));
  const double lifted = psi < phi ? 1 + friction * std::tan(beta) : 1;
  const double exact = lifted * sliding_block(downhill(layer.motion + "}"), yield).back();
  const double way = moved(rung.run(scene_of(layer, beta)), std::cos(beta), std::sin(beta)).way();
  const std::string quantity = std::string("infinite slope, ") + layer.name + ": way [m]";
  claims ? rung.compare(quantity, exact, way, 0.05) : rung.report(quantity, exact, way);
}

/// A slope of 10 m on 2 m of ground. Its strength is divided by its factor under an inertia, so that it yields there.
struct Slope {
  const char *name;
  double cohesion, friction;  ///< before that [Pa], [deg]
  bool dilates;               ///< psi = phi, otherwise psi = 0
  std::string motion;
  double size, largest;  ///< of cells [m]; of the inertia that grows slowly over weight [-]
  double young_modulus = 1e9;
  bool vibrates = false;  ///< beside a block on an elastic layer
};
inline std::vector<std::string> soil_of(const Slope &slope, double divisor) {
  const double friction = std::atan(std::tan(slope.friction * degree) / divisor) / degree;
  return {"mesh.size=" + number(slope.size), "body.soil.young_modulus=" + number(slope.young_modulus),
          "body.soil.cohesion=" + number(slope.cohesion / divisor), "body.soil.friction_angle=" + number(friction),
          "body.soil.dilation_angle=" + number(slope.dilates ? friction : 0)};
}

inline Resistance resistance_of(Rung &rung, std::vector<std::string> soil, double largest) {
  soil.push_back("earthquake=[{kind='sine', scale=-1, frequency=0.03125, duration=5, amplitude=" + number(largest * g) +
                 "}]");
  soil.push_back("stage.1.duration=5");
  soil.push_back("output.history_interval=0.05");
  return resistance_of(rung.run(soil));
}

inline void compare_slope(Rung &rung, const Slope &slope) {
  constexpr double k = 0.165, height = 12, density = 2000, shear = 2.7, damping = 0.01;
  std::vector<std::string> still = soil_of(slope, 1);
  still.push_back("stage=[{kind='quasi_static', duration=1}, {kind='quasi_static', duration=1, seismic_coefficient=[" +
                  number(k) + ", 0]}]");
  const std::vector<std::string> soil = soil_of(slope, rung.factor_of_safety(still).value());
  std::vector<std::string> shaken = soil;
  shaken.push_back("earthquake=[" + slope.motion + "]");
  const GroundMotion ground = downhill(slope.motion);
  const double way = moved(rung.run(shaken)).way(), wave = std::sqrt(slope.young_modulus / shear / density);
  const std::string name = std::string(slope.name) + ", cells of " + number(slope.size) + " m: ";
  rung.report(name + "way [m]", sliding_block(ground, k * g).back(), way);
  const Resistance resistance = resistance_of(rung, soil, slope.largest);
  for (const double x : {1., 20.})
    rung.report(name + "resistance after " + number(x) + " cm over weight [-]", k, resistance.at(x / 100) / g);
  const GroundMotion felt = slope.vibrates ? layer_response(ground, 4 * height / wave, damping) : ground;
  rung.compare(
      name + (slope.vibrates ? "way, block of this resistance on a layer [m]" : "way, block of this resistance [m]"),
      way_of_block(felt, resistance), way, 0.15);
}

}  // namespace talus::rungs::shaken_slopes

namespace talus::rungs {

inline void shaken_slope(Rung &rung) {
  using namespace shaken_slopes;
  const std::string pulses = "{kind = 'sine', amplitude = 2.6, frequency = 2, duration = 3, taper = 0.5",
                    noise = "{kind = 'kanai_tajimi', amplitude = 5, duration = 3.4, rise = 0.5, strong = 2";
  for (const Layer &layer :
       {Layer{"Tresca, sine", 10e3, 0, 0, pulses, 0}, Layer{"Tresca, record", 10e3, 0, 0, noise, 0},
        Layer{"Mohr-Coulomb, sine", 5e3, 16, 16, pulses, 0}})
    compare_layer(rung, layer, true);
  const std::string sine = "{kind='sine', amplitude=3.4, frequency=1, duration=4, taper=1}",
                    strong = "{kind='sine', amplitude=5, frequency=1, duration=4, taper=1}",
                    record =
                        "{kind='kanai_tajimi', amplitude=3, duration=4.4, ground_frequency=1.5, rise=0.5, strong=3}";
  compare_slope(rung, {"Tresca slope, sine", 46e3, 0, false, sine, 2, 0.36});
  if (!rung.longer()) return;
  compare_layer(rung, {"Mohr-Coulomb, psi = 0, damped, sine", 5e3, 16, 0, pulses, 0.01}, true);
  compare_layer(rung, {"Mohr-Coulomb, psi = 0, sine", 5e3, 16, 0, pulses, 0}, false);
  for (const double size : {1.4, 1.}) compare_slope(rung, {"Tresca slope, sine", 46e3, 0, false, sine, size, 0.36});
  for (const double size : {2., 1.4, 1.}) {
    compare_slope(rung, {"slope with psi = phi, sine", 16e3, 25, true, strong, size, 0.54});
    compare_slope(rung, {"slope with psi = 0, sine", 16e3, 25, false, sine, size, 0.43});
  }
  compare_slope(rung, {"Tresca slope, record", 46e3, 0, false, record, 1, 0.36, 1e9, true});
  compare_slope(rung, {"stiff Tresca slope, record", 46e3, 0, false, record, 1, 0.36, 1e10});
}

}  // namespace talus::rungs
