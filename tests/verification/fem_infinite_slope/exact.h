#pragma once
/// Infinite slope at an angle b, failing along its base at the vertical depth z: F = c / (gamma z sin b cos b) +
/// tan(phi) / tan(b). Soil with psi = phi that slips along the base has a stress whose circle touches the yield line
/// there,
///     sigma_along = sigma_n (1 + 2 tan^2 phi_F) + 2 c_F tan phi_F,    c_F = c / F, tan phi_F = tan phi / F.
/// That stress, falling linearly to nothing at the surface, is in equilibrium and inside the yield surface everywhere
/// (it is convex): a piece whose ends carry it is as safe as the whole slope. With psi = 0 soil that slips along a
/// plane has its largest shear stress there (Davis 1968): tau = sigma_n sin phi_F + c_F cos phi_F, which is less.
#include <cmath>

#include "tests/verify/rung.h"

namespace talus::rungs {

inline void fem_infinite_slope(Rung &rung) {
  constexpr double degree = M_PI / 180, gamma = 20e3, thickness = 1,
                   share = 0.125;  // c over gamma z, as 5 kPa over 20 kN/m3 and 2 m
  for (const auto &[slope, phi] : {std::pair{20., 30.}, {30., 20.}}) {
    if (slope == 30 && !rung.longer()) break;
    const double b = slope * degree, depth = thickness / std::cos(b), cohesion = share * gamma * depth;
    const double exact = cohesion / (gamma * depth * std::sin(b) * std::cos(b)) + std::tan(phi * degree) / std::tan(b);
    const double friction = std::tan(phi * degree);
    const double normal = gamma * thickness * std::cos(b), shear = gamma * thickness * std::sin(b);  // at the base
    // With its ends under the stress of a slope of factor F, whose base carries sigma and tau; an earthquake of k pulls
    // horizontally, which has components along and normal to the slope.
    const auto factor = [&](double F, double sigma, double tau, double dilation, double k) {
      const double along = sigma * (1 + 2 * std::pow(friction / F, 2)) + 2 * cohesion / F * friction / F;
      const auto traction = [&](double side) {
        return "=[\"" + number(-side * along) + " * (1 - y)\", \"" + number(side * tau) + " * (1 - y)\"]";
      };
      return rung
          .factor_of_safety(
              {"gravity=[" + number(10 * std::sin(b)) + ", " + number(-10 * std::cos(b)) + "]",
               "body.soil.cohesion=" + number(cohesion), "body.soil.friction_angle=" + number(phi),
               "body.soil.dilation_angle=" + number(dilation), "boundary.left.traction" + traction(-1),
               "boundary.right.traction" + traction(1),
               "stage.0.seismic_coefficient=[" + number(k * std::cos(b)) + ", " + number(k * std::sin(b)) + "]"})
          .by_flow.at(dilation > 0 ? TrialFlow::associated : TrialFlow::davis)
          .value();
    };
    const std::string name = "slope of " + number(slope) + " deg, phi = " + number(phi) + " deg";
    rung.compare(name + ", psi = phi", exact, factor(exact, normal, shear, phi, 0), 0.03, 1);
    if (slope == 20) {  // the earthquake makes gravity larger and tilts it by atan k
      const double k = 0.15, tilted = b + std::atan(k), weight = gamma * thickness * std::hypot(1, k);
      const double sigma = weight * std::cos(tilted), tau = weight * std::sin(tilted);
      const double shaken = (cohesion + sigma * friction) / tau;
      rung.compare(name + ", psi = phi, earthquake of 0.15 g", shaken, factor(shaken, sigma, tau, phi, k), 0.03, 1);
    }
    if (!rung.longer()) continue;
    double low = 0.1, high = exact;  // shear = normal sin phi_F + c_F cos phi_F
    for (int halving = 0; halving < 60; ++halving) {
      const double F = (low + high) / 2, reduced = std::atan(std::tan(phi * degree) / F);
      (normal * std::sin(reduced) + cohesion / F * std::cos(reduced) > shear ? low : high) = F;
    }
    rung.compare(name + ", psi = 0, by Davis", low, factor(exact, normal, shear, 0, 0), 0.05, 1);
  }
}

}  // namespace talus::rungs
