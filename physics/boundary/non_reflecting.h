#pragma once
#include <vector>

#include "base/units.h"
#include "physics/boundary/kind.h"

namespace talus {

/// Dashpots that absorb waves arriving at a right angle to the face: rho c_p across it, rho c_s along it (Lysmer &
/// Kuhlemeyer 1969). Dashpots bear no load at rest. In quasi-static stages and in those that freeze loads
/// (`hold_loads`) a support stands in for them, and its reaction at the end of the stage remains as a dead load.
struct NonReflecting {
  static constexpr const char *name = "non_reflecting";
  static constexpr OnSoil in_motion = OnSoil::dashpot, quasi_static = OnSoil::support;
  static constexpr OnWater water = OnWater::surface;
  static constexpr OnGas gas = OnGas::surface;
  static constexpr int precedence = 2;
  enum class Support { roller, fixed, none };
  Support support = Support::roller;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice("support", support, {{"roller", Support::roller}, {"fixed", Support::fixed}, {"none", Support::none}},
             "support of the face in quasi-static stages and in stages with hold_loads = true; its reaction at their "
             "end acts as a dead load from then on");
  }

  /// Of the support that stands in for the dashpots.
  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &normal) const {
    if (support == Support::none) return {};
    if (support == Support::roller) return {normal};
    return all_axes<dim>();
  }
  /// rho c_p n n + rho c_s (1 - n n)
  template <int dim>
  Square<dim> dashpot(const std::array<double, 2> &impedance, const Vec<dim> &n) const {
    Square<dim> matrix;
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        matrix(i, j) = (impedance[0] - impedance[1]) * n[i] * n[j] + (i == j ? impedance[1] : 0);
    return matrix;
  }
};

}  // namespace talus
