#pragma once
/// Sparse matrices and their direct solution, the same to the bit whenever a run is repeated on as many ranks.
#include <petscksp.h>

#include <functional>
#include <vector>

#include "base/owned.h"

namespace talus {

using Matrix = Owned<Mat, MatDestroy>;

/// A matrix that is summed up from entries of all ranks. PETSc adds what other ranks send in the order in which it
/// arrives; here it is added in the order of the ranks, so that the last digits are the same in every run.
class SparseMatrix {
 public:
  /// A matrix of `rows` by `columns` entries on this rank, in blocks of `block`, with room for all entries that `fill`
  /// adds to it. Collective.
  PetscErrorCode make(MPI_Comm comm, PetscInt rows, PetscInt columns, PetscInt block,
                      const std::function<PetscErrorCode()> &fill);
  PetscErrorCode clear() { return MatZeroEntries(matrix_); }
  /// Adds a dense block, `value` by rows; rows and columns with negative numbers are left out.
  PetscErrorCode add(PetscInt rows, const PetscInt *row, PetscInt columns, const PetscInt *column, const double *value);
  /// The same of a square block that all ranks know: each adds the rows that it has.
  PetscErrorCode add_here(PetscInt count, const PetscInt *row, const double *value);
  PetscErrorCode finish();  ///< sums up what was added since `clear`; collective

  operator Mat() const { return matrix_; }

 private:
  struct Entry {
    PetscInt row, column;
    double value;
  };
  PetscErrorCode send(std::vector<Entry> &entries) const;

  Matrix matrix_;
  PetscInt first_ = 0, end_ = 0;  ///< rows of this rank
  std::vector<Entry> elsewhere_;  ///< in rows of other ranks
};

enum class Factorization {
  lu,       ///< by MUMPS
  cholesky  ///< by CHOLMOD, of a matrix that is symmetric and positive definite
};

/// Lets `ksp` solve systems of `matrix` directly. A matrix that is spread over several ranks is gathered and solved on
/// the first of them: MUMPS on several ranks adds what they send in the order in which it arrives, so that the last
/// digits of its answer, and with them the length of steps, would differ from one run to the next. PETSc's options of
/// the solver on the first rank begin with the prefix of `ksp` and `gathered_`. Collective.
PetscErrorCode solve_directly(KSP ksp, Mat matrix, Factorization factorization);

/// Solves `matrix` x = b; `solved` is false, on all ranks, where the matrix cannot be factored, or iterations do not
/// converge. Collective.
PetscErrorCode solve_system(KSP ksp, Mat matrix, ::Vec b, ::Vec x, bool *solved);

}  // namespace talus
