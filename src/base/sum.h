#pragma once
/// Sums of many numbers, and by how much round-off may change them.
#include <limits>

namespace talus {

/// In lanes, so that it costs a read of memory and its round-off is a fraction of that of a sum one by one.
inline double sum_of(const double *values, int count) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = 0; i < count; ++i) sum += values[i];
  return sum;
}

/// Bound of the difference of two sums of the same `count` positive numbers in any order (Higham 2002, section 4.2).
/// Equal numbers come near to it: they are all rounded the same way.
inline double round_off_of_sum(long long count, double sum) {
  return 2 * std::numeric_limits<double>::epsilon() * static_cast<double>(count) * sum;
}

}  // namespace talus
