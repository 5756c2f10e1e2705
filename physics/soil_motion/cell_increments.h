#pragma once
/// Increments of deformation of the cells from the accepted state to the next one, docs/theory section 3.
#include <vector>

#include "physics/soil_motion/cell_deformation.h"
#include "physics/soil_motion/patch_means.h"
#include "physics/soil_motion/soil_state.h"
#include "scene/scene.h"

namespace talus {

enum class Locking;

template <int dim>
struct CellIncrements {
  explicit CellIncrements(int cells);

  /// What displacements `u`, from the state `from` to the nodes of the state `to`, make of the cells, theory (3.1),
  /// (3.2). `slenderness` as deform_cells has it.
  WorstCell find(const FilledGrid<dim> &grid, const Vec<dim> *u, const SoilState<dim> &from, const double *slenderness,
                 SoilState<dim> &to);
  /// Cures volumetric locking of the increments, theory (4.6), (4.7). `weight` [cell] is that of the accepted state,
  /// `shape` that of the cells at its end, `nodal` has room for two numbers per node. Collective.
  PetscErrorCode smooth_volume_strain(Locking locking, FilledGrid<dim> &grid, const double *weight,
                                      const Shape<dim> *shape, PatchMeans &patches, std::vector<double> &nodal);

  std::vector<Increment<dim>> increment;
  std::vector<double> volume_strain;

 private:
  void take_mean(int cell, double mean);
};

}  // namespace talus
