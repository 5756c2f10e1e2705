// Claims of earthquake/newmark.h.
#include "earthquake/newmark.h"

#include <gtest/gtest.h>

#include <numbers>

#include "earthquake/column_response.h"

namespace talus {
namespace {

/// Newmark (1965): a pulse A over a time T moves the block by (A - N) A T^2 / 2 N.
TEST(SlidingBlock, UnderARectangularPulseIsNewmarks) {
  constexpr double step = 1e-4, A = 3, T = 0.5;
  GroundMotion motion{step, std::vector<double>(static_cast<std::size_t>(T / step) + 1, A)};
  motion.acceleration.resize(30000);
  for (const double N : {0.5, 1., 2.}) {
    const double exact = (A - N) * A * T * T / (2 * N);
    EXPECT_NEAR(sliding_block(motion, N).back(), exact, 1e-3 * exact) << N;
  }
  EXPECT_EQ(sliding_block(motion, 3.01).back(), 0);
}

/// A record that ends while the block slides: it goes on until it is at rest, and no further.
TEST(SlidingBlock, GoesOnAfterTheRecord) {
  constexpr double step = 0.01, A = 3, T = 0.5, N = 1;
  const GroundMotion motion{step, std::vector<double>(51, A)};
  const double exact = (A - N) * A * T * T / (2 * N);
  const std::vector<double> way = sliding_block(motion, N), both = sliding_block(motion, N, N);
  EXPECT_NEAR(way.back(), exact, 1e-12);
  EXPECT_NEAR(both.back(), exact, 1e-12);
  EXPECT_EQ(way.size(), 51 + 100u);  // v = (A - N) T = 1 m/s, which N stops in 1 s
  EXPECT_EQ(sliding_block(motion, A).size(), 51u);
}

/// The layer vibrates on after the record: it moves a block that the record alone does not.
TEST(SlidingBlock, FollowsALayerThatVibratesOn) {
  GroundMotion pulse{0.01, std::vector<double>(101, 0.)};
  for (int k = 50; k <= 100; ++k) pulse.acceleration[k] = 1;
  const GroundMotion layer = layer_response(pulse, 1, 0.1);
  EXPECT_NEAR(layer.duration(), pulse.duration() + 11, 0.01);  // ln 1000 / (2 pi 0.1) periods
  EXPECT_LT(std::abs(layer.acceleration.back()), 5e-3);
  double after = 0;
  for (std::size_t k = 101; k < layer.acceleration.size(); ++k) after = std::min(after, layer.acceleration[k]);
  EXPECT_LT(after, -1);
}

/// On level ground the block slips to both sides, and comes back to where a symmetric motion has taken it from.
TEST(SlidingBlock, SlipsBothWaysOnLevelGround) {
  GroundMotion motion{1e-3, {}};
  for (int k = 0; k <= 10000; ++k) motion.acceleration.push_back(4 * std::sin(2 * std::numbers::pi * k * 1e-3));
  const std::vector<double> one = sliding_block(motion, 1), both = sliding_block(motion, 1, 1);
  EXPECT_GT(one.back(), 1);
  for (std::size_t k = 1; k < one.size(); ++k) EXPECT_GE(one[k], one[k - 1]);
  double low = 0, high = 0;
  for (const double x : both) low = std::min(low, x), high = std::max(high, x);
  EXPECT_LT(high - low, 0.5 * one.back());
}

/// The same as small steps of time give, for noise, one way and two ways.
TEST(SlidingBlock, IsWhatSmallStepsGive) {
  GroundMotion motion{0.01, {}};
  unsigned state = 1;
  for (int k = 0; k <= 2000; ++k)
    state = state * 1664525U + 1013904223U, motion.acceleration.push_back(6 * (state / 4294967296. - 0.5));
  for (const double uphill : {0., 1.5}) {
    double v = 0, x = 0;
    constexpr int parts = 2000;
    constexpr double dt = 0.01 / parts;
    for (int k = 0; k < 2000 * parts; ++k) {
      const double a = motion.at((k + 0.5) * dt), yield = 0.8;
      if (v == 0) {
        if (a > yield)
          v = dt * (a - yield);
        else if (uphill > 0 && -a > uphill)
          v = dt * (a + uphill);
      } else {
        const double next = v + dt * (v > 0 ? a - yield : a + uphill);
        v = next * v > 0 ? next : 0;
      }
      x += dt * v;
    }
    EXPECT_NEAR(sliding_block(motion, 0.8, uphill).back(), x, 2e-3 * std::abs(x)) << uphill;
  }
}

/// Jibson (2007), fig. 3: at a ratio of 0.1 about 35 cm, at 0.5 about 0.9 cm.
TEST(Jibson, HasTheValuesOfItsFormula) {
  EXPECT_NEAR(jibson_ratio(0.1, 1).median, 0.351, 0.003);
  EXPECT_NEAR(jibson_ratio(0.5, 1).median, 0.00877, 0.0002);
  EXPECT_EQ(jibson_ratio(1, 1).median, 0);
  EXPECT_NEAR(jibson_magnitude(0.1, 1, 7.5).median,
              0.01 * std::pow(10, -2.710 + 2.335 * std::log10(0.9) + 1.478 + 0.424 * 7.5), 1e-9);
  EXPECT_GT(jibson_arias(1, 2).median, jibson_arias(2, 2).median);
}

}  // namespace
}  // namespace talus
