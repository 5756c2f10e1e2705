// Claims of base/sum.h: by how much two sums of the same masses may differ.
#include "base/sum.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace talus {
namespace {

constexpr int count = 278496;  // particles of a dam of 4000 kg/m in cells of 10 mm
constexpr double total = 4000, each = total / count;

TEST(RoundOffOfSum, bounds_what_equal_masses_differ_by) {
  const std::vector<double> mass(count, each);
  const double one_by_one = std::accumulate(mass.begin(), mass.end(), 0.);
  EXPECT_GT(std::abs(one_by_one - total), 1e-12 * total) << "such masses show why a fixed tolerance does not serve";
  EXPECT_LT(std::abs(one_by_one - total), round_off_of_sum(count, total));
  EXPECT_LT(std::abs(one_by_one - sum_of(mass.data(), count)), round_off_of_sum(count, total));
}

TEST(RoundOffOfSum, is_less_than_a_particle) { EXPECT_LT(round_off_of_sum(count, total), 1e-3 * each); }

}  // namespace
}  // namespace talus
