#pragma once
/// Lists of plain records, exchanged with the ranks that need them.
#include <petscsys.h>

#include <algorithm>
#include <type_traits>
#include <vector>

namespace talus {

/// Adds the records of some other ranks to those of this rank, in the order of the ranks. A rank is a partner of its
/// partners; `partners` ascend. Collective over the partners.
template <class Record>
PetscErrorCode gather_from(MPI_Comm comm, const std::vector<int> &partners, std::vector<Record> &records) {
  static_assert(std::is_trivially_copyable_v<Record>);
  constexpr int tag = 20;
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  const std::vector<Record> mine = records;
  const int bytes = static_cast<int>(mine.size() * sizeof(Record));
  const std::size_t count = partners.size();
  std::vector<int> theirs(count);
  std::vector<std::vector<Record>> found(count);
  std::vector<MPI_Request> requests(2 * count);
  const auto wait = [&] {
    return MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  };
  for (std::size_t k = 0; k < count; ++k) {
    PetscCallMPI(MPI_Irecv(&theirs[k], 1, MPI_INT, partners[k], tag, comm, &requests[2 * k]));
    PetscCallMPI(MPI_Isend(&bytes, 1, MPI_INT, partners[k], tag, comm, &requests[2 * k + 1]));
  }
  PetscCallMPI(wait());
  for (std::size_t k = 0; k < count; ++k) {
    found[k].resize(theirs[k] / sizeof(Record));
    PetscCallMPI(MPI_Irecv(found[k].data(), theirs[k], MPI_BYTE, partners[k], tag, comm, &requests[2 * k]));
    PetscCallMPI(MPI_Isend(mine.data(), bytes, MPI_BYTE, partners[k], tag, comm, &requests[2 * k + 1]));
  }
  PetscCallMPI(wait());
  const auto own = std::lower_bound(partners.begin(), partners.end(), rank) - partners.begin();
  found.insert(found.begin() + own, mine);
  records.clear();
  for (const auto &list : found) records.insert(records.end(), list.begin(), list.end());
  PetscFunctionReturn(0);
}

}  // namespace talus
