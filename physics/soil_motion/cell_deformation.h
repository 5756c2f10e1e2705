#pragma once
/// Deformation of cells by nodal displacements, docs/theory (3.1), (3.2), in blocks of `lanes` cells.
#include "physics/kinematics.h"
#include "transfer/filled_grid.h"

namespace talus {

/// The worst of the cells, for the length of the next step.
struct WorstCell {
  double slenderness = 1;  ///< largest sum of squared gradients of the shape functions over that at the remap
  double volume = 1;       ///< least volume over that in the mesh; not above -1 where a cell has turned inside out
  bool inverted = false;   ///< a cell has turned inside out
};

/// Displacements `u` lead from the shapes `from` to nodes at `position` [m]. Finds the shapes there (`to` may be
/// `from`), increment and volume strain of every cell; a cell that turns inside out gets no increment. `slenderness` is
/// the sum of squared gradients at the remap [1/m2].
template <int dim>
WorstCell deform_cells(const FilledGrid<dim> &grid, const Vec<dim> *u, const Vec<dim> *position, const Shape<dim> *from,
                       const double *slenderness, Shape<dim> *to, Increment<dim> *increment, double *volume_strain);

}  // namespace talus
