// Claims of particles/body.h about the volume that particles may take.
#include "particles/body.h"

#include <gtest/gtest.h>

#include <cmath>

namespace talus {
namespace {

MohrCoulomb soil(double cohesion, double dilation_degrees) {
  MohrCoulomb law;
  law.young_modulus = 20e6, law.poisson_ratio = 0.3;
  law.cohesion = cohesion, law.friction_angle = 35 * degree.si, law.dilation_angle = dilation_degrees * degree.si;
  return law;
}

constexpr double initial = 2;  // volume [m3]

/// The limit of a particle after a plastic expansion.
double limit(const Law &law, double plastic_volume, double volume_cap = -1) {
  BodySource source;
  source.volume_cap = volume_cap;
  Body<2> body;
  EXPECT_EQ(body.create(PETSC_COMM_SELF, source, law, 0, 0), 0);
  std::vector<double> history(history_size(law), 0.7);
  for (std::size_t h = 0; h < history.size(); ++h)
    if (std::string(history_fields(law)[h].name) == "plastic_volume") history[h] = plastic_volume;
  return body.volume_limit(initial, history.data());
}

TEST(VolumeLimit, is_the_initial_volume_of_cohesionless_soil) {
  EXPECT_EQ(limit(soil(0, 0), 0), initial);
  EXPECT_EQ(limit(MuI{}, 0), initial);
  EXPECT_EQ(limit(soil(0, 0), 0, 1.2), 1.2 * initial);
  EXPECT_EQ(limit(soil(1e3, 0), 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(limit(soil(1e3, 0), 0, 1.2), 1.2 * initial) << "where the scene asks for it";
  EXPECT_EQ(limit(soil(0, 0), 0, 0), std::numeric_limits<double>::infinity()) << "where the scene wants none";
}

/// Dilatant soil grows as it shears: by ln(V / V_0), its plastic volumetric strain. The limit grows with it.
TEST(VolumeLimit, rises_with_dilation) {
  EXPECT_NEAR(limit(soil(0, 10), 0.3), initial * std::exp(0.3), 1e-14 * initial);
  EXPECT_NEAR(limit(soil(0, 10), 0.3, 1.2), 1.2 * initial * std::exp(0.3), 1e-14 * initial);
  EXPECT_EQ(limit(soil(0, 10), 0), initial);
  EXPECT_EQ(limit(soil(0, 10), -0.3), initial) << "compaction does not lower it";
}

/// Plastic volume of soil that does not dilate comes from opening gaps, which are not the soil's.
TEST(VolumeLimit, does_not_rise_with_gaps) {
  EXPECT_EQ(limit(soil(0, 0), 0.3), initial);
  EXPECT_EQ(limit(MuI{}, 0.3), initial);
}

}  // namespace
}  // namespace talus
