#pragma once
#include "physics/boundary/kind.h"

namespace talus {

/// No motion across the face; also on oblique faces, one direction per patch (node_normals.h).
struct Roller {
  static constexpr const char *name = "roller";
  static constexpr OnSoil in_motion = OnSoil::support, quasi_static = OnSoil::support;
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::wall;
  static constexpr int precedence = 2;
  template <class Visitor>
  void fields(Visitor &&) {}

  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &normal) const {
    return {normal};
  }
};

}  // namespace talus
