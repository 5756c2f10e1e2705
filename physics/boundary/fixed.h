#pragma once
#include "physics/boundary/kind.h"

namespace talus {

/// No motion.
struct Fixed {
  static constexpr const char *name = "fixed";
  static constexpr OnSoil in_motion = OnSoil::support, quasi_static = OnSoil::support;
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::wall;
  static constexpr int precedence = 1;
  template <class Visitor>
  void fields(Visitor &&) {}

  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &) const {
    return all_axes<dim>();
  }
};

}  // namespace talus
