#pragma once
#include <vector>

#include "base/vec.h"

namespace talus {

/// No motion.
struct Fixed {
  static constexpr const char *name = "fixed";
  template <class Visitor>
  void fields(Visitor &&) {}

  /// Directions in which a facet with normal n prescribes the velocity.
  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &) const {
    std::vector<Vec<dim>> axes(dim, Vec<dim>{});
    for (int d = 0; d < dim; ++d) axes[d][d] = 1;
    return axes;
  }
};

}  // namespace talus
