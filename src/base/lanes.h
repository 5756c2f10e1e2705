#pragma once
/// Four doubles in one register: the barycentric coordinates of a simplex, or a vector padded with zeros.
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace talus {

using Quad = double __attribute__((vector_size(32)));

inline Quad quad(double x) { return Quad{x, x, x, x}; }

/// The first n of four doubles, the rest zero.
template <int n>
inline Quad load(const double *x) {
  Quad q{};
  for (int k = 0; k < n; ++k) q[k] = x[k];
  return q;
}
template <int n>
inline void store(double *x, Quad q) {
  for (int k = 0; k < n; ++k) x[k] = q[k];
}

/// Transposes: lane i of q[j] becomes lane j of q[i].
inline void transpose(Quad (&q)[4]) {
  const Quad a = __builtin_shufflevector(q[0], q[1], 0, 4, 2, 6), b = __builtin_shufflevector(q[0], q[1], 1, 5, 3, 7);
  const Quad c = __builtin_shufflevector(q[2], q[3], 0, 4, 2, 6), d = __builtin_shufflevector(q[2], q[3], 1, 5, 3, 7);
  q[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5), q[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  q[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7), q[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/// True when no lane is negative.
inline bool none_negative(Quad q) {
#ifdef __AVX__
  return !_mm256_movemask_pd(q);
#else
  return q[0] >= 0 && q[1] >= 0 && q[2] >= 0 && q[3] >= 0;
#endif
}

}  // namespace talus
