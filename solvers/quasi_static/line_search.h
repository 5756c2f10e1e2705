#pragma once
/// The line search of Newton's method.
#include <petscsnes.h>

namespace talus {

/// Lets `solver` search along its steps by `type` whatever the units of its unknowns and residuals are. PETSc's
/// defaults end a search where residual times step is below 1e-15 of the step, and shorten steps that are longer than
/// 1e8: water in m3 and pressures in Pa are beyond both in ordinary soil.
inline PetscErrorCode set_line_search(SNES solver, SNESLineSearchType type) {
  constexpr PetscReal longest = 1e200, smallest_residual = 0;
  SNESLineSearch search;
  PetscFunctionBeginUser;
  PetscCall(SNESGetLineSearch(solver, &search));
  PetscCall(SNESLineSearchSetType(search, type));
  PetscCall(SNESLineSearchSetTolerances(search, PETSC_DEFAULT, longest, PETSC_DEFAULT, smallest_residual, PETSC_DEFAULT,
                                        PETSC_DEFAULT));
  PetscFunctionReturn(0);
}

}  // namespace talus
