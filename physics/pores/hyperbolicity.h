#pragma once
/// Are the equations of soil, water and gas hyperbolic at a state? Plane waves along one direction without drag,
/// docs/theory/pores.md (6.2): the squares of their speeds are the eigenvalues of M^-1 A. One that is negative or not
/// real lets the shortest waves grow fastest.
#include <Eigen/Core>

#include "base/eigenvalues.h"
#include "physics/pores/storage.h"

namespace talus {

/// Do all waves have a real speed? `modulus` is that of the skeleton in a confined compression [Pa]; gas at gauge 0,
/// liquid below it by the suction of the gas share. True where that suction leaves no liquid to speak of waves in, as
/// near the driest state under exponential compression. `gas_moves`: three phases; `bishop` as the scene's stress.
inline bool hyperbolic(const SoilPores &soil, const Liquid &liquid, const PoreGas &gas, double modulus,
                       double grain_density, double gas_share, bool gas_moves, bool bishop) {
  const double n = soil.porosity(), wet = 1 - gas_share;
  const PorePressures p{-soil.suction(gas_share), 0};
  const StorageTangent k = storage_tangent(soil, liquid, gas, p, gas_share);
  Eigen::Matrix3d waves = Eigen::Matrix3d::Zero();
  const Eigen::RowVector3d liquid_strain{wet * (1 - n) / n, wet, 0},
      gas_strain{gas_share * (1 - n) / n, 0, gas_share};   // over n
  Eigen::RowVector3d dl, dg = Eigen::RowVector3d::Zero();  // pressures per strain of solid, liquid, gas
  if (gas_moves) {
    const double det = k.ll * k.gg - k.lg * k.lg;
    dl = -(k.gg * liquid_strain - k.lg * gas_strain) / det, dg = -(k.ll * gas_strain - k.lg * liquid_strain) / det;
  } else {
    dl = -liquid_strain / k.ll;
  }
  const Eigen::RowVector3d pores =
      bishop ? Eigen::RowVector3d(wet * dl + gas_share * dg) : dg;  // gas has the larger pressure
  const Eigen::RowVector3d in_liquid = -n * wet * dl, in_gas = -n * gas_share * dg;
  waves.row(1) = in_liquid / (n * wet * liquid.density_at(p.liquid));
  if (gas_moves) waves.row(2) = in_gas / (n * gas_share * gas.density);
  waves.row(0) =
      (Eigen::RowVector3d(modulus, 0, 0) - pores - in_liquid - (gas_moves ? in_gas : Eigen::RowVector3d(0, 0, 0))) /
      ((1 - n) * grain_density);
  if (!waves.allFinite()) return true;
  const Eigen::VectorXcd squares = eigenvalues(waves);
  const double scale = squares.cwiseAbs().maxCoeff();
  for (int i = 0; i < 3; ++i)
    if (squares[i].real() < -1e-9 * scale || std::abs(squares[i].imag()) > 1e-7 * scale) return false;
  return true;
}

}  // namespace talus
