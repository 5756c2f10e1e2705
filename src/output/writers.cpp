#include "output/writers.h"

#include <algorithm>

#include "output/together.h"

namespace talus {

int Writers::needed(MPI_Comm comm, const std::vector<std::size_t> &rows, long long most) {
  std::vector<long long> total(rows.begin(), rows.end());
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, total.data(), static_cast<int>(total.size()), MPI_LONG_LONG, MPI_SUM, comm),
            "counting rows");
  int ranks;
  check_mpi(MPI_Comm_size(comm, &ranks), "counting ranks");
  const long long largest = *std::max_element(total.begin(), total.end());
  return static_cast<int>(std::clamp<long long>((largest + most - 1) / most, 1, ranks));
}

Writers::Writers(MPI_Comm comm, const std::vector<long long> &number, int count)
    : comm_(comm), rank_(rank_in(comm)), rows_(count, 0) {
  int ranks;
  check_mpi(MPI_Comm_size(comm, &ranks), "counting ranks");
  long long end = 0;
  for (const long long n : number) end = std::max(end, n + 1);
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, &end, 1, MPI_LONG_LONG, MPI_MAX, comm), "comparing numbers of rows");
  const auto rank_of = [&](long long writer) { return static_cast<int>(writer * ranks / count); };
  for (int w = 0; w < count; ++w)
    if (rank_of(w) == rank_) mine_ = w;
  sent_.resize(ranks);
  Messages numbers(ranks);
  if (ranks == 1) order_.reserve(number.size());
  for (int k = 0; k < static_cast<int>(number.size()); ++k) {
    const long long writer = number[k] * count / end;
    const int r = rank_of(writer);
    ++rows_[writer];
    if (r == rank_)
      order_.push_back({number[k], r, k});
    else
      sent_[r].push_back(k), append(numbers[r], number[k]);
  }
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, rows_.data(), count, MPI_LONG_LONG, MPI_SUM, comm), "counting rows");
  const Messages received = deliver(comm, numbers);
  for (int r = 0; r < ranks; ++r) {
    const auto arrived = values_of<long long>(received[r]);
    for (std::size_t row = 0; row < arrived.size(); ++row) order_.push_back({arrived[row], r, static_cast<int>(row)});
  }
  std::sort(order_.begin(), order_.end(), [](const Origin &a, const Origin &b) { return a.number < b.number; });
  stay_ = order_.size() == number.size();
  for (int k = 0; stay_ && k < static_cast<int>(order_.size()); ++k)
    stay_ = order_[k].rank == rank_ && order_[k].row == k;
}

}  // namespace talus
