#include "physics/laws/lanes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace talus {
namespace {

TEST(Lanes, exponential_is_exact_to_round_off) {
  double worst = 0;
  for (double x = -700; x < 700; x += 0.00317) {
    const long double exact = std::exp(static_cast<long double>(x));
    worst = std::max(worst, static_cast<double>(std::abs((exponential(x) - exact) / exact)));
  }
  EXPECT_LT(worst, 1e-15);
  EXPECT_EQ(exponential(0), 1);
  EXPECT_LT(exponential(-1e300), 1e-300);
  EXPECT_TRUE(std::isfinite(exponential(1e300)));
}

TEST(Lanes, sine_is_exact_to_round_off_up_to_a_right_angle) {
  double worst = 0;
  for (double x = 0; x <= 1.5707963; x += 1e-6) worst = std::max(worst, std::abs(sine(x) - std::sin(x)));
  EXPECT_LT(worst, 5e-16);
  EXPECT_EQ(sine(0), 0);
}

}  // namespace
}  // namespace talus
