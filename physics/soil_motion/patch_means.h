#pragma once
/// Means over the patches of cells that cure volumetric locking, docs/theory (4.7).
#include <vector>

#include "base/room.h"
#include "transfer/filled_grid.h"

namespace talus {

class PatchMeans {
 public:
  explicit PatchMeans(int patches) { make_room(weight_, patches), make_room(sum_, patches); }

  /// `weighted(cell)` is the value of a cell times its weight.
  template <int dim, class Weighted>
  void find(const FilledGrid<dim> &grid, const double *weight, Weighted weighted) {
    const int cells = grid.cell_count();
    for (int c = 0; c < cells; ++c) weight_[grid.patch[c]] = sum_[grid.patch[c]] = 0;
    for (int c = 0; c < cells; ++c) weight_[grid.patch[c]] += weight[c], sum_[grid.patch[c]] += weighted(c);
  }
  double of(int patch) const { return sum_[patch] / weight_[patch]; }

 private:
  std::vector<double> weight_, sum_;
};

}  // namespace talus
