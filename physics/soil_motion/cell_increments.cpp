#include "physics/soil_motion/cell_increments.h"

#include <algorithm>

#include "scene/transfer_source.h"

namespace talus {

template <int dim>
CellIncrements<dim>::CellIncrements(int cells) {
  make_room(increment, cells), make_room(volume_strain, cells);
}

template <int dim>
WorstCell CellIncrements<dim>::find(const FilledGrid<dim> &grid, const Vec<dim> *u, const SoilState<dim> &from,
                                    const double *slenderness, SoilState<dim> &to) {
  return deform_cells<dim>(grid, u, to.position, from.shape, slenderness, to.shape, increment.data(),
                           volume_strain.data());
}

template <int dim>
void CellIncrements<dim>::take_mean(int c, double mean) {
  const double correction = (mean - volume_strain[c]) / 3;
  for (int k = 0; k < 3; ++k) increment[c].strain[k] += correction;
  volume_strain[c] = mean;
}

template <int dim>
PetscErrorCode CellIncrements<dim>::smooth_volume_strain(Locking locking, FilledGrid<dim> &grid, const double *weight,
                                                         const Shape<dim> *shape, PatchMeans &patches,
                                                         std::vector<double> &nodal) {
  PetscFunctionBeginUser;
  const int cells = grid.cell_count();
  if (locking == Locking::patches) {  // F-bar: one mean per patch, weighted as in the forces, theory (4.7)
    patches.find(grid, weight, [&](int c) { return weight[c] * volume_strain[c]; });
    for (int c = 0; c < cells; ++c) take_mean(c, patches.of(grid.patch[c]));
  } else if (locking == Locking::nodal) {
    std::fill_n(nodal.begin(), 2 * grid.node_count(), 0.);
    for (int c = 0; c < cells; ++c)
      for (int i : shape[c].node) {
        nodal[2 * i] += shape[c].volume;
        nodal[2 * i + 1] += shape[c].volume * volume_strain[c];
      }
    PetscCall(grid.sum(nodal.data(), 2));
    for (int c = 0; c < cells; ++c) {
      double mean = 0;
      for (int i : shape[c].node) mean += nodal[2 * i + 1] / nodal[2 * i] / (dim + 1);
      take_mean(c, mean);
    }
  }
  PetscFunctionReturn(0);
}

template struct CellIncrements<2>;
template struct CellIncrements<3>;

}  // namespace talus
