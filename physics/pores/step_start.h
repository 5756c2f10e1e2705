#pragma once
/// What the solve for implicit pore pressure finds at the start of a step.
#include "physics/boundary/prescribed_motion.h"
#include "transfer/filled_grid.h"

namespace talus {

template <int dim>
struct StepStart {
  FilledGrid<dim> &grid;
  const PrescribedMotion<dim> &supports;
  const Shape<dim> *shape;  ///< [cell]
  const double *weight;     ///< [cell]
  double step;              ///< [s]
};

}  // namespace talus
