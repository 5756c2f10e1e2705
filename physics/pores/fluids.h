#pragma once
/// The fluids in the pores, docs/theory/pores.md (1.2), (1.3). Pressures are gauge: 0 is the atmosphere's.
#include <cmath>

namespace talus {

struct Gas;
struct Water;

/// Pressure at which liquid that fills the pores cavitates, theory of pores (3.1): an atmosphere below the atmosphere's
/// [Pa].
inline constexpr double cavitation_pressure = -100e3;

struct Liquid {
  explicit Liquid(const Water &water);
  double density;       ///< rho_l0 at zero pressure [kg/m3]
  double bulk_modulus;  ///< K_l [Pa]
  double viscosity;     ///< mu_l [Pa s]
  bool exponential;     ///< rho_l0 exp(P / K_l), else rho_l0 (1 + P / K_l)

  /// One of the two laws (1.2), for loops that must not branch on it.
  template <bool exponential>
  struct Law {
    double density, bulk_modulus;
    double density_at(double p) const {
      return density * (exponential ? std::exp(p / bulk_modulus) : 1 + p / bulk_modulus);
    }
    double pressure_at(double rho) const {
      return bulk_modulus * (exponential ? std::log(rho / density) : rho / density - 1);
    }
    double density_slope(double rho) const { return (exponential ? rho : density) / bulk_modulus; }
  };
  /// Calls f(law).
  template <class F>
  auto with_compression(F &&f) const {
    return exponential ? f(Law<true>{density, bulk_modulus}) : f(Law<false>{density, bulk_modulus});
  }

  double density_at(double pressure) const {
    return with_compression([&](const auto &law) { return law.density_at(pressure); });
  }
  double pressure_at(double rho) const {
    return with_compression([&](const auto &law) { return law.pressure_at(rho); });
  }
  double density_slope(double rho) const {  ///< d rho / dP [kg/m3/Pa]
    return with_compression([&](const auto &law) { return law.density_slope(rho); });
  }
};

/// P = K (rho / rho_0 - 1): an ideal isothermal gas with K its absolute pressure at gauge 0, or a gas of any other bulk
/// modulus.
struct PoreGas {
  explicit PoreGas(const Gas &gas);
  double density;       ///< rho_g0 at gauge pressure 0 [kg/m3]
  double bulk_modulus;  ///< K_g [Pa]
  double viscosity;     ///< mu_g [Pa s]

  double density_at(double pressure) const { return density * (1 + pressure / bulk_modulus); }
  double pressure_at(double rho) const { return bulk_modulus * (rho / density - 1); }
  double density_slope() const { return density / bulk_modulus; }
};

}  // namespace talus
