#pragma once
/// Numbers of `lanes` points or cells side by side, so that the compiler puts several into one register.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <utility>

#include "physics/laws/lanes.h"

namespace talus {

using Four = double __attribute__((vector_size(4 * sizeof(double))));
using Two = double __attribute__((vector_size(2 * sizeof(double))));
using Row = double __attribute__((vector_size(lanes * sizeof(double))));

/// Numbers k to k + 3 of four points, from one Four a point to one Four a number.
struct Transposed {
  Four row[4];
  [[gnu::always_inline]] Transposed(const double *const from[4], std::size_t k) {
    Four a, b, c, d;
    std::memcpy(&a, from[0] + k, sizeof a), std::memcpy(&b, from[1] + k, sizeof b);
    std::memcpy(&c, from[2] + k, sizeof c), std::memcpy(&d, from[3] + k, sizeof d);
    const Four ab02 = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab13 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const Four cd02 = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd13 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    row[0] = __builtin_shufflevector(ab02, cd02, 0, 1, 4, 5), row[1] = __builtin_shufflevector(ab13, cd13, 0, 1, 4, 5);
    row[2] = __builtin_shufflevector(ab02, cd02, 2, 3, 6, 7), row[3] = __builtin_shufflevector(ab13, cd13, 2, 3, 6, 7);
  }
};

/// `size` numbers of each of `lanes` points: all points' first numbers, then all second ones.
template <std::size_t size>
struct Block {
  alignas(sizeof(Row)) double value[size > 0 ? size : 1][lanes];

  /// Each row is written at once: a wide read of what was written in pieces would wait for memory.
  [[gnu::always_inline]] void load(const double *const from[lanes]) {
    if constexpr (size == 2)
      load_pairs(from);
    else if constexpr (size < 4)
      for (std::size_t k = 0; k < size; ++k) {
        const Row row{from[0][k], from[1][k], from[2][k], from[3][k], from[4][k], from[5][k], from[6][k], from[7][k]};
        std::memcpy(value[k], &row, sizeof row);
      }
    else
      for (std::size_t step = 0; step < size; step += 4) {
        const std::size_t first = step + 4 <= size ? step : size - 4;  // the last four overlap those before
        const Transposed low(from, first), high(from + 4, first);
        for (int k = 0; k < 4; ++k) {
          const Row row = __builtin_shufflevector(low.row[k], high.row[k], 0, 1, 2, 3, 4, 5, 6, 7);
          std::memcpy(value[first + k], &row, sizeof row);
        }
      }
    // the compiler must not trace single lanes back to here: it would take them out of the vector loop
    asm("" : "+m"(value));
  }
  void fill(double number) {
    for (auto &row : value) std::fill_n(row, lanes, number);
  }
  /// Points that stand for the same place have the same numbers.
  [[gnu::always_inline]] void store(double *const to[lanes]) const {
    if constexpr (size < 4)
      for (int i = 0; i < lanes; ++i)
        for (std::size_t k = 0; k < size; ++k) to[i][k] = value[k][i];
    else
      for (std::size_t step = 0; step < size; step += 4) {
        const std::size_t first = step + 4 <= size ? step : size - 4;
        const double *const rows[4] = {value[first], value[first + 1], value[first + 2], value[first + 3]};
        const Transposed low(rows, 0), high(rows, 4);
        for (int i = 0; i < 4; ++i) {
          std::memcpy(to[i] + first, &low.row[i], sizeof low.row[i]);
          std::memcpy(to[i + 4] + first, &high.row[i], sizeof high.row[i]);
        }
      }
  }

 private:
  [[gnu::always_inline]] void load_pairs(const double *const from[lanes]) {
    Two pair[lanes];
    for (int i = 0; i < lanes; ++i) std::memcpy(&pair[i], from[i], sizeof pair[i]);
    Four four[lanes / 2];
    for (int i = 0; i < lanes / 2; ++i) four[i] = __builtin_shufflevector(pair[2 * i], pair[2 * i + 1], 0, 1, 2, 3);
    const Row low = __builtin_shufflevector(four[0], four[1], 0, 1, 2, 3, 4, 5, 6, 7);
    const Row high = __builtin_shufflevector(four[2], four[3], 0, 1, 2, 3, 4, 5, 6, 7);
    const Row first = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
    const Row second = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
    std::memcpy(value[0], &first, sizeof first), std::memcpy(value[1], &second, sizeof second);
  }
};

/// A T of `size` doubles taken from lane i, or put there.
template <class T, std::size_t size>
[[gnu::always_inline]] inline T take(const Block<size> &b, int i) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) __attribute__((always_inline)) { return T{b.value[k][i]...}; }
  (std::make_index_sequence<size>());
}
template <std::size_t size>
[[gnu::always_inline]] inline void put(Block<size> &b, int i, const std::array<double, size> &h) {
  [&]<std::size_t... k>(std::index_sequence<k...>) __attribute__((always_inline)) { ((b.value[k][i] = h[k]), ...); }
  (std::make_index_sequence<size>());
}

}  // namespace talus
