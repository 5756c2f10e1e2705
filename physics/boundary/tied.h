#pragma once
#include <vector>

#include "physics/boundary/kind.h"

namespace talus {

/// Two opposite sides that move alike, so that what leaves the mesh at one of them comes in at the other (Zienkiewicz,
/// Bicanic & Shen 1989): ground that goes on, where both sides have one height. In quasi-static stages and in those
/// that freeze loads (`hold_loads`) both are rollers; what these bear and the other side does not remains as a dead
/// load.
struct Tied {
  static constexpr const char *name = "tied";
  static constexpr OnSoil in_motion = OnSoil::tied, quasi_static = OnSoil::support;
  static constexpr OnWater water = OnWater::wall;
  static constexpr OnGas gas = OnGas::wall;
  static constexpr int precedence = 2;
  template <class Visitor>
  void fields(Visitor &&) {}

  /// Of the rollers that stand in.
  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &normal) const {
    return {normal};
  }
};

}  // namespace talus
