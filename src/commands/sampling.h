#pragma once
/// Random numbers of `talus study`: nested Latin hypercubes and the normal distribution. The numbers depend on the seed
/// alone, not on the platform or on how many samples follow.
#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace talus {

/// A number in (0, 1) of a generator: 53 bits, never 0 or 1.
inline double uniform_of(std::mt19937_64 &generator) {
  return (static_cast<double>(generator() >> 11) + 0.5) * 0x1p-53;
}

/// The first `count` coordinates in (0, 1) of one variable. Each prefix of 2^k coordinates is a Latin hypercube: one
/// coordinate in each of 2^k intervals of equal width. After n = 2^k coordinates every interval is halved, and the next
/// n coordinates lie in the empty halves, in random order (Sallaberry, Helton & Hora 2008, sec. 3, extend a Latin
/// hypercube by doubling in this way). A longer sample begins with the shorter one.
inline std::vector<double> nested_hypercube(std::size_t count, std::uint64_t seed, std::uint64_t variable) {
  std::seed_seq words{seed, seed >> 32, variable};
  std::mt19937_64 generator(words);
  std::vector<double> all{uniform_of(generator)};
  while (all.size() < count) {
    const std::size_t n = all.size();
    std::vector<std::size_t> empty;  // halves without a coordinate
    std::vector<bool> taken(2 * n);
    for (const double u : all) taken[static_cast<std::size_t>(u * static_cast<double>(2 * n))] = true;
    for (std::size_t half = 0; half < 2 * n; ++half)
      if (!taken[half]) empty.push_back(half);
    for (std::size_t i = n; i-- > 1;)  // Fisher and Yates; std::shuffle differs between libraries
      std::swap(empty[i], empty[static_cast<std::size_t>(uniform_of(generator) * static_cast<double>(i + 1))]);
    for (const std::size_t half : empty)
      all.push_back((static_cast<double>(half) + uniform_of(generator)) / static_cast<double>(2 * n));
  }
  all.resize(count);
  return all;
}

/// Distribution function of the standard normal distribution.
inline double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.)); }

/// Its inverse, for p in (0, 1): the approximation 26.2.23 of Abramowitz & Stegun (1964), error below 4.5e-4, and steps
/// of Halley's method to round-off.
inline double normal_quantile(double p) {
  if (p > 0.5) return -normal_quantile(1 - p);
  const double t = std::sqrt(-2 * std::log(p));
  double x = (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308))) - t;
  for (int i = 0; i < 3; ++i) {
    const double error = (normal_distribution(x) - p) * std::sqrt(2 * 3.14159265358979323846) * std::exp(0.5 * x * x);
    x -= error / (1 + 0.5 * x * error);
  }
  return x;
}

/// Coordinates of a sample point, correlated by a Gaussian copula: the normal scores of `u` are multiplied with the
/// lower triangle L of their correlation matrix L L^T, whose rows have length 1, so that every coordinate remains
/// uniform on (0, 1).
inline Eigen::VectorXd correlated(const Eigen::VectorXd &u, const Eigen::MatrixXd &triangle) {
  return (triangle * u.unaryExpr(&normal_quantile)).unaryExpr(&normal_distribution);
}

}  // namespace talus
