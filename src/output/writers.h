#pragma once
/// Shares the writing of a large table among ranks, so that none has to hold all of it. The rows of a table have
/// numbers; each writer takes a range of them and gets its rows in their order, wherever they were.
#include <mpi.h>

#include <vector>

#include "output/deliver.h"

namespace talus {

class Writers {
 public:
  /// How many writers tables of so many rows on this rank need, if one takes `most` rows: as few as can be, and no more
  /// than there are ranks. Collective.
  static int needed(MPI_Comm comm, const std::vector<std::size_t> &rows, long long most);

  /// `number`: that of each row of this rank, not below 0 and different on all ranks. Each of `count` writers takes the
  /// same share of the numbers. Collective.
  Writers(MPI_Comm comm, const std::vector<long long> &number, int count);

  int count() const { return static_cast<int>(rows_.size()); }
  int mine() const { return mine_; }                            ///< which writer this rank is; -1: none
  const std::vector<long long> &rows() const { return rows_; }  ///< how many each writer has

  /// The rows of this writer by increasing number, each of `row` values; none where this rank is no writer. Collective.
  template <class T>
  std::vector<T> collect(std::vector<T> values, int row = 1) const {
    const std::size_t bytes = row * sizeof(T);
    Messages sent(sent_.size());
    for (std::size_t r = 0; r < sent.size(); ++r) {
      sent[r].reserve(sent_[r].size() * bytes);
      for (const int k : sent_[r]) sent[r].append(reinterpret_cast<const char *>(&values[k * row]), bytes);
    }
    const Messages received = deliver(comm_, sent);
    if (stay_) return values;
    const auto rows_of = [&](int rank) {
      return rank == rank_ ? reinterpret_cast<const char *>(values.data()) : received[rank].data();
    };
    std::vector<T> collected(order_.size() * row);
    for (std::size_t k = 0; k < order_.size(); ++k)
      std::memcpy(&collected[k * row], rows_of(order_[k].rank) + order_[k].row * bytes, bytes);
    return collected;
  }

 private:
  struct Origin {
    long long number;
    int rank, row;  ///< of what that rank sent; of this rank, of all of its rows
  };

  MPI_Comm comm_;
  int rank_, mine_ = -1;
  std::vector<long long> rows_;
  std::vector<std::vector<int>> sent_;  ///< rows of this rank that go to each other rank
  std::vector<Origin> order_;           ///< of the rows of this writer, by number
  bool stay_ = true;                    ///< they are all rows of this rank, in their order
};

}  // namespace talus
