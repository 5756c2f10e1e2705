#pragma once
/// Failures that reach all ranks, so that no rank waits in a collective call that another rank has left by an
/// exception.
#include <mpi.h>

#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

namespace talus {

/// Throws if an MPI call failed.
inline void check_mpi(int error, const char *what) {
  if (error != MPI_SUCCESS) throw std::runtime_error(std::string(what) + " failed in MPI");
}

inline int rank_in(MPI_Comm comm) {
  int rank;
  check_mpi(MPI_Comm_rank(comm, &rank), "reading the rank");
  return rank;
}

/// Collective. Does `work` on every rank and, if it failed anywhere, throws on all ranks with the cause on the first
/// rank that failed: std::invalid_argument if it threw that there, else std::runtime_error. `work` may differ from rank
/// to rank but must not contain a collective call that a failure would interrupt.
template <class Work>
void together(MPI_Comm comm, Work &&work) {
  std::string cause;
  bool ok = true;
  int refused = 0;
  try {
    work();
  } catch (const std::invalid_argument &error) {
    cause = error.what(), ok = false, refused = 1;
  } catch (const std::exception &error) {
    cause = error.what(), ok = false;
  }
  int size, first = 0;
  check_mpi(MPI_Comm_size(comm, &size), "counting ranks");
  const int mine = ok ? size : rank_in(comm);
  check_mpi(MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm), "comparing success");
  if (first == size) return;
  int length = static_cast<int>(cause.size());
  check_mpi(MPI_Bcast(&length, 1, MPI_INT, first, comm), "sending the cause of a failure");
  cause.resize(length);
  check_mpi(MPI_Bcast(cause.data(), length, MPI_CHAR, first, comm), "sending the cause of a failure");
  check_mpi(MPI_Bcast(&refused, 1, MPI_INT, first, comm), "sending the cause of a failure");
  if (refused) throw std::invalid_argument(cause);
  throw std::runtime_error(cause);
}

/// Collective. Does `work` on rank 0 only; a failure throws on all ranks.
template <class Work>
void on_first_rank(MPI_Comm comm, Work &&work) {
  const bool first = rank_in(comm) == 0;
  together(comm, [&] {
    if (first) work();
  });
}

/// Collective. The text of rank 0, on all ranks.
inline std::string from_first_rank(MPI_Comm comm, std::string text) {
  int length = static_cast<int>(text.size());
  check_mpi(MPI_Bcast(&length, 1, MPI_INT, 0, comm), "sending a text");
  text.resize(length);
  check_mpi(MPI_Bcast(text.data(), length, MPI_CHAR, 0, comm), "sending a text");
  return text;
}

/// Collective. The ranks' values one after the other, on rank 0; elsewhere empty. `row` values stay together, so that
/// counts are rows: up to 2^31 of them.
template <class T>
std::vector<T> gather(MPI_Comm comm, const std::vector<T> &local, int row = 1) {
  int size;
  check_mpi(MPI_Comm_size(comm, &size), "counting ranks");
  const bool first = rank_in(comm) == 0;
  const int rows = static_cast<int>(local.size() / row);
  std::vector<int> counts(first ? size : 0), offsets(counts.size());
  check_mpi(MPI_Gather(&rows, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm), "gathering counts");
  int total = 0;
  for (std::size_t r = 0; r < counts.size(); ++r) offsets[r] = total, total += counts[r];
  std::vector<T> all(static_cast<std::size_t>(total) * row);
  MPI_Datatype type;
  check_mpi(MPI_Type_contiguous(static_cast<int>(row * sizeof(T)), MPI_BYTE, &type), "describing a row");
  check_mpi(MPI_Type_commit(&type), "describing a row");
  const int error = MPI_Gatherv(local.data(), rows, type, all.data(), counts.data(), offsets.data(), type, 0, comm);
  check_mpi(MPI_Type_free(&type), "describing a row");
  check_mpi(error, "gathering values");
  return all;
}

}  // namespace talus
