// Nested Latin hypercubes, distributions and their correlation.
#include "commands/sampling.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "commands/study_file.h"

namespace talus {
namespace {

TEST(NestedHypercube, HasOneCoordinateInEachInterval) {
  for (const std::size_t n : {1u, 2u, 64u, 1024u}) {
    std::set<std::size_t> intervals;
    for (const double u : nested_hypercube(n, 5, 0)) intervals.insert(static_cast<std::size_t>(u * double(n)));
    EXPECT_EQ(intervals.size(), n);
  }
  // between two powers of two no interval of the smaller one is empty
  std::set<std::size_t> intervals;
  for (const double u : nested_hypercube(200, 5, 0)) intervals.insert(static_cast<std::size_t>(u * 128));
  EXPECT_EQ(intervals.size(), 128u);
}

TEST(NestedHypercube, BeginsWithTheShorterOne) {
  const auto shorter = nested_hypercube(37, 9, 1), longer = nested_hypercube(300, 9, 1);
  EXPECT_TRUE(std::equal(shorter.begin(), shorter.end(), longer.begin()));
  EXPECT_NE(nested_hypercube(37, 10, 1), shorter) << "another seed";
  EXPECT_NE(nested_hypercube(37, 9, 2), shorter) << "another variable";
}

// values of Abramowitz & Stegun (1964), table 26.5, and of R: qnorm
TEST(NormalQuantile, InvertsTheDistribution) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-13);
  EXPECT_NEAR(normal_quantile(0.5), 0, 1e-15);
  EXPECT_NEAR(normal_quantile(1e-12), -7.034483825301132, 1e-9);
  for (const double p : {1e-9, 1e-3, 0.2, 0.77, 0.9999})
    EXPECT_NEAR(normal_distribution(normal_quantile(p)) / p, 1, 1e-9);
}

double mean_of(const std::vector<double> &x) { return std::accumulate(x.begin(), x.end(), 0.) / double(x.size()); }

double covariance(const std::vector<double> &x, const std::vector<double> &y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - mean_of(x)) * (y[i] - mean_of(y));
  return sum / double(x.size());
}

template <class Kind>
std::vector<double> sample(const Kind &kind) {
  std::vector<double> all = nested_hypercube(4096, 3, 0);
  for (double &u : all) u = kind.quantile(u);
  return all;
}

// a Latin hypercube of 4096 has the moments of its distribution far better than a random sample (1/64 of the deviation)
TEST(Distribution, HasItsMoments) {
  Normal normal;
  normal.mean = 6, normal.standard_deviation = 1.5;
  Lognormal lognormal;
  lognormal.mean = 20, lognormal.coefficient_of_variation = 0.4;
  Uniform uniform;
  uniform.low = 2, uniform.high = 5;
  for (const auto &[x, mean, deviation] : {std::tuple{sample(normal), 6., 1.5},
                                           {sample(lognormal), 20., 8.},
                                           {sample(uniform), 3.5, 3 / std::sqrt(12.)}}) {
    EXPECT_NEAR(mean_of(x), mean, 2e-3 * deviation);
    EXPECT_NEAR(std::sqrt(covariance(x, x)), deviation, 2e-2 * deviation);
  }
}

// mean of a normal distribution cut off at its mean: mean + deviation sqrt(2/pi)
TEST(Distribution, IsCutOffAndScaled) {
  Normal half;
  half.mean = 6, half.standard_deviation = 1.5, half.low = 6;
  const auto x = sample(half);
  EXPECT_GE(*std::min_element(x.begin(), x.end()), 6);
  EXPECT_NEAR(mean_of(x), 6 + 1.5 * std::sqrt(2 / 3.14159265358979), 5e-3);
  half.low = 30;
  EXPECT_NE(half.problem(), "") << "16 deviations above the mean nothing is left";
}

TEST(Correlation, IsThatOfTheMatrix) {
  const Eigen::Matrix3d asked{{1, -0.6, 0}, {-0.6, 1, 0.3}, {0, 0.3, 1}};
  const Eigen::MatrixXd triangle = asked.llt().matrixL();
  std::vector<std::vector<double>> scores(3);
  const auto u = nested_hypercube(4096, 1, 0), v = nested_hypercube(4096, 1, 1), w = nested_hypercube(4096, 1, 2);
  for (std::size_t s = 0; s < u.size(); ++s) {
    const Eigen::VectorXd together = correlated(Eigen::Vector3d(u[s], v[s], w[s]), triangle);
    for (int i = 0; i < 3; ++i) scores[static_cast<std::size_t>(i)].push_back(normal_quantile(together[i]));
  }
  for (const auto &one : scores) EXPECT_NEAR(covariance(one, one), 1, 0.05);
  EXPECT_NEAR(covariance(scores[0], scores[1]), -0.6, 0.05);  // 4096 pairs scatter by 1/64
  EXPECT_NEAR(covariance(scores[1], scores[2]), 0.3, 0.05);
  EXPECT_NEAR(covariance(scores[0], scores[2]), 0, 0.05);
}

}  // namespace
}  // namespace talus
