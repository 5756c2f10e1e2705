// Retention curves and relative permeabilities: what their sources print, what all have in common, and how near the
// tables are.
#include <gtest/gtest.h>

#include "fixtures.h"
#include "physics/pores/mean_permeability.h"
#include "solvers/quasi_static/cell_permeability.h"

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

/// Over suctions from a hundredth of a pascal to a megapascal: narrow and wide ranges, with and without a part in full
/// pores, against an integral over the logarithm of suction.
TEST(Curves, mean_permeability_is_the_mean_over_pressures) {
  for (const std::string &text : soils) {
    const SoilPores soil = soil_of(text);
    const MeanPermeability mean(soil);
    const auto at = [&](double p) { return liquid_permeability_at(soil, p); };
    const auto integral = [&](double wet, double dry) {  // of suctions
      constexpr int parts = 20000;
      const double least = std::max(wet, 1e-7);
      double sum = least - wet;  // where soil is full
      for (int k = 0; k < parts; ++k) {
        const double a = least * std::pow(dry / least, static_cast<double>(k) / parts),
                     b = least * std::pow(dry / least, (k + 1.) / parts);
        sum += (b - a) * (at(-a) + 4 * at(-(a + b) / 2) + at(-b)) / 6;
      }
      return sum;
    };
    for (const double p : {300., 0., -1e-2, -7., -3e3, -2e4, -4e5})
      for (const double q : {-1.1e-2, -7.2, -8., -3.1e3, -3e4, -1e6}) {
        const double wet = std::max(p, q), dry = std::min(p, q);
        const double expected = (std::max(0., wet) + integral(std::max(0., -wet), -dry)) / (wet - dry);
        // kinks of measured points and of an air entry are smoothed over an interval of the table, 2 % of a suction
        EXPECT_NEAR(mean.between(p, at(p), q, at(q)), expected, 1e-3 * expected + 1e-12) << text << p << " " << q;
        EXPECT_EQ(mean.between(p, at(p), q, at(q)), mean.between(q, at(q), p, at(p)));
      }
    EXPECT_EQ(mean.between(5, 1, 700, 1), 1);
  }
}

/// Along a line of pressures it is the mean over them without weight, and that of the vertices where nothing but weight
/// drives; its derivative is its own.
TEST(Curves, permeability_of_a_cell_is_that_of_its_pressures_or_of_its_vertices) {
  const SoilPores soil = soil_of(silt);
  const MeanPermeability mean(soil);
  const std::array<Vec<2>, 3> gradient{{{-2, -1.5}, {2, 0}, {0, 1.5}}};
  const auto cell = [&](std::array<double, 3> p, double weight, bool slope = false) {
    return cell_permeability<2>(soil, mean, p, gradient, weight, slope);
  };
  const auto at = [&](double p) { return liquid_permeability_at(soil, p); };
  const double along = mean.between(0, 1, -2e5, at(-2e5)), vertices = (1 + 2 * at(-2e5)) / 3;
  EXPECT_NEAR(cell({0, -2e5, -2e5}, 0).value, along, 1e-14);
  EXPECT_NEAR(cell({0, -2e5, -2e5}, 1e20).value, vertices, 1e-14);
  EXPECT_NEAR(cell({0, -2e5, -2e5}, 5e5).value, (along + vertices) / 2, 1e-14);  // as steep as heavy
  EXPECT_NEAR(cell({-1e4, -1e4, -1e4}, 0).value, at(-1e4), 1e-14);
  EXPECT_EQ(cell({0, 4, 5}, 1e4).value, 1);
  // pressures that differ by their last digit have no gradient, and no weight is there either
  const std::array<Vec<2>, 3> flat{};
  EXPECT_NEAR(cell_permeability<2>(soil, mean, {-5e4, std::nextafter(-5e4, 0.), -5e4}, flat, 0, true).value, at(-5e4),
              1e-12);
  for (const auto &p : {std::array{100., -3e4, -2e5}, {-1e3, -1.01e3, -5e4}, {-2e4, -2.1e4, -2.05e4}})
    for (const double weight : {0., 1e4, 1e6}) {
      const auto found = cell(p, weight, true);
      for (int a = 0; a < 3; ++a) {
        const double step = 1e-4 * std::abs(p[a]);
        auto more = p, less = p;
        more[a] += step, less[a] -= step;
        const double slope = (cell(more, weight).value - cell(less, weight).value) / (2 * step);
        EXPECT_NEAR(found.slope[a], slope, 1e-3 * std::abs(slope) + 1e-6 * found.value / 1e4) << p[0] << " " << a;
      }
    }
}

TEST(Curves, permeability_follows_porosity) {
  EXPECT_DOUBLE_EQ(permeability_factor(PermeabilityChange::none, 0.5, 0.3), 1);
  EXPECT_NEAR(permeability_factor(PermeabilityChange::kozeny_carman, 0.5, 0.3), (0.125 / 0.25) / (0.027 / 0.49), 1e-12);
  EXPECT_NEAR(permeability_factor(PermeabilityChange::grain_share, 0.5, 0.3), 0.49 / 0.25, 1e-12);
}

}  // namespace
}  // namespace talus
