// Pressures from contents: identities, the path through saturation, and what it costs.
#include <gtest/gtest.h>

#include <random>

#include "fixtures.h"
#include "physics/pores/hyperbolicity.h"
#include "scene/water_source.h"

namespace talus {
namespace {

Liquid water() {
  Water w;
  w.bulk_modulus = 1e8;
  return Liquid(w);
}
PoreGas air() { return PoreGas(Gas{}); }

struct Solved : PorePressures {
  int iterations;
};
/// One point, whose gas share is the start and becomes the result.
Solved unsaturated_pressure(const SoilPores &soil, const Liquid &liquid, double content, double &gas_share) {
  PoreLanes<1> p{{content}, {0}, {gas_share}, {}, {}, {}};
  unsaturated_pressures(soil, liquid, p);
  gas_share = p.gas_share[0];
  return {{p.liquid[0], p.gas[0]}, p.iterations[0]};
}
Solved three_phase_pressure(const SoilPores &soil, const Liquid &liquid, const PoreGas &gas, double content,
                            double gas_content, double &gas_share) {
  PoreLanes<1> p{{content}, {gas_content}, {gas_share}, {}, {}, {}};
  three_phase_pressures(soil, liquid, gas, p);
  gas_share = p.gas_share[0];
  return {{p.liquid[0], p.gas[0]}, p.iterations[0]};
}

TEST(Storage, liquids_invert_their_density) {
  for (const Compression law : {Compression::linear, Compression::exponential}) {
    Water w;
    w.bulk_modulus = 2e7, w.compression = law;
    const Liquid liquid(w);
    for (double p : {-1e5, 0., 3e6}) {
      EXPECT_NEAR(liquid.pressure_at(liquid.density_at(p)), p, 1e-6);
      const double rho = liquid.density_at(p);
      EXPECT_NEAR(liquid.density_slope(rho), (liquid.density_at(p + 10) - liquid.density_at(p - 10)) / 20,
                  1e-7 * rho / 2e7);
    }
  }
}

TEST(Storage, liquid_that_cavitates_keeps_its_mass) {
  for (const double stiffness : {2e7, 2e4})  // the softer one has no density at which it would
    for (const Compression law : {Compression::linear, Compression::exponential}) {
      Water w;
      w.bulk_modulus = stiffness, w.compression = law;
      const Liquid liquid(w);
      const double thinnest = liquid.density_at(-100e3);
      for (const double content : {1020., 1000., 1.0001 * thinnest, 0.9999 * thinnest, 700., 10.}) {
        if (content <= 0) continue;
        PoreLanes<1> p{{content}, {0}, {0.5}, {}, {}, {}};
        saturated_pressures(liquid, p);
        EXPECT_NEAR(p.liquid[0], std::max(liquid.pressure_at(content), -100e3), 1e-6);
        EXPECT_NEAR((1 - p.gas_share[0]) * std::max(content, thinnest), content, 1e-9);
      }
    }
}

TEST(Storage, unsaturated_pressure_holds_the_content) {
  std::mt19937 random(3);
  std::uniform_real_distribution<> wide(0, 1);
  const Liquid liquid = water();
  for (const std::string &text : soils) {
    const SoilPores soil = soil_of(text);
    for (int k = 0; k < 2000; ++k) {
      const double y = soil.largest_gas_share() * std::pow(wide(random), k % 5 + 1) * 0.98;
      if (soil.suction(y) > 0.5 * liquid.bulk_modulus) continue;  // water torn apart
      const double content = (1 - y) * liquid.density_at(-soil.suction(y));
      double share = wide(random) * soil.largest_gas_share();  // from anywhere
      const Solved p = unsaturated_pressure(soil, liquid, content, share);
      // the content is what counts: its round-off is the share's tolerance
      EXPECT_NEAR((1 - share) * liquid.density_at(-soil.suction(share)), content, 1e-9 * content) << text << y;
      EXPECT_LT(p.iterations, 60);
    }
  }
}

TEST(Storage, three_phases_hold_both_contents) {
  std::mt19937 random(4);
  std::uniform_real_distribution<> wide(0, 1);
  const Liquid liquid = water();
  const PoreGas gas = air();
  for (const std::string &text : soils) {
    const SoilPores soil = soil_of(text);
    for (int k = 0; k < 2000; ++k) {
      const double y =
          residual_gas + (soil.largest_gas_share() - residual_gas) * std::pow(wide(random), k % 5 + 1) * 0.98;
      const double pg = 1e5 * (wide(random) - 0.5), pl = pg - soil.suction(y);
      if (pl < -0.9 * liquid.bulk_modulus) continue;
      double share = wide(random);
      const PorePressures p =
          three_phase_pressure(soil, liquid, gas, (1 - y) * liquid.density_at(pl), y * gas.density_at(pg), share);
      EXPECT_NEAR(share, y, 2e-6 * y) << text;
      EXPECT_NEAR(p.gas, pg, 0.5 + 1e-5 * soil.suction(y)) << text << y;
      EXPECT_NEAR(p.liquid, pl, 0.5 + 1e-5 * soil.suction(y)) << text << y;
    }
  }
}

TEST(Storage, a_lane_does_not_depend_on_the_others) {
  std::mt19937 random(5);
  std::uniform_real_distribution<> wide(0, 1);
  const PoreGas gas = air();
  Water exponential;
  exponential.bulk_modulus = 1e8, exponential.compression = Compression::exponential;
  for (const Liquid &liquid : {water(), Liquid(exponential)})
    for (const std::string &text : soils) {
      const SoilPores soil = soil_of(text);
      for (int k = 0; k < 200; ++k) {
        PoreLanes<8> one, two;
        for (int i = 0; i < 8; ++i) {
          const double y = 1.2 * std::pow(wide(random), 4) -
                           0.01;  // also saturated pores, and drier ones than the residual water allows
          one.liquid_content[i] = two.liquid_content[i] = std::max(1., 1000 * (1 - y));
          one.gas_content[i] = two.gas_content[i] = std::max(residual_gas, y) * gas.density;
          one.gas_share[i] = two.gas_share[i] = std::clamp(y, 0., 1.);
        }
        unsaturated_pressures(soil, liquid, one), three_phase_pressures(soil, liquid, gas, two);
        for (int i = 0; i < 8; ++i) {
          const double content = one.liquid_content[i];
          double share = std::clamp(1 - content / 1000, 0., 1.), other = share;
          const Solved p = unsaturated_pressure(soil, liquid, content, share),
                       q = three_phase_pressure(soil, liquid, gas, content, two.gas_content[i], other);
          EXPECT_NEAR(one.gas_share[i], share, 1e-12) << text << content;
          EXPECT_NEAR(one.liquid[i], p.liquid, 1e-9 * (1e8 + std::abs(p.liquid))) << text << content;
          EXPECT_NEAR(two.gas_share[i], other, 1e-12) << text << content;
          EXPECT_NEAR(two.liquid[i], q.liquid, 1e-9 * (1e8 + std::abs(q.liquid))) << text << content;
        }
      }
    }
}

TEST(Storage, newton_takes_three_steps_in_the_mean_along_a_path) {
  // wetting and drying through saturation in steps of 0.05 % of the pores, as large as a step of a run ever makes them
  const SoilPores soil = soil_of(silt);
  const Liquid liquid = water();
  const PoreGas gas = air();
  double dry_share = 0.5, share = 0.5, gas_content = 0.3 * gas.density;
  long iterations = 0, gas_iterations = 0, count = 0;
  for (int k = 0; k < 4000; ++k) {
    const double content = 1000 * (0.7 + 0.305 * std::sin(k * 1.6e-3));
    iterations += unsaturated_pressure(soil, liquid, content, dry_share).iterations;
    gas_content = std::max(residual_gas, 1 - content / 1000) * gas.density;
    gas_iterations += three_phase_pressure(soil, liquid, gas, content, gas_content, share).iterations;
    ++count;
  }
  EXPECT_LE(static_cast<double>(iterations) / count, 3);
  EXPECT_LE(static_cast<double>(gas_iterations) / count, 3);
}

TEST(Storage, passes_through_saturation_without_a_jump) {
  for (const std::string &text : {soils[0], soils[1]}) {
    const SoilPores soil = soil_of(text);
    const Liquid liquid = water();
    const PoreGas gas = air();
    double share = 1e-3, trapped = 1e-3, last = 0, last_trapped = 0;
    std::vector<double> up, down;
    const int n = 2000;
    for (int k = 0; k <= 2 * n; ++k) {
      const double part = (k <= n ? k : 2 * n - k) / static_cast<double>(n), content = 999 + 1.2 * part;
      const double p = unsaturated_pressure(soil, liquid, content, share).liquid;
      const double q = three_phase_pressure(soil, liquid, gas, content, 2e-4 * gas.density, trapped).liquid;
      (k <= n ? up : down).push_back(p);
      if (k) {
        EXPECT_LT(std::abs(p - last), 1.2 * liquid.bulk_modulus * 1.2e-3 / n)
            << text << content;  // never stiffer than the liquid
        EXPECT_LT(std::abs(q - last_trapped), 1.2 * liquid.bulk_modulus * 1.2e-3 / n) << text << content;
      }
      last = p, last_trapped = q;
    }
    for (int k = 0; k < n; ++k) EXPECT_NEAR(down[k], up[n - 1 - k], 1e-2) << "the way back is the way there";
  }
}

TEST(Storage, tangent_is_the_derivative_and_symmetric) {
  const SoilPores soil = soil_of(silt);
  const Liquid liquid = water();
  const PoreGas gas = air();
  double y = 0.2;
  const double cl = (1 - y) * liquid.density_at(-soil.suction(y)), cg = y * gas.density;
  const PorePressures p = three_phase_pressure(soil, liquid, gas, cl, cg, y);
  const StorageTangent k = storage_tangent(soil, liquid, gas, p, y);
  const double rl = liquid.density_at(p.liquid), rg = gas.density_at(p.gas);
  for (const auto &[dl, dg] : {std::pair{1e-5, 0.}, {0., 1e-5}}) {  // relative changes of content per pore volume
    double share = y;
    const PorePressures q = three_phase_pressure(soil, liquid, gas, cl + dl * rl, cg + dg * rg, share);
    EXPECT_NEAR(k.ll * (q.liquid - p.liquid) + k.lg * (q.gas - p.gas), dl, 2e-8);
    EXPECT_NEAR(k.lg * (q.liquid - p.liquid) + k.gg * (q.gas - p.gas), dg, 2e-8);
  }
}

TEST(Hyperbolicity, bishops_stress_keeps_it_and_net_stress_loses_it_near_saturation) {
  // symmetric storage makes Bishop's system symmetric but for the term of d S_l, which is small where suction is
  const SoilPores soil = soil_of(silt);
  Water w;
  w.bulk_modulus = 1e8;
  const Liquid liquid(w);
  int lost_net = 0, lost_bishop = 0;
  for (double share = 2e-4; share < 0.5; share *= 1.1) {
    lost_net += !hyperbolic(soil, liquid, air(), 1e6, 2700, share, true, false);
    lost_bishop += !hyperbolic(soil, liquid, air(), 1e6, 2700, share, true, true);
  }
  EXPECT_GT(lost_net, 0);
  EXPECT_EQ(lost_bishop, 0);
}

// at the driest states suction is so large that water has no density left
TEST(Hyperbolicity, has_an_answer_up_to_the_driest_state) {
  const SoilPores soil = soil_of(silt);
  Water w;
  w.bulk_modulus = 1e8;
  w.compression = Compression::exponential;
  const Liquid liquid(w);
  for (const double left : {1e-2, 1e-4, 1e-6, 1e-9})
    for (const bool gas_moves : {true, false})
      EXPECT_NO_THROW(
          (void)hyperbolic(soil, liquid, air(), 1e6, 2700, (1 - left) * soil.largest_gas_share(), gas_moves, true));
  EXPECT_THROW((void)eigenvalues(Eigen::Matrix2d::Constant(NAN)), std::runtime_error);
}

// One linearised step: right to second order where the storage hardly changes, far off where it jumps.
TEST(NaiveStorage, is_right_far_from_saturation_and_wrong_across_it) {
  const SoilPores soil = soil_of(silt);
  const Liquid liquid = water();
  const auto content = [&](double p) { return (p < 0 ? saturation(soil.retention(), -p) : 1) * liquid.density_at(p); };
  for (const double step : {100., 10.}) {
    const double told = content(-5e4 + step), got = content_by_rate(soil, liquid, -5e4, told);
    EXPECT_LT(std::abs(got - told), 1e-4 * std::abs(told - content(-5e4)) * step / 10);
  }
  const double told = content(-1e3), got = content_by_rate(soil, liquid, 0, told);  // as if water alone had to stretch
  EXPECT_LT(got, told - 10 * (content(0) - told));
}

}  // namespace
}  // namespace talus
