#pragma once
/// Sparse matrices and their direct solution, the same to the bit whenever a run is repeated on as many ranks.
#include <petscksp.h>

#include <functional>

#include "base/owned.h"

namespace talus {

using Matrix = Owned<Mat, MatDestroy>;

/// A matrix of `rows` by `columns` entries on this rank, in blocks of `block`, with room for all that `fill` puts into
/// the pattern it is given. What several ranks add to one entry is summed in the order of the ranks. Collective.
PetscErrorCode make_sparse(MPI_Comm comm, PetscInt rows, PetscInt columns, PetscInt block,
                           const std::function<PetscErrorCode(Mat)> &fill, Matrix &matrix);

/// Lets `ksp` solve systems of `matrix` by LU (MUMPS). A matrix that is spread over several ranks is gathered and
/// solved on the first of them: MUMPS on several ranks adds what they send in the order in which it arrives, so that
/// the last digits of its answer, and with them the length of steps, would differ from one run to the next. A matrix
/// that cannot be factored is a failure of `ksp` on all ranks. PETSc's options of the solver on the first rank begin
/// with the prefix of `ksp` and `gathered_`. Collective.
PetscErrorCode solve_by_lu(KSP ksp, Mat matrix);

}  // namespace talus
