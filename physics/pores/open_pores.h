#pragma once
/// Open cells in the solve for implicit pressure, docs/theory/pores.md (8.6): cells of soil that may dry whose pressure
/// is not smoothed, since not all pores of their patch are nearly full. Each has a pressure of its own, which pushes
/// its liquid; the skeleton bears the mean of the patch and strains the pores by the mean of the patch, (4.3a), (4.7).
/// Where a cell has another integration volume than its particles, it shares its flux with the cells around, (4.8a).
#include <vector>

#include "base/lanes.h"
#include "physics/pores/pressure_matrices.h"
#include "physics/pores/step_start.h"

namespace talus {

template <int dim>
class OpenPores {
 public:
  using Array = std::vector<double>;
  using GapCorners = std::vector<typename PressureMatrices<dim>::GapCorner>;

  /// `patches`: the skeleton has one mean stress per patch of cells.
  OpenPores(bool acts, bool patches, const BackgroundMesh<dim> &mesh);

  /// Cells have `open`, `own_volume`, `beyond` and `saturation`. Collective.
  PetscErrorCode begin(const StepStart<dim> &at);
  /// Adds the forces of open cells that have the pressures `own` of their liquid and `mixture` on the skeleton, beside
  /// full cells with the pressures `nodal`, to those on the liquid and on the mixture. Collective.
  PetscErrorCode add_push(const StepStart<dim> &at, const double *nodal, const double *own, const double *mixture,
                          const GapCorners &corners, Quad *on_liquid, Quad *on_mixture);
  /// The adjoint: the rate at which velocities of the skeleton strain the pores of open cells, times their volumes
  /// [m3/s].
  void find_strain(const StepStart<dim> &at, const Quad *solid, double *strained);
  /// What fluxes take from the liquid of open cells [m3/s]; adds what these share with full ones to `nodal`.
  /// Collective.
  PetscErrorCode find_outflow(const StepStart<dim> &at, const Quad *flux, const GapCorners &corners, double *lost,
                              double *nodal);
  /// Volume strains of the cells become what they do to the liquid: S_l times the mean of the patch, times the volume.
  void take_means_over_patches(const StepStart<dim> &at, double *strain);

  bool acts;
  std::vector<char> open;  ///< [cell]
  std::vector<int> list;   ///< open cells
  Array own_volume;        ///< of the particles of a cell [m3]
  Array beyond;            ///< its integration volume beyond that, as far as it is shared [m3]
  Array saturation;        ///< S_l
  Array full_weight;       ///< integration volume; 0 in open cells [m3]

 private:
  PetscErrorCode find_pressures(const StepStart<dim> &at, const double *nodal, const double *own);
  Array pressure_, patch_weight_, patch_sum_, nodal_, volume_around_;
  bool patches_, shares_ = false;
};

}  // namespace talus
