#pragma once
/// Pressures that follow from what the pores hold, docs/theory/pores.md section 3. Water and gas are stored as mass per pore volume, so
/// they are conserved however large a step; Newton's iteration, bracketed, from the gas share of the last step.
#include <algorithm>
#include <cmath>

#include "physics/pores/fluids.h"
#include "physics/pores/soil_pores.h"

namespace talus {

struct PorePressures {
  double liquid = 0, gas = 0;  ///< P_l, P_g [Pa], gauge
  int iterations = 0;
};

/// Gas share below which soil counts as saturated: the pressure of its gas means nothing then [-].
inline constexpr double residual_gas = 1e-4;

/// Pores full of liquid of `content` = m_l / (n V) [kg/m3].
inline PorePressures saturated_pressure(const Liquid &liquid, double content) { return {liquid.pressure_at(content), 0, 0}; }

/// Gas at atmospheric pressure: S_l rho_l(-s(S_l)) = content. `gas_share` is the start and becomes the result; 0 in saturated soil.
inline PorePressures unsaturated_pressure(const SoilPores &soil, const Liquid &liquid, double content, double &gas_share) {
  if (content >= liquid.density_at(-soil.entry())) {
    gas_share = 0;
    return {liquid.pressure_at(content), 0, 0};
  }
  const double largest = soil.largest_gas_share();
  double low = 0, high = largest, y = std::clamp(gas_share, 1e-12 * high, (1 - 1e-12) * high);
  PorePressures p;
  while (p.iterations < 100) {
    ++p.iterations;
    const SoilPores::State state = soil.at(y);
    const double rho = liquid.density_at(-state.suction), f = (1 - y) * rho - content;
    (f > 0 ? low : high) = y;
    p.liquid = -state.suction;
    const double next = y + f / (rho + (1 - y) * liquid.density_slope(rho) * state.slope);
    const double taken = next >= low && next <= high ? next : (low + high) / 2;
    const double moved = std::abs(taken - y);
    p.liquid -= state.slope * (taken - y);  // first order in the last correction, which is then below round-off of the content
    y = taken;
    if (moved <= 1e-7 * std::min(y, largest - y) + 1e-14) break;  // its square is what the quadratic convergence leaves
  }
  gas_share = y;
  return p;
}

/// Liquid and gas: P_g(c_g / y) - P_l(c_l / (1 - y)) = s(y) in the gas share y, which has one root (both sides are monotone).
inline PorePressures three_phase_pressures(const SoilPores &soil, const Liquid &liquid, const PoreGas &gas, double liquid_content,
                                           double gas_content, double &gas_share) {
  const double largest = soil.largest_gas_share();
  double low = 0, high = largest, y = std::clamp(gas_share, 1e-12 * high, (1 - 1e-12) * high);
  PorePressures p;
  while (p.iterations < 100) {
    ++p.iterations;
    const SoilPores::State state = soil.at(y);
    const double rho_l = liquid_content / (1 - y), rho_g = gas_content / y;
    p.liquid = liquid.pressure_at(rho_l), p.gas = gas.pressure_at(rho_g);
    const double f = p.gas - p.liquid - state.suction;
    (f > 0 ? low : high) = y;
    const double slope = -gas.bulk_modulus / gas.density * rho_g / y - rho_l / (liquid.density_slope(rho_l) * (1 - y)) - state.slope;
    // y f is nearly linear where gas is trapped, f itself where it is not: the smaller slope is the safer one
    const double scaled = y * slope + f, next = y - (scaled < 0 ? y * f / scaled : f / slope);
    const double taken = next >= low && next <= high ? next : low > 0 ? std::sqrt(low * high) : high < 1e-3 ? 0.1 * high : (low + high) / 2;
    const double moved = std::abs(taken - y);
    y = taken;
    if (moved <= 1e-7 * std::min(y, largest - y)) break;  // its square is what the quadratic convergence leaves
  }
  gas_share = y;
  p.liquid = liquid.pressure_at(liquid_content / (1 - y)), p.gas = gas.pressure_at(gas_content / y);
  return p;
}

/// Symmetric storage matrix of dP_l, dP_g per pore volume change, docs/theory/pores.md (3.4), all over n [1/Pa]: ll, lg, gg.
struct StorageTangent {
  double ll, lg, gg;
};
inline StorageTangent storage_tangent(const SoilPores &soil, const Liquid &liquid, const PoreGas &gas, const PorePressures &p, double gas_share) {
  const double y = std::max(gas_share, residual_gas * 1e-6), rho_l = liquid.density_at(p.liquid), rho_g = gas.density_at(p.gas);
  const double capacity = 1 / std::max(soil.at(y).slope, 1e-300);  // -dS_l/ds
  return {(1 - y) * liquid.density_slope(rho_l) / rho_l + capacity, -capacity, y * gas.density_slope() / rho_g + capacity};
}

}  // namespace talus
