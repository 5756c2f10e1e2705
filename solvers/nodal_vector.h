#pragma once
/// The state (u, v) of a motion as an N_Vector_Petsc of SUNDIALS with a norm of its own: on each rank it has an
/// entry for every node of the mesh, of which only those of the nodes that hold soil are used. So remaps change no
/// vector, and no step allocates. A node that ranks share has an entry on each of them, equal to the bit; algebra is
/// local, and only norms are summed over ranks. docs/theory/integrators.md, section 3.
#include <petscsys.h>
#include <sundials/sundials_nvector.h>

#include "physics/motion.h"

namespace talus {

/// What all vectors of one integration share: the motion, and how much error of the particles' places and velocities
/// counts as 1.
struct NodalSpace {
  Motion *motion;
  double displacement_tolerance;  ///< [m]
  double velocity_tolerance;      ///< [m/s]
  bool inverted = false;          ///< a stage since the last norm turned a cell of this rank inside out
  long long inversions = 0;       ///< norms that found so on some rank
};

/// An N_Vector of zeros, to be cloned at will. The space must outlive it and its clones, which end with N_VDestroy.
/// Collective.
PetscErrorCode make_nodal_vector(NodalSpace &space, SUNContext context, N_Vector *x);
void destroy_nodal_vector(N_Vector x);

/// `size()` doubles each: displacement [m] and velocity [m/s], or their rates.
double *displacement_of(N_Vector y);
double *velocity_of(N_Vector y);

/// Root mean square over the soil's mass of the particles' share of a nodal error, over the tolerances,
/// docs/theory/integrators.md (3); far above 1 if a cell was turned inside out or the error is no number. Collective.
double error_norm(N_Vector error);

}  // namespace talus
