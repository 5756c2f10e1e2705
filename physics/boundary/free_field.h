#pragma once
#include <vector>

#include "physics/boundary/kind.h"

namespace talus {

/// Sides at which level ground goes on: a column of the same soil is computed beside the mesh, whose two faces are tied
/// to each other. Its stress acts on the side, and dashpots between both absorb waves that come from the model
/// (Zienkiewicz, Bicanic & Shen 1989). In quasi-static stages and in those that freeze loads (`hold_loads`) rollers
/// stand in; what they bear beside the stress of the column remains as a dead load.
struct FreeField {
  static constexpr const char *name = "free_field";
  static constexpr OnSoil in_motion = OnSoil::dashpot, quasi_static = OnSoil::support;
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::wall;
  static constexpr int precedence = 2;
  static constexpr bool has_column = true;
  template <class Visitor>
  void fields(Visitor &&) {}

  /// Of the rollers that stand in.
  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &normal) const {
    return {normal};
  }
  template <int dim>
  Square<dim> dashpot(const std::array<double, 2> &impedance, const Vec<dim> &n) const {
    return absorbing<dim>(impedance, n);
  }
};

}  // namespace talus
