#include "output/deliver.h"

#include <algorithm>

#include "output/together.h"

namespace talus {

Messages deliver(MPI_Comm comm, Messages sent) {
  constexpr std::size_t piece = std::size_t(1) << 30;  // MPI counts in int
  constexpr int tag = 23;
  const int ranks = static_cast<int>(sent.size());
  std::vector<unsigned long long> to(ranks), from(ranks);
  for (int r = 0; r < ranks; ++r) to[r] = sent[r].size();
  check_mpi(MPI_Alltoall(to.data(), 1, MPI_UNSIGNED_LONG_LONG, from.data(), 1, MPI_UNSIGNED_LONG_LONG, comm),
            "exchanging sizes");
  Messages received(ranks);
  std::vector<MPI_Request> requests;
  const auto in_pieces = [&](std::size_t size, auto &&each) {
    for (std::size_t at = 0; at < size; at += piece) {
      requests.emplace_back();
      check_mpi(each(at, static_cast<int>(std::min(piece, size - at)), &requests.back()), "exchanging rows");
    }
  };
  const int mine = rank_in(comm);
  received[mine] = std::move(sent[mine]);
  to[mine] = from[mine] = 0;
  for (int r = 0; r < ranks; ++r) {
    if (r == mine) continue;
    received[r].resize(from[r]);
    in_pieces(from[r], [&](std::size_t at, int size, MPI_Request *request) {
      return MPI_Irecv(received[r].data() + at, size, MPI_BYTE, r, tag, comm, request);
    });
  }
  for (int r = 0; r < ranks; ++r)
    in_pieces(to[r], [&](std::size_t at, int size, MPI_Request *request) {
      return MPI_Isend(sent[r].data() + at, size, MPI_BYTE, r, tag, comm, request);
    });
  check_mpi(MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE), "exchanging rows");
  return received;
}

}  // namespace talus
