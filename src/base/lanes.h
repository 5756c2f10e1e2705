#pragma once
/// Four doubles in one register: the barycentric coordinates of a simplex, or a vector padded with zeros.

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

/// True when no lane is negative or NaN.
inline bool none_negative(Quad q) {
  auto good = q >= Quad{};
  good &= __builtin_shufflevector(good, good, 2, 3, 0, 1);
  good &= __builtin_shufflevector(good, good, 1, 0, 3, 2);
  return good[0];
}

}  // namespace talus
