// Retention curves and relative permeabilities: what their sources print, what all have in common, and how near the
// tables are.
#include <gtest/gtest.h>

#include "fixtures.h"

namespace talus {
namespace {

TEST(Curves, van_genuchten_is_celias_sand) {
  // Celia et al. (1990): alpha = 0.0335 /cm, n = 2, theta from 0.102 to 0.368; at a head of -1000 cm theta = 0.110
  const VanGenuchten curve{{0}, 9810 / 3.35, 0.5};
  EXPECT_NEAR(0.102 + 0.266 * curve.effective(9810. * 10), 0.1099, 1e-4);
  EXPECT_NEAR(curve.effective(9810. * 10), 1 / std::sqrt(1 + 33.5 * 33.5), 1e-12);
}

TEST(Curves, mualem_conductivity_is_van_genuchtens) {
  // van Genuchten (1980), eq. (9): K_r over head with n = 2 (m = 1/2)
  const double h = 1.7, m = 0.5, n = 2;
  const double wet = std::pow(1 + std::pow(h, n), -m);
  const double expected =
      std::pow(1 - std::pow(h, n - 1) * std::pow(1 + std::pow(h, n), -m), 2) / std::pow(1 + std::pow(h, n), m / 2);
  EXPECT_NEAR(VanGenuchtenMualem{m}.liquid({wet, 1 - wet, h}), expected, 1e-14);
}

TEST(Curves, brooks_coreys_permeabilities_have_their_exponents) {
  // Brooks & Corey (1964), eqs. (14), (15): (2 + 3 l) / l = 4 and (2 + l) / l = 2 of l = 2; 3.5 and 1.5 of l = 4
  const Wetness half{0.5, 0.5, 0};
  EXPECT_NEAR(BrooksCoreyPermeability{2}.liquid(half), 1. / 16, 1e-15);
  EXPECT_NEAR(BrooksCoreyPermeability{2}.gas(half), 3. / 16, 1e-15);
  EXPECT_NEAR(BrooksCoreyPermeability{4}.liquid(half), std::sqrt(0.5) / 8, 1e-15);
  EXPECT_NEAR(BrooksCoreyPermeability{4}.gas(half), (1 - std::sqrt(0.5) / 2) / 4, 1e-15);
}

TEST(Curves, retention_falls_and_its_slope_and_inverse_are_its_own) {
  for (const std::string &text : soils) {
    const SoilPores soil = soil_of(text);
    const Retention &curve = soil.retention();
    double last = 1;
    for (double s = 10; s < 3e5; s *= 1.07) {
      const double S = saturation(curve, s), residual = residual_saturation(curve),
                   wet = (S - residual) / (1 - residual);
      if (wet < 1e-6) break;
      EXPECT_LE(S, last);
      last = S;
      EXPECT_NEAR(saturation_slope(curve, s),
                  (saturation(curve, s * (1 + 1e-5)) - saturation(curve, s * (1 - 1e-5))) / (2e-5 * s), 2e-5 * S / s)
          << text << s;
      if (wet < 1 - 1e-4) {
        EXPECT_NEAR(suction_at(curve, wet, 1 - wet), s, 1e-8 * s) << text;
      }
    }
    EXPECT_EQ(saturation(curve, -5), 1);
  }
}

TEST(Curves, tables_follow_the_curves) {
  // far below what anyone measures; measured points join with a jump of curvature, which one interval of the table
  // smooths
  for (const std::string &text : soils) {
    const SoilPores soil = soil_of(text);
    const double range = soil.largest_gas_share(),
                 near = std::holds_alternative<TabulatedRetention>(soil.retention()) ? 1e-5 : 2e-6;
    for (double dry = 1e-9; dry < 1; dry += 1.37e-3 * dry + 1e-9) {
      const double wet = 1 - dry, suction = suction_at(soil.retention(), wet, dry);
      const Wetness w{wet, dry, suction};
      const SoilPores::State state = soil.at(dry * range);
      EXPECT_NEAR(state.suction, suction, near * suction) << text << dry;
      EXPECT_NEAR(state.liquid, liquid_permeability(soil.relative(), w), 2e-6) << text << dry;
      EXPECT_NEAR(state.gas, gas_permeability(soil.relative(), w), 2e-6) << text << dry;
    }
  }
}

TEST(Curves, relative_permeabilities_end_at_one_and_nothing) {
  const Wetness full{1, 0, 0}, empty{1e-12, 1 - 1e-12, 1e12};
  for (const RelativePermeability &curve :
       {RelativePermeability(VanGenuchtenMualem{0.3}), RelativePermeability(Hillel{}),
        RelativePermeability(BrooksCoreyPermeability{2}), RelativePermeability(GardnerPermeability{1e4})}) {
    EXPECT_NEAR(liquid_permeability(curve, full), 1, 1e-12);
    EXPECT_NEAR(liquid_permeability(curve, empty), 0, 1e-4);
    EXPECT_NEAR(gas_permeability(curve, full), 0, 1e-12);
    EXPECT_NEAR(gas_permeability(curve, empty), 1, 1e-3);
  }
}

TEST(Curves, permeability_follows_porosity) {
  EXPECT_DOUBLE_EQ(permeability_factor(PermeabilityChange::none, 0.5, 0.3), 1);
  EXPECT_NEAR(permeability_factor(PermeabilityChange::kozeny_carman, 0.5, 0.3), (0.125 / 0.25) / (0.027 / 0.49), 1e-12);
  EXPECT_NEAR(permeability_factor(PermeabilityChange::grain_share, 0.5, 0.3), 0.49 / 0.25, 1e-12);
}

}  // namespace
}  // namespace talus
