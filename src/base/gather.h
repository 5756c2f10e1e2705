#pragma once
/// Lists of plain records, made the same on all ranks.
#include <petscsys.h>

#include <type_traits>
#include <vector>

namespace talus {

/// Replaces the records of this rank by those of all ranks, in the order of the ranks. Collective.
template <class Record>
PetscErrorCode gather_from_all(MPI_Comm comm, std::vector<Record> &records) {
  static_assert(std::is_trivially_copyable_v<Record>);
  int ranks;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  const std::vector<Record> mine = records;
  const int bytes = static_cast<int>(mine.size() * sizeof(Record));
  PetscCallMPI(MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm));
  for (int r = 0; r < ranks; ++r) starts[r + 1] = starts[r] + counts[r];
  records.resize(starts[ranks] / sizeof(Record));
  PetscCallMPI(
      MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, records.data(), counts.data(), starts.data(), MPI_BYTE, comm));
  PetscFunctionReturn(0);
}

}  // namespace talus
