#pragma once
/// Pore pressure that is implicit in time, docs/theory/pores.md section 8: what its solve keeps at nodes and cells, and
/// the operator of the solve.
#include <vector>

#include "base/room.h"
#include "physics/boundary/prescribed_motion.h"
#include "physics/pores/conjugate_gradients.h"
#include "transfer/mass_matrix.h"

namespace talus {

template <int dim>
struct ImplicitPressure {
  using Array = std::vector<double>;

  ImplicitPressure(bool acts, int nodes, int cells) : acts(acts), gradients(acts ? nodes : 0) {
    if (!acts) return;
    for (Array *field : {&volume, &particle_volume, &acting, &held, &strain, &residual, &stiffness, &correction,
                         &diagonal, &solid, &apart, &supported, &porosity, &gap_solid, &gap_apart, &beyond_gap})
      make_room(*field, nodes);
    make_room(sums, 2 * static_cast<size_t>(nodes));
    for (Array *field : {&modulus, &unbounded}) make_room(*field, cells);
    for (auto *field : {&after_drag, &mapped}) make_room(*field, 2 * static_cast<size_t>(nodes));
    make_room(push, nodes);
    walls.reserve(nodes), gap_corners.reserve((dim + 1) * static_cast<size_t>(cells));
  }

  /// y = A x for pressures x at the nodes [Pa], theory of pores (8.5): the volume that the pores of the nodes lack
  /// after the strain by their forces in a step [m3]. `shape` and `weight` of the cells. Collective.
  PetscErrorCode apply(FilledGrid<dim> &grid, const PrescribedMotion<dim> &supports, const Shape<dim> *shape,
                       const double *weight, double step, const double *x, double *y);
  /// Its diagonal, but for what cells around a node cancel. Collective.
  PetscErrorCode find_diagonal(FilledGrid<dim> &grid, const Shape<dim> *shape, const double *weight, double step);
  /// Sum of w p grad N at the nodes for pressures p of nodes, of which a cell has the mean, into `push`. Collective.
  PetscErrorCode find_push(FilledGrid<dim> &grid, const Shape<dim> *shape, const double *weight,
                           const double *pressure);

  /// Sum of the pressures of the cells at the gaps times their shares, into `beyond_gap` [N m]. Collective.
  PetscErrorCode find_beyond_gaps(FilledGrid<dim> &grid, const Shape<dim> *shape, const double *weight,
                                  const double *pressure);

  /// A node at which boundaries fix the motion of the liquid against the skeleton.
  struct Wall {
    int node;
    PrescribedDirections<dim> along;
  };

  /// A corner of a cell at a gap between particles, and its share of the weight of the cell.
  struct GapCorner {
    int node, cell;
    double share;
  };

  bool acts;
  ConjugateGradients gradients;
  // cells
  Array modulus;    ///< - dP over the strain of the pores: K / n [Pa]
  Array unbounded;  ///< pressure by the content, also below that of cavitation [Pa]
  // nodes
  Array volume;           ///< sum of w / (d + 1) [m3]
  Array particle_volume;  ///< the same of the volumes of the particles [m3]
  Array acting;           ///< pressure that acts in the step [Pa]
  Array held;             ///< strain of the pores that has this pressure
  Array strain;           ///< that of the step
  Array residual;         ///< what the strain of the step lacks, times the volume [m3]
  Array stiffness;        ///< - dP over strain [Pa]
  Array correction;       ///< of the pressure that acts [Pa]
  Array solid, apart;     ///< velocity of the skeleton, and of the liquid against it, over an impulse of `push` [1/kg]
  Array supported;        ///< velocity of the liquid over an impulse of `push` where the skeleton is held [1/kg]
  Array porosity;         ///< share of `push` on the liquid
  Array diagonal, sums;
  std::vector<Vec<dim>> push;                ///< sum of w p grad N [N]
  std::vector<Vec<dim>> after_drag, mapped;  ///< velocities [field][node] [m/s]
  std::vector<Wall> walls;
  std::vector<GapCorner> gap_corners;
  const Vec<dim> *gap = nullptr;  ///< of a node: area of the gap over volume, theory of pores (5.1) [1/m]
  Array gap_solid, gap_apart;     ///< as `solid` and `apart`, over an impulse of a gap, which liquid and grains share
  Array beyond_gap;               ///< scratch at nodes
};

}  // namespace talus
