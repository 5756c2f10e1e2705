#pragma once
#include <vector>

#include "base/units.h"
#include "base/vec.h"

namespace talus {

/// Dashpots that swallow waves arriving straight at the face: rho c_p across it, rho c_s along it (Lysmer & Kuhlemeyer
/// 1969). Dashpots carry no load at rest: in quasi-static stages and in those that hold loads a support stands in for
/// them, and the reaction it bore at their end acts on as a dead load.
struct NonReflecting {
  static constexpr const char *name = "non_reflecting";
  enum class Support { roller, fixed, none };
  Support support = Support::roller;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.choice("support", support, {{"roller", Support::roller}, {"fixed", Support::fixed}, {"none", Support::none}},
             "support of the face in quasi-static stages and in stages with hold_loads = true; its reaction at their "
             "end acts as a dead load from then on");
  }

  static constexpr bool while_loads_are_held = true;
  /// Directions in which a facet with normal n is held while loads are.
  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &normal) const {
    if (support == Support::none) return {};
    if (support == Support::roller) return {normal};
    std::vector<Vec<dim>> axes(dim, Vec<dim>{});
    for (int d = 0; d < dim; ++d) axes[d][d] = 1;
    return axes;
  }
};

}  // namespace talus
