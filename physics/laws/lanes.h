#pragma once
/// Points go through the laws in blocks of `lanes`, so that the compiler puts several into one register. The functions
/// here are what such loops need in place of std::exp and std::sin, which stay scalar: straight-line code, choices as
/// `?:`.
#include <bit>
#include <cstdint>

namespace talus {

inline constexpr int lanes = 8;

/// e^x, relative error below 4e-16 while the result is a normal number; smaller and larger x give e^-708 and e^709.
/// x = n ln 2 + r: a power of two times the Taylor polynomial of e^r, |r| <= ln 2 / 2 (Muller 2016, Elementary
/// Functions, sec. 11.2).
[[gnu::always_inline]] inline double exponential(double x) {
  x = x < -708 ? -708 : x > 709 ? 709 : x;
  constexpr double to_integer = 0x1.8p52;  // adding it rounds to an integer that then stands in the lowest bits
  const double shifted = x * 0x1.71547652b82fep+0 + to_integer;
  const double n = shifted - to_integer;
  const double r =
      (x - n * 0x1.62e42fefa3800p-1) - n * 0x1.ef35793c76730p-45;  // ln 2 in two parts: the first product is exact
  double sum = 1. / 479001600;
  sum = sum * r + 1. / 39916800;
  sum = sum * r + 1. / 3628800;
  sum = sum * r + 1. / 362880;
  sum = sum * r + 1. / 40320;
  sum = sum * r + 1. / 5040;
  sum = sum * r + 1. / 720;
  sum = sum * r + 1. / 120;
  sum = sum * r + 1. / 24;
  sum = sum * r + 1. / 6;
  sum = sum * r + 1. / 2;
  sum = sum * r + 1;
  sum = sum * r + 1;
  const double power = std::bit_cast<double>((std::bit_cast<std::int64_t>(shifted) << 52) + (std::int64_t{1023} << 52));
  return sum * power;
}

/// sin x for 0 <= x <= pi/2, error below 3e-16: Taylor polynomial of degree 19.
[[gnu::always_inline]] inline double sine(double x) {
  const double y = x * x;
  double sum = -1. / 121645100408832000;
  sum = sum * y + 1. / 355687428096000;
  sum = sum * y - 1. / 1307674368000;
  sum = sum * y + 1. / 6227020800;
  sum = sum * y - 1. / 39916800;
  sum = sum * y + 1. / 362880;
  sum = sum * y - 1. / 5040;
  sum = sum * y + 1. / 120;
  sum = sum * y - 1. / 6;
  return x + x * y * sum;
}

}  // namespace talus
