#pragma once
/// Pressures as functions of the masses in the pores, docs/theory/pores.md section 3. Water and gas are stored as mass
/// per pore volume, so they are conserved however large a step; Newton's iteration, bracketed, from the gas share of
/// the last step.
#include <algorithm>
#include <cmath>

#include "physics/pores/fluids.h"
#include "physics/pores/soil_pores.h"

namespace talus {

struct PorePressures {
  double liquid = 0, gas = 0;  ///< P_l, P_g [Pa], gauge
};

/// Gas share below which soil counts as saturated: the pressure of its gas means nothing then [-].
inline constexpr double residual_gas = 1e-4;
/// Gas share at which the pressure of the gas follows from that of the liquid and not from its mass [-].
inline constexpr double no_gas = 1e-6 * residual_gas;

/// A few points side by side, so that their iterations run in vector registers. A lane does not depend on the
/// others.
template <int lanes>
struct PoreLanes {
  double liquid_content[lanes], gas_content[lanes];  ///< m_a / (n V) [kg/m3]
  double gas_share[lanes];                           ///< S_g: where the iteration starts, and its result
  double liquid[lanes], gas[lanes];                  ///< P_l, P_g [Pa], gauge
  int iterations[lanes];
};
inline constexpr int most_iterations = 100;

/// Pores full of liquid, or of liquid and its vapour where it cavitates, (3.1); the vapour's share takes the place of
/// the gas's.
template <int lanes>
inline void saturated_pressures(const Liquid &liquid, PoreLanes<lanes> &p) {
  liquid.with_compression([&](const auto &law) {
    // a liquid much softer than water has no density at which it would cavitate
    const double over_thinnest = 1 / std::max(law.density_at(cavitation_pressure), 1e-300);
#pragma omp simd
    for (int i = 0; i < lanes; ++i) {
      p.liquid[i] = std::max(law.pressure_at(p.liquid_content[i]), cavitation_pressure);
      p.gas_share[i] = std::max(0., 1 - p.liquid_content[i] * over_thinnest);
    }
  });
}

/// Gas at atmospheric pressure: S_l rho_l(-s(S_l)) = content; a gas share of 0 in saturated soil.
template <int lanes>
inline void unsaturated_pressures(const SoilPores &soil, const Liquid &liquid, PoreLanes<lanes> &p) {
  liquid.with_compression([&](const auto &law) {
    const double largest = soil.largest_gas_share(), full = law.density_at(-soil.entry());
    double low[lanes], high[lanes], open[lanes];
#pragma omp simd
    for (int i = 0; i < lanes; ++i) {
      const bool saturated = p.liquid_content[i] >= full;
      low[i] = 0, high[i] = largest, open[i] = saturated ? 0 : 1, p.iterations[i] = 0;
      p.gas_share[i] = saturated ? 0 : std::clamp(p.gas_share[i], 1e-12 * largest, (1 - 1e-12) * largest);
      p.liquid[i] = law.pressure_at(p.liquid_content[i]), p.gas[i] = 0;
    }
    double left = 1;
    for (int round = 0; round < most_iterations && left > 0; ++round) {
      left = 0;
#pragma omp simd reduction(+ : left)
      for (int i = 0; i < lanes; ++i) {
        const double y = p.gas_share[i], content = p.liquid_content[i];
        const SoilPores::State state = soil.at(y);
        const double rho = law.density_at(-state.suction), f = (1 - y) * rho - content;
        const double a = f > 0 ? y : low[i], b = f > 0 ? high[i] : y;
        const double next = y + f / (rho + (1 - y) * law.density_slope(rho) * state.slope);
        const double taken = next >= a && next <= b ? next : (a + b) / 2, moved = std::abs(taken - y);
        const double pressure =
            -state.suction -
            state.slope *
                (taken - y);  // first order in the last correction, which is then below round-off of the content
        const bool turns = open[i] > 0;
        low[i] = a, high[i] = b;
        p.gas_share[i] = turns ? taken : y, p.liquid[i] = turns ? pressure : p.liquid[i];
        p.iterations[i] += turns;
        // the square of the last correction is what the quadratic convergence leaves
        open[i] = turns && moved > 1e-7 * std::min(taken, largest - taken) + 1e-14 ? 1 : 0;
        left += open[i];
      }
    }
  });
}

/// Liquid and gas: P_g(c_g / y) - P_l(c_l / (1 - y)) = s(y) in the gas share y, which has one root (both sides are
/// monotone).
template <int lanes>
inline void three_phase_pressures(const SoilPores &soil, const Liquid &liquid, const PoreGas &gas,
                                  PoreLanes<lanes> &p) {
  liquid.with_compression([&](const auto &law) {
    const double largest = soil.largest_gas_share(), gas_slope = gas.bulk_modulus / gas.density;
    double low[lanes], high[lanes], open[lanes];
#pragma omp simd
    for (int i = 0; i < lanes; ++i) {
      low[i] = 0, high[i] = largest, open[i] = 1, p.iterations[i] = 0;
      p.gas_share[i] = std::clamp(p.gas_share[i], 1e-12 * largest, (1 - 1e-12) * largest);
    }
    double left = 1;
    for (int round = 0; round < most_iterations && left > 0; ++round) {
      left = 0;
#pragma omp simd reduction(+ : left)
      for (int i = 0; i < lanes; ++i) {
        const double y = p.gas_share[i], over_wet = 1 / (1 - y), over_y = 1 / y;
        const SoilPores::State state = soil.at(y);
        const double rho_l = p.liquid_content[i] * over_wet, rho_g = p.gas_content[i] * over_y;
        const double f = gas.pressure_at(rho_g) - law.pressure_at(rho_l) - state.suction;
        const double a = f > 0 ? y : low[i], b = f > 0 ? high[i] : y;
        const double slope = -gas_slope * rho_g * over_y - rho_l * over_wet / law.density_slope(rho_l) - state.slope;
        // y f is nearly linear where gas is trapped, f itself where it is not: the smaller slope is the safer one
        const double scaled = y * slope + f, next = y - (scaled < 0 ? y * f : f) / (scaled < 0 ? scaled : slope);
        const double inside = a > 0 ? std::sqrt(a * b) : b < 1e-3 ? 0.1 * b : (a + b) / 2;
        const double taken = next >= a && next <= b ? next : inside, moved = std::abs(taken - y);
        const bool turns = open[i] > 0;
        low[i] = a, high[i] = b;
        p.gas_share[i] = turns ? taken : y;
        p.iterations[i] += turns;
        open[i] = turns && moved > 1e-7 * std::min(taken, largest - taken)
                      ? 1
                      : 0;  // its square is what the quadratic convergence leaves
        left += open[i];
      }
    }
#pragma omp simd
    for (int i = 0; i < lanes; ++i) {
      const double y = p.gas_share[i], suction = soil.suction(y);
      p.liquid[i] = law.pressure_at(p.liquid_content[i] / (1 - y));
      // where hardly any gas is left its density is that of two vanishing numbers
      p.gas[i] = y > no_gas ? gas.pressure_at(p.gas_content[i] / y) : p.liquid[i] + suction;
    }
  });
}

/// The naive form for gas at atmospheric pressure, docs/theory/pores.md (3.5): from `pressure` [Pa] on at its rate,
/// with the storage that it has there, as the liquid per pore volume becomes `content`; what the curve gives where that
/// leads takes its place [kg/m3].
inline double content_by_rate(const SoilPores &soil, const Liquid &liquid, double pressure, double content) {
  const auto at = [&](double p) { return p < -soil.entry() ? saturation(soil.retention(), -p) : 1; };
  const double wet = at(pressure), rho = liquid.density_at(pressure),
               capacity = wet < 1 ? 1 / soil.at(1 - wet).slope : 0;
  const double next = pressure + (content / rho - wet) / (wet * liquid.density_slope(rho) / rho + capacity);
  return at(next) * liquid.density_at(next);
}

/// Symmetric storage matrix of dP_l, dP_g per pore volume change, docs/theory/pores.md (3.4), all over n [1/Pa]: ll,
/// lg, gg.
struct StorageTangent {
  double ll, lg, gg;
};
inline StorageTangent storage_tangent(const SoilPores &soil, const Liquid &liquid, const PoreGas &gas,
                                      const PorePressures &p, double gas_share) {
  const double y = std::max(gas_share, no_gas), rho_l = liquid.density_at(p.liquid), rho_g = gas.density_at(p.gas);
  const double capacity = 1 / std::max(soil.at(y).slope, 1e-300);  // -dS_l/ds
  return {(1 - y) * liquid.density_slope(rho_l) / rho_l + capacity, -capacity,
          y * gas.density_slope() / rho_g + capacity};
}

}  // namespace talus
