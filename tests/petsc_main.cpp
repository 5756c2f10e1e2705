// main of tests that use PETSc, on one rank or several: rank 0 reports, other ranks only what fails on them, and any
// rank's failure fails the program.
#include <gtest/gtest.h>
#include <petscsys.h>

#include <iostream>

namespace {

class Failures : public ::testing::EmptyTestEventListener {
  void OnTestPartResult(const ::testing::TestPartResult &result) override {
    if (result.failed())
      std::cerr << (result.file_name() ? result.file_name() : "") << ":" << result.line_number()
                << ": on another rank than the first: " << result.message() << std::endl;
  }
};

}  // namespace

int main(int argc, char **argv) {
  ::testing::InitGoogleTest(&argc, argv);
  if (PetscInitialize(&argc, &argv, nullptr, nullptr)) return 1;
  int rank, failed, any;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  auto &listeners = ::testing::UnitTest::GetInstance()->listeners();
  if (rank) {
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new Failures);  // the listeners own it
  }
  failed = RUN_ALL_TESTS();
  MPI_Allreduce(&failed, &any, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  if (PetscFinalize()) return 1;
  return any ? 1 : 0;
}
