#pragma once
#include <vector>

#include "base/vec.h"

namespace talus {

/// No motion across the face; also on oblique faces, one direction per facet normal.
struct Roller {
  static constexpr const char *name = "roller";
  template <class Visitor>
  void fields(Visitor &&) {}

  template <int dim>
  std::vector<Vec<dim>> directions(const Vec<dim> &normal) const {
    return {normal};
  }
};

}  // namespace talus
