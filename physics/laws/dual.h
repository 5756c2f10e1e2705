#pragma once
/// A number that carries its derivatives along n directions (forward mode: Griewank & Walther 2008, Evaluating
/// Derivatives, sec. 3.2). The laws are written for any such number: with doubles they run in the particle loop, with
/// these they give their own consistent tangent. A choice `?:` takes the derivative of the branch it takes.
#include <array>
#include <cmath>

#include "physics/laws/lanes.h"

namespace talus {

template <int n>
struct Dual {
  double value = 0;
  std::array<double, n> slope{};

  Dual() = default;
  Dual(double v) : value(v) {}  ///< a constant

  /// f(x) with its derivative f'(x).
  static Dual of(const Dual &x, double f, double derivative) {
    Dual y(f);
    for (int k = 0; k < n; ++k) y.slope[k] = derivative * x.slope[k];
    return y;
  }
  Dual operator-() const { return of(*this, -value, -1); }
  Dual &operator+=(const Dual &b) { return *this = *this + b; }
  Dual &operator-=(const Dual &b) { return *this = *this - b; }
  Dual &operator*=(const Dual &b) { return *this = *this * b; }

  friend Dual operator+(const Dual &a, const Dual &b) { return combine(a.value + b.value, a, 1, b, 1); }
  friend Dual operator-(const Dual &a, const Dual &b) { return combine(a.value - b.value, a, 1, b, -1); }
  friend Dual operator*(const Dual &a, const Dual &b) { return combine(a.value * b.value, a, b.value, b, a.value); }
  friend Dual operator/(const Dual &a, const Dual &b) {
    const double over = 1 / b.value;
    return combine(a.value * over, a, over, b, -a.value * over * over);
  }
  friend bool operator<(const Dual &a, const Dual &b) { return a.value < b.value; }
  friend bool operator>(const Dual &a, const Dual &b) { return a.value > b.value; }
  friend bool operator<=(const Dual &a, const Dual &b) { return a.value <= b.value; }
  friend bool operator>=(const Dual &a, const Dual &b) { return a.value >= b.value; }

 private:
  static Dual combine(double value, const Dual &a, double over_a, const Dual &b, double over_b) {
    Dual y(value);
    for (int k = 0; k < n; ++k) y.slope[k] = over_a * a.slope[k] + over_b * b.slope[k];
    return y;
  }
};

/// At 0, where the root has no derivative, it counts as constant: the laws take roots of sums of squares only.
template <int n>
Dual<n> sqrt(const Dual<n> &x) {
  const double root = std::sqrt(x.value);
  return Dual<n>::of(x, root, root > 0 ? 0.5 / root : 0);
}
template <int n>
Dual<n> exponential(const Dual<n> &x) {
  const double y = exponential(x.value);
  return Dual<n>::of(x, y, y);
}
template <int n>
Dual<n> logarithm(const Dual<n> &x) {
  return Dual<n>::of(x, logarithm(x.value), 1 / x.value);
}
template <int n>
Dual<n> sine(const Dual<n> &x) {
  return Dual<n>::of(x, sine(x.value), std::cos(x.value));
}

template <int n>
double value_of(const Dual<n> &x) {
  return x.value;
}

}  // namespace talus
