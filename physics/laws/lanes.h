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
  x = x > -708 ? x : -708;
  x = x < 709 ? x : 709;
  constexpr double to_integer = 0x1.8p52;  // adding it rounds to an integer that then stands in the lowest bits
  const double shifted = x * 0x1.71547652b82fep+0 + to_integer;
  const double n = shifted - to_integer;
  const double r =
      (x - n * 0x1.62e42fefa3800p-1) - n * 0x1.ef35793c76730p-45;  // ln 2 in two parts: the first product is exact
  const double r2 = r * r, r4 = r2 * r2;  // summed in groups of four, which the processor does side by side
  const double low = (1 + r) + (1. / 2 + r * (1. / 6)) * r2;
  const double middle = (1. / 24 + r * (1. / 120)) + (1. / 720 + r * (1. / 5040)) * r2;
  const double high = (1. / 40320 + r * (1. / 362880)) + (1. / 3628800 + r * (1. / 39916800)) * r2;
  const double sum = low + r4 * (middle + r4 * (high + r4 * (1. / 479001600)));
  const double power = std::bit_cast<double>((std::bit_cast<std::int64_t>(shifted) << 52) + (std::int64_t{1023} << 52));
  return sum * power;
}

/// ln x of a normal x > 0, error below 3e-16 of max(1, |ln x|): ln x = k ln 2 + 2 artanh((f - 1) / (f + 1)) with
/// x = 2^k f, f in [sqrt(1/2), sqrt(2)) (Muller 2016, sec. 11.3).
[[gnu::always_inline]] inline double logarithm(double x) {
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcd, bias = std::uint64_t{1024} << 52;
  const auto bits = std::bit_cast<std::uint64_t>(x), biased = (bits - root_half + bias) >> 52;
  const double f = std::bit_cast<double>(bits - (biased << 52) + bias);
  const double k = std::bit_cast<double>(biased + std::bit_cast<std::uint64_t>(0x1.8p52)) - (0x1.8p52 + 1024);
  const double s = (f - 1) / (f + 1), y = s * s, y2 = y * y, y4 = y2 * y2;
  const double low = (1. / 3 + y * (1. / 5)) + (1. / 7 + y * (1. / 9)) * y2;
  const double high = (1. / 11 + y * (1. / 13)) + (1. / 15 + y * (1. / 17)) * y2;
  const double sum = y * (low + y4 * (high + y4 * (1. / 19 + y * (1. / 21))));
  return k * 0x1.62e42fefa3800p-1 + (k * 0x1.ef35793c76730p-45 + (2 * s + 2 * s * sum));
}

/// sin x for 0 <= x <= pi/2, error below 5e-16: Taylor polynomial of degree 19.
[[gnu::always_inline]] inline double sine(double x) {
  const double y = x * x;
  const double y2 = y * y, y4 = y2 * y2;
  const double low = (-1. / 6 + y * (1. / 120)) + (-1. / 5040 + y * (1. / 362880)) * y2;
  const double high =
      (-1. / 39916800 + y * (1. / 6227020800)) + (-1. / 1307674368000 + y * (1. / 355687428096000)) * y2;
  return x + x * y * (low + y4 * (high - y4 * (1. / 121645100408832000)));
}

}  // namespace talus
