// Claims of doubts/scales.h.
#include "doubts/scales.h"

#include <gtest/gtest.h>

namespace talus::scales {
namespace {

// A 10 m layer of clay, 2000 kg/m3, M = 5 MPa, in water of 10 kN/m3, gravity 10 m/s2.
constexpr double height = 10, density = 2000, modulus = 5e6, water_weight = 1e4, gravity = 10;

TEST(Scales, AWaveCrossesALayerInHeightOverSpeed) {
  EXPECT_DOUBLE_EQ(transit(height, std::sqrt(modulus / density)), 0.2);
}

TEST(Scales, ALayerSettlesByHalfOfItsFootsStrain) {
  EXPECT_DOUBLE_EQ(own_weight_strain(density, gravity, height, modulus), 0.04);
  EXPECT_DOUBLE_EQ(settlement(density, gravity, height, modulus), 0.2);
}

TEST(Scales, FallConservesEnergy) {
  EXPECT_DOUBLE_EQ(fall_speed(height, gravity), gravity * fall_time(height, gravity));
  EXPECT_DOUBLE_EQ(fall_speed(height, gravity) * fall_speed(height, gravity) / 2, gravity * height);
}

TEST(Scales, ConductivityIsThatOfTerzaghisTimeFactor) {
  // c_v = 1e-9 * 5e6 / 1e4 = 5e-7 m2/s; a year is 3.15e7 s, in which T = 0.1575
  EXPECT_NEAR(conductivity_at(0.1575, modulus, water_weight, 3.15e7, height), 1e-9, 1e-21);
  for (double factor : {undrained_factor, 1., drained_factor}) {
    const double diffusivity = conductivity_at(factor, modulus, water_weight, 60, height) * modulus / water_weight;
    EXPECT_NEAR(diffusivity * 60 / (height * height), factor, 1e-12 * factor);
  }
}

TEST(Scales, DragRelaxesFasterInTighterSoil) { EXPECT_DOUBLE_EQ(drag_relaxation(1e-4, 0.4, gravity), 2.5e-5); }

}  // namespace
}  // namespace talus::scales
