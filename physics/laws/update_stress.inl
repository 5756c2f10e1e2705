/// The loops behind update_stress.h, compiled once per (law, dimension) by update_stress_2d.cpp and
/// update_stress_3d.cpp.
#include <algorithm>
#include <cstring>
#include <utility>

#include "physics/laws/update_stress.h"

namespace talus {
namespace {

using Four = double __attribute__((vector_size(4 * sizeof(double))));
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
    if constexpr (size < 4)
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
    asm("" : "+m"(value));  // the compiler must not trace single lanes back to here: it would peel them off the loop
  }
  void store(int lane, double *to) const {
    for (std::size_t k = 0; k < size; ++k) to[k] = value[k][lane];
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
[[gnu::always_inline]] inline void put(Block<4> &b, int i, const Stress<2> &s) {
  b.value[0][i] = s.xx, b.value[1][i] = s.yy, b.value[2][i] = s.zz, b.value[3][i] = s.xy;
}
[[gnu::always_inline]] inline void put(Block<6> &b, int i, const Stress<3> &s) {
  b.value[0][i] = s.xx, b.value[1][i] = s.yy, b.value[2][i] = s.zz;
  b.value[3][i] = s.xy, b.value[4][i] = s.yz, b.value[5][i] = s.xz;
}

/// R s R^T with R = [cos -sin; sin cos].
[[gnu::always_inline]] inline Stress<2> rotated(const Stress<2> &s, const Block<2> &rotation, int i) {
  const double c = rotation.value[0][i], sn = rotation.value[1][i];
  const double cos2 = c * c - sn * sn, sin2 = 2 * c * sn;
  const double centre = (s.xx + s.yy) / 2, half = (s.xx - s.yy) / 2;
  const double turned = half * cos2 - s.xy * sin2;
  return {centre + turned, centre - turned, s.zz, half * sin2 + s.xy * cos2};
}
[[gnu::always_inline]] inline Stress<3> rotated(const Stress<3> &s, const Block<9> &rotation, int i) {
  const double a = rotation.value[0][i], b = rotation.value[1][i], c = rotation.value[2][i];
  const double d = rotation.value[3][i], e = rotation.value[4][i], f = rotation.value[5][i];
  const double g = rotation.value[6][i], h = rotation.value[7][i], k = rotation.value[8][i];
  const double ax = a * s.xx + b * s.xy + c * s.xz, ay = a * s.xy + b * s.yy + c * s.yz,
               az = a * s.xz + b * s.yz + c * s.zz;
  const double dx = d * s.xx + e * s.xy + f * s.xz, dy = d * s.xy + e * s.yy + f * s.yz,
               dz = d * s.xz + e * s.yz + f * s.zz;
  const double gx = g * s.xx + h * s.xy + k * s.xz, gy = g * s.xy + h * s.yy + k * s.yz,
               gz = g * s.xz + h * s.yz + k * s.zz;
  return {ax * a + ay * b + az * c, dx * d + dy * e + dz * f, gx * g + gy * h + gz * k,
          ax * d + ay * e + az * f, dx * g + dy * h + dz * k, ax * g + ay * h + az * k};
}

/// `lanes` points on their way through one law.
template <int dim, class OneLaw>
struct PointBlock {
  Block<stress_size<dim>> stress, strain;
  Block<std::tuple_size_v<decltype(Increment<dim>::rotation)>> rotation;
  Block<OneLaw::history.size()> history;
  Block<1> element_size;

  /// One call is the whole body of the loop: what lived in the loop itself would be kept in memory, and the loop stay
  /// scalar.
  template <bool strained>
  [[gnu::always_inline]] void correct(const OneLaw &law, int i) {
    auto s = take<Stress<dim>>(stress, i);
    auto h = take<typename OneLaw::History>(history, i);
    const Surroundings around{element_size.value[0][i]};
    if constexpr (strained) law.trial(s, take<Strain<dim>>(strain, i), around);
    law.correct(s, h, around);
    if constexpr (strained) s = rotated(s, rotation, i);
    put(stress, i, s);
    put(history, i, h);
  }
};

/// `law` is a copy, so that no store to the arrays can change it: the compiler then takes what depends on it alone out
/// of the loop.
template <bool strained, int dim, class OneLaw>
void correct_all(OneLaw law, const StressPoints<dim> &points) {
  constexpr int size = stress_size<dim>, memory = static_cast<int>(OneLaw::history.size());
  law.prepare();
  PointBlock<dim, OneLaw> block;

  for (int first = 0; first < points.count; first += lanes) {
    const int filled = std::min(lanes, points.count - first);
    const double *stress[lanes], *history[lanes], *strain[lanes], *rotation[lanes], *element_size[lanes];
    for (int i = 0; i < lanes; ++i) {
      const int p = first + std::min(i, filled - 1);  // the last block repeats its last point
      stress[i] = points.stress_in + p * size;
      history[i] = points.history_in + p * memory;
      element_size[i] = points.size + points.cell[p];
      if constexpr (strained) {
        strain[i] = points.increment[points.cell[p]].strain.data();
        rotation[i] = points.increment[points.cell[p]].rotation.data();
      }
    }
    block.stress.load(stress);
    block.history.load(history);
    block.element_size.load(element_size);
    if constexpr (strained) block.strain.load(strain), block.rotation.load(rotation);
#pragma omp simd
    for (int i = 0; i < lanes; ++i) block.template correct<strained>(law, i);
    for (int i = 0; i < filled; ++i) {
      block.stress.store(i, points.stress_out + (first + i) * size);
      block.history.store(i, points.history_out + (first + i) * memory);
    }
  }
}

}  // namespace

template <int dim>
void update_stress(const Law &law, const StressPoints<dim> &points) {
  std::visit([&](const auto &one) { correct_all<true>(one, points); }, law);
}

template <int dim>
void admit_stress(const Law &law, const StressPoints<dim> &points) {
  std::visit([&](const auto &one) { correct_all<false>(one, points); }, law);
}

}  // namespace talus
