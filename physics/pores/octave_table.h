#pragma once
/// Functions of x in (0, 0.5] that behave like powers of x at the small end, tabulated on 64 intervals an octave. The
/// interval comes out of the bits of x, so a look-up costs no logarithm. Cubic Hermite with slopes limited after
/// Fritsch & Carlson (1980): monotone where the function is, and off by less than 1e-7 of the value for powers from -3
/// to 4.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace talus {

/// `functions` of `columns` values each, one behind the other: the number of the function is part of the address of a
/// look-up, so that loops over many look-ups vectorise.
template <int columns, int functions>
class OctaveTable {
 public:
  using Values = std::array<double, columns>;
  static constexpr double smallest = 0x1p-40;  ///< below, values are those at the small end

  /// `function(x)` gives all columns of number `which`.
  template <class Function>
  void fill(int which, Function &&function) {
    coefficients_.resize(functions * intervals * stride);
    for (std::int64_t k = first; k < first + intervals; ++k) {
      const double a = left(k), h = left(k + 1) - a;
      // slopes from inside the interval, so that a kink between intervals stays one
      constexpr double near = 1e-3;
      const Values fa = function(a), fb = function(a + h), a1 = function(a + near * h), a2 = function(a + 2 * near * h),
                   b1 = function(a + (1 - near) * h), b2 = function(a + (1 - 2 * near) * h);
      double *c = &coefficients_[(which * intervals + k - first) * stride];
      for (int j = 0; j < columns; ++j, c += 4) {
        const double rise = fb[j] - fa[j];
        const auto limited = [&](double slope) {
          return slope * rise <= 0 ? 0 : std::abs(slope) > 3 * std::abs(rise) ? 3 * rise : slope;
        };
        const double da = limited((4 * a1[j] - a2[j] - 3 * fa[j]) / (2 * near)),
                     db = limited((b2[j] - 4 * b1[j] + 3 * fb[j]) / (2 * near));
        c[0] = fa[j], c[1] = da, c[2] = 3 * rise - 2 * da - db, c[3] = da + db - 2 * rise;
      }
    }
  }

  struct Place {
    const double *coefficients;  ///< of the whole table, which all lanes of a loop read
    std::int64_t offset;         ///< of those of the interval
    double r, inverse_width;
  };
  [[gnu::always_inline]] Place find(int which, double x) const {
    const double inside = x > smallest ? x : smallest;
    const std::int64_t k = index(inside);
    const double a = left(k),
                 inverse = std::bit_cast<double>((2 * bias + 6 - (k >> 6)) << 52);  // the width is a power of two
    return {coefficients_.data(), (which * intervals + k - first) * stride, (inside - a) * inverse, inverse};
  }
  [[gnu::always_inline]] static double value(const Place &at, int column) {
    const auto c = [&](int j) { return at.coefficients[at.offset + 4 * column + j]; };
    return c(0) + at.r * (c(1) + at.r * (c(2) + at.r * c(3)));
  }
  [[gnu::always_inline]] static double slope(const Place &at, int column) {
    const auto c = [&](int j) { return at.coefficients[at.offset + 4 * column + j]; };
    return (c(1) + at.r * (2 * c(2) + 3 * at.r * c(3))) * at.inverse_width;
  }

 private:
  static constexpr std::int64_t bias = 1023;
  static constexpr int shift = 52 - 6, stride = 4 * columns;
  static constexpr std::int64_t index(double x) { return std::bit_cast<std::int64_t>(x) >> shift; }
  static constexpr double left(std::int64_t k) { return std::bit_cast<double>(k << shift); }
  static constexpr std::int64_t first = index(smallest), intervals = index(0.5) - first + 1;

  std::vector<double> coefficients_;  ///< [functions][intervals][columns][4]
};

}  // namespace talus
