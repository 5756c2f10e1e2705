// Claims of ground_motion.h, processing.h, intensity.h and sources.h.
#include <gtest/gtest.h>

#include <numbers>

#include "earthquake/ground_path.h"
#include "earthquake/intensity.h"
#include "earthquake/processing.h"
#include "earthquake/shaking.h"
#include "earthquake/sources.h"

namespace talus {
namespace {

constexpr double pi = std::numbers::pi;

GroundMotion sine(double amplitude, double frequency, double duration, double step) {
  GroundMotion motion{step, {}};
  for (int k = 0; k <= std::lround(duration / step); ++k)
    motion.acceleration.push_back(amplitude * std::sin(2 * pi * frequency * k * step));
  return motion;
}

TEST(GroundMotion, IsLinearBetweenItsValues) {
  const GroundMotion motion{0.5, {0, 1, -1}};
  EXPECT_DOUBLE_EQ(motion.at(0.25), 0.5);
  EXPECT_DOUBLE_EQ(motion.at(0.75), 0);
  EXPECT_DOUBLE_EQ(motion.at(1), -1);
  EXPECT_DOUBLE_EQ(motion.at(1.01), 0);
  EXPECT_DOUBLE_EQ(motion.at(-0.01), 0);
}

TEST(GroundMotion, OfConstantAccelerationGainsSpeedAndWay) {
  const GroundMotion motion{0.1, std::vector<double>(11, 2.)};
  EXPECT_NEAR(motion.velocity().back(), 2, 1e-14);
  EXPECT_NEAR(motion.displacement().back(), 1, 1e-14);
}

/// A scene's motion between its values, and after its end.
TEST(GroundShaking, IsTheIntegralOfItsAcceleration) {
  const GroundShaking shaking(read_components(
      "earthquake = [{kind = 'sine', amplitude = 2, frequency = 1, duration = 1.3, direction = [3, 4]}]"));
  const GroundPath path(shaking);
  constexpr double w = 2 * pi, dt = 1e-6;
  for (const double t : {0.3137, 0.9, 1.2999}) {
    const double exact = 2 * (t / w - std::sin(w * t) / (w * w));
    EXPECT_NEAR(path.displacement(t)[0], 0.6 * exact, 1e-3 * exact) << "at " << t;
    EXPECT_NEAR(path.displacement(t)[1], 0.8 * exact, 1e-3 * exact) << "at " << t;
    const double rate = (path.displacement(t + dt)[0] - path.displacement(t - dt)[0]) / (2 * dt);
    EXPECT_NEAR(rate, shaking.velocity(t)[0], 1e-6) << "at " << t;
  }
  EXPECT_EQ(path.displacement(-1)[0], 0);
  EXPECT_EQ(path.displacement(5), path.displacement(1.3));
}

TEST(Baseline, OfAVelocityThatIsAPolynomialIsTakenOutWhole) {
  GroundMotion motion{0.01, {}};
  for (int k = 0; k <= 1000; ++k) motion.acceleration.push_back(0.3 - 0.02 * k * 0.01);  // v = 0.3 t - 0.01 t^2
  correct_baseline(motion, 2);
  EXPECT_LT(motion.peak(), 1e-10);
}

TEST(HighPass, TakesOutSlowMotionAndLeavesFastMotionInPhase) {
  GroundMotion slow = sine(1, 0.02, 100, 0.01), fast = sine(1, 2, 100, 0.01), corner = sine(1, 0.2, 200, 0.01);
  const GroundMotion as_it_was = fast;
  high_pass(slow, 0.2), high_pass(fast, 0.2), high_pass(corner, 0.2);
  for (std::size_t k = 2000; k < 8000; ++k) {
    EXPECT_LT(std::abs(slow.acceleration[k]), 3e-4);  // 1 / (1 + 0.41 * 10^4)
    EXPECT_NEAR(fast.acceleration[k], as_it_was.acceleration[k], 1e-4);
  }
  double most = 0;
  for (std::size_t k = 5000; k < 15000; ++k) most = std::max(most, std::abs(corner.acceleration[k]));
  EXPECT_NEAR(most, std::numbers::sqrt2 / 2, 2e-3);  // half of the power
}

TEST(Intensity, OfASineIsKnown) {
  const GroundMotion motion = sine(2, 1, 10, 1e-3);
  const Intensity of = intensity_of(motion);
  EXPECT_NEAR(of.peak_acceleration, 2, 1e-5);
  EXPECT_NEAR(of.peak_velocity, 2 / pi, 1e-4);  // from rest: twice the amplitude
  EXPECT_NEAR(of.arias, pi / (2 * 9.80665) * 4 * 10 / 2, 1e-4);
  EXPECT_NEAR(of.significant_end - of.significant_begin, 9, 0.2);
  EXPECT_NEAR(of.cumulative_velocity, 2 * 10 * 2 / pi, 1e-3);
}

/// A jump of the acceleration moves an oscillator to twice its static place, less by damping.
TEST(ResponseSpectrum, OfAJumpIsExact) {
  const GroundMotion motion{0.01, std::vector<double>(1000, 3.)};
  for (const double h : {1e-9, 0.05, 0.2})
    EXPECT_NEAR(spectral_acceleration(motion, 1, h), 3 * (1 + std::exp(-pi * h / std::sqrt(1 - h * h))), 2e-3) << h;
}

/// An oscillator in resonance comes to 1 / 2h of the acceleration of the ground; a stiff one moves with the ground, a
/// soft one stays where it is.
TEST(ResponseSpectrum, HasItsLimits) {
  const GroundMotion motion = sine(1, 2, 60, 1e-3);
  EXPECT_NEAR(spectral_acceleration(motion, 0.5), 10, 0.02);
  EXPECT_NEAR(spectral_acceleration(motion, 0.01), 1, 1e-3);
  // soft: the largest displacement of the ground is that of its drift, 2 pi f t / w^2
  EXPECT_NEAR(spectral_acceleration(motion, 1000), std::pow(2 * pi / 1000, 2) * intensity_of(motion).peak_displacement,
              2e-5);
  // the largest motion may come after the record
  const GroundMotion pulse{0.01, {0, 1, 0}};
  EXPECT_NEAR(spectral_acceleration(pulse, 1, 1e-9), 2 * pi * 0.01, 1e-4);  // impulse times angular frequency
}

TEST(Formulas, HaveTheirAmplitudeAndComeToRest) {
  RickerSource ricker;
  ricker.amplitude = 2, ricker.frequency = 3;
  GaborSource gabor;
  gabor.amplitude = 2, gabor.frequency = 3;
  for (const GroundMotion &motion : {ricker.make(), gabor.make()}) {
    EXPECT_NEAR(motion.peak(), 2, 1e-12);
    EXPECT_LT(std::abs(motion.acceleration.front()), 1e-7);
  }
  EXPECT_LT(std::abs(ricker.make().velocity().back()), 1e-8);
  EXPECT_LT(std::abs(ricker.make().displacement().back()), 1e-8);
  SineSource sweep;
  sweep.amplitude = 1, sweep.frequency = 1, sweep.last_frequency = 5, sweep.duration = 10, sweep.taper = 1;
  const GroundMotion swept = sweep.make();
  int turns = 0;
  for (std::size_t k = 1; k < swept.acceleration.size(); ++k)
    turns += swept.acceleration[k - 1] < 0 && swept.acceleration[k] >= 0;
  EXPECT_NEAR(turns, 30, 1);  // the mean frequency times the duration
  EXPECT_NEAR(swept.acceleration.back(), 0, 1e-12);
}

/// The same seed gives the same motion, another one another; it hardly drifts, and has its energy at the frequency of
/// the ground.
TEST(KanaiTajimi, IsRepeatable) {
  KanaiTajimiSource source;
  source.amplitude = 3, source.duration = 20;
  const GroundMotion first = source.make();
  EXPECT_EQ(first.acceleration, source.make().acceleration);
  EXPECT_NEAR(first.peak(), 3, 1e-12);
  EXPECT_TRUE(drift_of(first, {}).empty()) << drift_of(first, {});
  EXPECT_GT(spectral_acceleration(first, 0.4), 3 * spectral_acceleration(first, 4));
  source.seed = 2;
  EXPECT_NE(first.acceleration, source.make().acceleration);
  EXPECT_NEAR(first.acceleration[500], -0.20488816832, 1e-9) << "on any machine";
}

TEST(KanaiTajimi, FitsIntoItsDuration) {
  KanaiTajimiSource source;
  for (const double duration : {3., 12., 15., 40.}) {
    source.duration = duration;
    EXPECT_EQ(source.problem(), "");
    EXPECT_LE(source.strong_ends(), 0.8 * duration + 1e-9) << "it has time to decay";
  }
  EXPECT_EQ(source.rise_ends(), 2);
  EXPECT_EQ(source.strong_ends(), 12);
  source.duration = 10, source.strong = 9;
  EXPECT_NE(source.problem(), "");
}

TEST(Drift, OfARecordWithoutBaselineIsSaid) {
  GroundMotion motion = sine(1, 1, 10, 0.01);
  for (double &a : motion.acceleration) a += 0.1;
  const auto says = [&](const EarthquakeSource &source, const char *words) {
    return drift_of(motion, source).find(words) != std::string::npos;
  };
  EarthquakeSource source;
  EXPECT_TRUE(says(source, "% of its largest velocity")) << drift_of(motion, source);
  EXPECT_TRUE(says(source, "baseline = 2, or high_pass"));
  source.baseline = 2;
  EXPECT_FALSE(says(source, "baseline = 2")) << "it has that already";
  source.high_pass = 0.1;
  EXPECT_FALSE(says(source, "Give it")) << drift_of(motion, source);
  correct_baseline(motion, 2);
  EXPECT_LT(std::abs(motion.velocity().back()), 0.2);
}

}  // namespace
}  // namespace talus
