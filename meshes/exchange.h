#pragma once
/// Messages between ranks that are neighbours, such as of numbers that only one of them knows.
#include <mpi.h>

#include <type_traits>
#include <vector>

namespace talus {

/// Sends a list to each of these ranks and returns the lists that they send. Collective over neighbours.
template <class T>
std::vector<std::vector<T>> exchange(MPI_Comm comm, const std::vector<int> &ranks,
                                     const std::vector<std::vector<T>> &sent) {
  static_assert(std::is_trivially_copyable_v<T>);
  constexpr int tag = 21;
  const std::size_t neighbours = ranks.size();
  std::vector<MPI_Request> requests(2 * neighbours);
  std::vector<int> sent_bytes(neighbours), bytes(neighbours);
  std::vector<std::vector<T>> received(neighbours);
  const auto wait = [&] { MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE); };
  for (std::size_t k = 0; k < neighbours; ++k) {
    sent_bytes[k] = static_cast<int>(sent[k].size() * sizeof(T));
    MPI_Irecv(&bytes[k], 1, MPI_INT, ranks[k], tag, comm, &requests[2 * k]);
    MPI_Isend(&sent_bytes[k], 1, MPI_INT, ranks[k], tag, comm, &requests[2 * k + 1]);
  }
  wait();
  for (std::size_t k = 0; k < neighbours; ++k) {
    received[k].resize(bytes[k] / sizeof(T));
    MPI_Irecv(received[k].data(), bytes[k], MPI_BYTE, ranks[k], tag, comm, &requests[2 * k]);
    MPI_Isend(sent[k].data(), sent_bytes[k], MPI_BYTE, ranks[k], tag, comm, &requests[2 * k + 1]);
  }
  wait();
  return received;
}

}  // namespace talus
