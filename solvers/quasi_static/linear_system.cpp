#include "solvers/quasi_static/linear_system.h"

#include <omp.h>

#include <algorithm>
#include <string>
#include <utility>

namespace talus {
namespace {

PetscErrorCode factor_by(Factorization factorization, KSP ksp, Mat matrix) {
  PC pc;
  Mat factor;
  PetscFunctionBeginUser;
  const bool lu = factorization == Factorization::lu;
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPSetOperators(ksp, matrix, matrix));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, lu ? PCLU : PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(pc, lu ? MATSOLVERMUMPS : MATSOLVERCHOLMOD));
  if (!lu) {
    const char *prefix;
    PetscCall(KSPGetOptionsPrefix(ksp, &prefix));
    const std::string quiet = "-" + std::string(prefix ? prefix : "") + "mat_cholmod_print";
    PetscCall(PetscOptionsSetValue(nullptr, quiet.c_str(), "0"));  // what `factor` tells is no warning
    omp_set_max_active_levels(0);  // CHOLMOD's four threads of each small front take longer than one
    PetscFunctionReturn(0);
  }
  PetscCall(PCFactorSetUpMatSolverType(pc));
  PetscCall(PCFactorGetMatrix(pc, &factor));
  PetscCall(MatMumpsSetIcntl(factor, 14, 100));  // room for pivots, in per cent: tangents at failure ask for many
  PetscFunctionReturn(0);
}

/// A matrix that is not positive definite is an error of CHOLMOD, not a failure of `ksp`.
PetscErrorCode factor(KSP ksp, bool *factored) {
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
  const PetscErrorCode error = KSPSetUp(ksp);
  PetscCall(PetscPopErrorHandler());
  *factored = error != PETSC_ERR_MAT_CH_ZRPVT;
  if (*factored) PetscCall(error);
  PetscFunctionReturn(0);
}

/// A system of all ranks that the first of them gathers and solves. PETSc's PCTELESCOPE does the same, but only the
/// first rank learns there that a matrix is singular, and the others wait for it.
class GatheredSystem {
 public:
  explicit GatheredSystem(Factorization factorization) : factorization_(factorization) {}
  GatheredSystem(const GatheredSystem &) = delete;
  GatheredSystem &operator=(const GatheredSystem &) = delete;
  ~GatheredSystem() {
    if (matrix_) (void)MatDestroySubMatrices(1, &matrix_);
  }

  static PetscErrorCode set_up(PC pc) {
    GatheredSystem *system;
    PetscFunctionBeginUser;
    PetscCall(PCShellGetContext(pc, &system));
    PetscCall(system->take(pc));
    PetscFunctionReturn(0);
  }
  static PetscErrorCode apply(PC pc, ::Vec b, ::Vec x) {
    GatheredSystem *system;
    PetscFunctionBeginUser;
    PetscCall(PCShellGetContext(pc, &system));
    PetscCall(system->solve(pc, b, x));
    PetscFunctionReturn(0);
  }
  static PetscErrorCode destroy(PC pc) {
    GatheredSystem *system;
    PetscFunctionBeginUser;
    PetscCall(PCShellGetContext(pc, &system));
    delete system;
    PetscFunctionReturn(0);
  }

 private:
  PetscErrorCode gather(Mat spread, bool *new_pattern);
  PetscErrorCode take(PC pc);
  PetscErrorCode solve(PC pc, ::Vec b, ::Vec x);
  PetscErrorCode tell_failure(PC pc) const;

  Factorization factorization_;
  bool factored_ = true;           ///< on the first rank
  PetscObjectState pattern_ = 0;   ///< of the matrix that was gathered last
  Mat *matrix_ = nullptr;          ///< one matrix, empty on all ranks but the first
  Owned<KSP, KSPDestroy> solver_;  ///< on the first rank only
  Owned<VecScatter, VecScatterDestroy> to_first_;
  Vector gathered_, solution_;  ///< empty on all ranks but the first
};

PetscErrorCode GatheredSystem::gather(Mat spread, bool *new_pattern) {
  PetscObjectState pattern;
  PetscFunctionBeginUser;
  PetscCall(MatGetNonzeroState(spread, &pattern));
  *new_pattern = !matrix_ || pattern != pattern_;
  pattern_ = pattern;
  if (*new_pattern && matrix_) PetscCall(MatDestroySubMatrices(1, &matrix_));
  int rank;
  PetscInt size;
  Owned<IS, ISDestroy> all;
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm(reinterpret_cast<PetscObject>(spread)), &rank));
  PetscCall(MatGetSize(spread, &size, nullptr));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, rank == 0 ? size : 0, 0, 1, all.create()));
  const IS rows = all;
  PetscCall(
      MatCreateSubMatrices(spread, 1, &rows, &rows, *new_pattern ? MAT_INITIAL_MATRIX : MAT_REUSE_MATRIX, &matrix_));
  PetscFunctionReturn(0);
}

PetscErrorCode GatheredSystem::take(PC pc) {
  Mat spread;
  int rank;
  const char *prefix;
  bool new_pattern;
  PetscFunctionBeginUser;
  PetscCall(PCGetOperators(pc, nullptr, &spread));
  PetscCall(gather(spread, &new_pattern));
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm(reinterpret_cast<PetscObject>(pc)), &rank));
  if (rank == 0) {
    if (new_pattern) {
      PetscCall(KSPCreate(PETSC_COMM_SELF, solver_.create()));
      PetscCall(PCGetOptionsPrefix(pc, &prefix));
      PetscCall(KSPSetOptionsPrefix(solver_, prefix));
      PetscCall(KSPAppendOptionsPrefix(solver_, "gathered_"));
      PetscCall(factor_by(factorization_, solver_, matrix_[0]));
      PetscCall(KSPSetFromOptions(solver_));
    }
    PetscCall(KSPSetOperators(solver_, matrix_[0], matrix_[0]));
    PetscCall(factor(solver_, &factored_));
  }
  PetscCall(tell_failure(pc));
  PetscFunctionReturn(0);
}

PetscErrorCode GatheredSystem::solve(PC pc, ::Vec b, ::Vec x) {
  PetscFunctionBeginUser;
  if (!to_first_) {
    PetscCall(VecScatterCreateToZero(b, to_first_.create(), gathered_.create()));
    PetscCall(VecDuplicate(gathered_, solution_.create()));
  }
  PetscCall(VecScatterBegin(to_first_, b, gathered_, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(to_first_, b, gathered_, INSERT_VALUES, SCATTER_FORWARD));
  if (solver_ && factored_) PetscCall(KSPSolve(solver_, gathered_, solution_));
  PetscCall(VecScatterBegin(to_first_, solution_, x, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(to_first_, solution_, x, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(tell_failure(pc));
  PetscFunctionReturn(0);
}

PetscErrorCode GatheredSystem::tell_failure(PC pc) const {
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscFunctionBeginUser;
  if (solver_ && factored_) PetscCall(KSPGetConvergedReason(solver_, &reason));
  int failed = reason < 0 || !factored_;
  PetscCallMPI(MPI_Bcast(&failed, 1, MPI_INT, 0, PetscObjectComm(reinterpret_cast<PetscObject>(pc))));
  PetscCall(PCSetFailedReason(pc, failed ? PC_SUBPC_ERROR : PC_NOERROR));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode SparseMatrix::make(MPI_Comm comm, PetscInt rows, PetscInt columns, PetscInt block,
                                  const std::function<PetscErrorCode()> &fill) {
  PetscFunctionBeginUser;
  const auto create = [&](MatType type) -> PetscErrorCode {
    PetscFunctionBeginUser;
    PetscCall(MatCreate(comm, matrix_.create()));
    PetscCall(MatSetSizes(matrix_, rows, columns, PETSC_DETERMINE, PETSC_DETERMINE));
    PetscCall(MatSetBlockSize(matrix_, block));
    PetscCall(MatSetType(matrix_, type));
    PetscFunctionReturn(0);
  };
  PetscCall(create(MATPREALLOCATOR));
  PetscCall(MatSetUp(matrix_));
  PetscCall(MatGetOwnershipRange(matrix_, &first_, &end_));
  PetscCall(fill());
  PetscCall(finish());
  const Matrix pattern = std::move(matrix_);
  PetscCall(create(MATAIJ));
  PetscCall(MatPreallocatorPreallocate(pattern, PETSC_TRUE, matrix_));
  PetscCall(MatSetOption(matrix_, MAT_IGNORE_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscCall(finish());
  PetscFunctionReturn(0);
}

PetscErrorCode SparseMatrix::add(PetscInt rows, const PetscInt *row, PetscInt columns, const PetscInt *column,
                                 const double *value) {
  PetscFunctionBeginUser;
  bool any_here = false;
  for (PetscInt i = 0; i < rows; ++i) {
    const bool here = row[i] >= first_ && row[i] < end_;
    any_here |= here;
    for (PetscInt j = 0; j < columns && row[i] >= 0 && !here; ++j)
      if (column[j] >= 0) elsewhere_.push_back({row[i], column[j], value[i * columns + j]});
  }
  if (any_here) PetscCall(MatSetValues(matrix_, rows, row, columns, column, value, ADD_VALUES));
  PetscFunctionReturn(0);
}

PetscErrorCode SparseMatrix::add_here(PetscInt count, const PetscInt *row, const double *value) {
  PetscFunctionBeginUser;
  std::vector<PetscInt> mine(row, row + count);
  for (PetscInt &one : mine)
    if (one < first_ || one >= end_) one = -1;
  PetscCall(add(count, mine.data(), count, row, value));
  PetscFunctionReturn(0);
}

PetscErrorCode SparseMatrix::finish() {
  PetscFunctionBeginUser;
  std::stable_sort(elsewhere_.begin(), elsewhere_.end(), [](const Entry &a, const Entry &b) {
    return std::make_pair(a.row, a.column) < std::make_pair(b.row, b.column);
  });
  std::vector<Entry> sums;
  for (const Entry &e : elsewhere_) {
    if (sums.empty() || sums.back().row != e.row || sums.back().column != e.column)
      sums.push_back(e);
    else
      sums.back().value += e.value;
  }
  elsewhere_.clear();
  PetscCall(send(sums));
  for (const Entry &e : sums) PetscCall(MatSetValue(matrix_, e.row, e.column, e.value, ADD_VALUES));
  PetscCall(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

/// Replaces entries, sorted by their rows, by those that other ranks have for the rows of this one, in the order of the
/// ranks.
PetscErrorCode SparseMatrix::send(std::vector<Entry> &entries) const {
  int ranks;
  const PetscInt *range;
  PetscFunctionBeginUser;
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(static_cast<Mat>(matrix_)));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(MatGetOwnershipRanges(matrix_, &range));
  std::vector<int> sent(ranks, 0), received(ranks), to(ranks + 1, 0), from(ranks + 1, 0);
  for (const Entry &e : entries)
    sent[std::upper_bound(range, range + ranks + 1, e.row) - range - 1] += static_cast<int>(sizeof(Entry));
  PetscCallMPI(MPI_Alltoall(sent.data(), 1, MPI_INT, received.data(), 1, MPI_INT, comm));
  for (int r = 0; r < ranks; ++r) to[r + 1] = to[r] + sent[r], from[r + 1] = from[r] + received[r];
  std::vector<Entry> mine(from[ranks] / sizeof(Entry));
  PetscCallMPI(MPI_Alltoallv(entries.data(), sent.data(), to.data(), MPI_BYTE, mine.data(), received.data(),
                             from.data(), MPI_BYTE, comm));
  entries.swap(mine);
  PetscFunctionReturn(0);
}

PetscErrorCode solve_directly(KSP ksp, Mat matrix, Factorization factorization) {
  PC pc;
  int ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), &ranks));
  if (ranks == 1) {
    PetscCall(factor_by(factorization, ksp, matrix));
    PetscFunctionReturn(0);
  }
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetName(pc, "direct solution on the first rank"));
  PetscCall(PCShellSetContext(pc, new GatheredSystem(factorization)));
  PetscCall(PCShellSetSetUp(pc, GatheredSystem::set_up));
  PetscCall(PCShellSetApply(pc, GatheredSystem::apply));
  PetscCall(PCShellSetDestroy(pc, GatheredSystem::destroy));
  PetscFunctionReturn(0);
}

PetscErrorCode solve_system(KSP ksp, Mat matrix, ::Vec b, ::Vec x, bool *solved) {
  KSPConvergedReason reason;
  PetscFunctionBeginUser;
  PetscCall(KSPSetOperators(ksp, matrix, matrix));
  PetscCall(factor(ksp, solved));
  if (!*solved) PetscFunctionReturn(0);
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  *solved = reason > 0;
  PetscFunctionReturn(0);
}

}  // namespace talus
