#pragma once
/// Boxes along the axes.
#include <algorithm>
#include <limits>

#include "base/vec.h"

namespace talus {

/// Least and largest coordinates [m]; empty at first.
template <int dim>
struct Box {
  Vec<dim> low = all(std::numeric_limits<double>::max()), high = all(std::numeric_limits<double>::lowest());

  /// Does the other box come as near as `reach` [m] along all axes but one, -1: along all?
  bool meets(const Box &other, double reach = 0, int but = -1) const {
    for (int d = 0; d < dim; ++d)
      if (d != but && (low[d] > other.high[d] + reach || other.low[d] > high[d] + reach)) return false;
    return true;
  }
  void enclose(const Box &other) {
    for (int d = 0; d < dim; ++d) low[d] = std::min(low[d], other.low[d]), high[d] = std::max(high[d], other.high[d]);
  }
  void enclose(const Vec<dim> &x) { enclose(Box{x, x}); }

 private:
  static Vec<dim> all(double value) {
    Vec<dim> x;
    x.fill(value);
    return x;
  }
};

}  // namespace talus
