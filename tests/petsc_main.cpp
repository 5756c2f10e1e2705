// main of tests that use PETSc, on one rank or several: only rank 0 reports, any rank's failure fails the program.
#include <gtest/gtest.h>
#include <petscsys.h>

int main(int argc, char **argv) {
  ::testing::InitGoogleTest(&argc, argv);
  if (PetscInitialize(&argc, &argv, nullptr, nullptr)) return 1;
  int rank, failed, any;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  auto &listeners = ::testing::UnitTest::GetInstance()->listeners();
  if (rank) delete listeners.Release(listeners.default_result_printer());
  failed = RUN_ALL_TESTS();
  MPI_Allreduce(&failed, &any, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  if (PetscFinalize()) return 1;
  return any ? 1 : 0;
}
