#include "physics/soil_motion/cell_stress.h"

#include <algorithm>

#include "scene/transfer_source.h"

namespace talus {

template <int dim>
void CellStress<dim>::find(const FilledGrid<dim> &grid, const std::vector<PointSet> &points,
                           const std::vector<double *> &stress, const SoilState<dim> &state, Locking locking,
                           PatchMeans &patches) {
  constexpr int components = stress_size<dim>;
  const int cells = grid.cell_count();
  const double *particle_volume = state.particle_volume.data(), *weight = state.weight.data();
  std::fill_n(mean_.begin(), cells, std::array<double, components>{});
  for (size_t b = 0; b < points.size(); ++b) {
    const PointSet &p = points[b];
    const double *volume = state.volume[b];
    for (int q = 0; q < p.count; ++q) {
      auto &sum = mean_[p.cell[q]];
      const double share = volume[q] / particle_volume[p.cell[q]];
      for (int s = 0; s < components; ++s) sum[s] += share * stress[b][q * components + s];
    }
  }
  if (locking != Locking::patches) return;
  patches.find(grid, weight, [&](int c) { return weight[c] * (mean_[c][0] + mean_[c][1] + mean_[c][2]) / 3; });
  for (int c = 0; c < cells; ++c) {
    auto &s = mean_[c];
    const double correction = patches.of(grid.patch[c]) - (s[0] + s[1] + s[2]) / 3;
    for (int k = 0; k < 3; ++k) s[k] += correction;
  }
}

template class CellStress<2>;
template class CellStress<3>;

}  // namespace talus
