#include "solvers/nodal_vector.h"

#include <nvector/nvector_petsc.h>
#include <petscvec.h>

#include <cmath>

#include "base/owned.h"

namespace talus {
namespace {

constexpr const char *space_name = "talus nodal space";  // clones of a Vec share what was composed with it

NodalSpace &space_of(N_Vector x) {
  PetscObject container = nullptr;
  void *space = nullptr;
  PetscObjectQuery(reinterpret_cast<PetscObject>(N_VGetVector_Petsc(x)), space_name, &container);
  PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &space);
  return *static_cast<NodalSpace *>(space);
}

/// A standard Vec never moves its array, so it outlives the borrowing.
double *data(N_Vector x) {
  double *array = nullptr;
  VecGetArray(N_VGetVector_Petsc(x), &array);
  double *const kept = array;
  VecRestoreArray(N_VGetVector_Petsc(x), &array);
  return kept;
}

/// z = sum_k c_k x_k, z may be x_0. That of N_Vector_Petsc takes memory from the heap at each call.
int combine(int count, double *c, N_Vector *x, N_Vector z) {
  constexpr int most = 16;  // stages of a method and its embedded one
  Vec vectors[most], sum = N_VGetVector_Petsc(z);
  if (count > most) return -1;
  for (int k = 0; k < count; ++k) vectors[k] = N_VGetVector_Petsc(x[k]);
  PetscErrorCode failure = z == x[0] ? VecScale(sum, c[0]) : VecAXPBY(sum, c[0], 0, vectors[0]);
  if (!failure) failure = VecMAXPY(sum, count - 1, c + 1, vectors + 1);
  return failure ? -1 : 0;
}

}  // namespace

PetscErrorCode make_nodal_vector(NodalSpace &space, SUNContext context, N_Vector *x) {
  PetscFunctionBeginUser;
  const MPI_Comm comm = space.motion->comm();
  Owned<PetscContainer, PetscContainerDestroy> container;
  Vec array;
  PetscCall(PetscContainerCreate(comm, container.create()));
  PetscCall(PetscContainerSetPointer(container, &space));
  PetscCall(VecCreateMPI(comm, 2 * space.motion->capacity(), PETSC_DETERMINE, &array));
  PetscCall(VecSet(array, 0));
  PetscCall(PetscObjectCompose(reinterpret_cast<PetscObject>(array), space_name,
                               reinterpret_cast<PetscObject>(static_cast<PetscContainer>(container))));
  *x = N_VMake_Petsc(array, context);
  PetscCheck(*x, comm, PETSC_ERR_MEM, "N_VMake_Petsc");
  (*x)->ops->nvlinearcombination = combine;
  (*x)->ops->nvwrmsnorm = [](N_Vector error, N_Vector) { return error_norm(error); };  // the weights are in the space
  PetscFunctionReturn(0);
}

void destroy_nodal_vector(N_Vector x) {
  Vec array = N_VGetVector_Petsc(x);  // N_VMake_Petsc leaves it to its maker
  N_VDestroy(x);
  (void)VecDestroy(&array);
}

double *displacement_of(N_Vector y) { return data(y); }
double *velocity_of(N_Vector y) { return data(y) + space_of(y).motion->size(); }

double error_norm(N_Vector error) {
  NodalSpace &space = space_of(error);
  const Motion &motion = *space.motion;
  const double u = space.displacement_tolerance, v = space.velocity_tolerance;
  double sums[2] = {
      motion.seen_square(displacement_of(error)) / (u * u) + motion.seen_square(velocity_of(error)) / (v * v),
      space.inverted ? 1. : 0.};
  space.inverted = false;
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, motion.comm());
  if (sums[1] > 0) ++space.inversions;
  constexpr double hopeless = 1e10;
  const double norm = std::sqrt(sums[0] / motion.mass());
  return sums[1] == 0 && norm < hopeless ? norm : hopeless;
}

}  // namespace talus
