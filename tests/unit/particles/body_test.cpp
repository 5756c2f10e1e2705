// Claims of particles/body.h: the volume that particles may take, and particles that are taken out.
#include "particles/body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "physics/laws/laws.h"
#include "scene/body_source.h"

namespace talus {
namespace {

MohrCoulomb soil(double cohesion, double dilation_degrees) {
  MohrCoulomb law;
  law.young_modulus = 20e6, law.poisson_ratio = 0.3;
  law.cohesion = cohesion, law.friction_angle = 35 * degree.si, law.dilation_angle = dilation_degrees * degree.si;
  return law;
}

constexpr double initial = 2;  // volume [m3]

/// The volume of a particle that deformation would give a `volume`, after a dilation.
double admitted(double volume, const Law &law, double dilation, double volume_cap = -1) {
  BodySource source;
  source.volume_cap = volume_cap;
  Body<2> body;
  EXPECT_EQ(body.create(PETSC_COMM_SELF, source, law, 0, 0), 0);
  std::vector<double> history(history_size(law), 2);
  if (const int field = history_field(law, "dilation"); field >= 0) history[field] = dilation;
  return body.admissible_volume(volume, initial, history.data());
}

/// The largest volume of a particle after a dilation.
double limit(const Law &law, double dilation, double volume_cap = -1) {
  return admitted(std::numeric_limits<double>::infinity(), law, dilation, volume_cap);
}

TEST(VolumeLimit, is_the_initial_volume_of_soil_that_comes_apart) {
  constexpr double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(limit(soil(0, 0), 0), initial);
  EXPECT_EQ(limit(soil(1e3, 0), 0), initial) << "also with cohesion";
  EXPECT_EQ(limit(MuI{}, 0), initial);
  EXPECT_EQ(limit(soil(1e3, 0), 0, 1.2), 1.2 * initial) << "where the scene asks for more";
  EXPECT_EQ(limit(soil(0, 0), 0, 0), none) << "where the scene wants none";
  EXPECT_EQ(limit(LinearElastic{}, 0), none) << "which does not come apart";
  EXPECT_EQ(limit(LinearElastic{}, 0, 1.2), 1.2 * initial);
}

/// Dilatant soil grows as it shears: by ln(V / V_0), its dilation. The limit grows with it.
TEST(VolumeLimit, rises_with_dilation) {
  EXPECT_NEAR(limit(soil(0, 10), 0.3), initial * std::exp(0.3), 1e-14 * initial);
  EXPECT_NEAR(limit(soil(0, 10), 0.3, 1.2), 1.2 * initial * std::exp(0.3), 1e-14 * initial);
  EXPECT_EQ(limit(soil(0, 10), 0), initial);
  EXPECT_EQ(limit(soil(0, 10), -0.3), initial) << "compaction does not lower it";
}

/// The rest volume of one particle whose stress is set, of a volume of 2.
double rest(const Law &law, double mean_pressure, double dilation) {
  const BodySource source;
  Body<2> body;
  EXPECT_EQ(body.create(PETSC_COMM_SELF, source, law, 0, 0), 0);
  EXPECT_EQ(body.resize(1), 0);
  ParticleArrays<2> &p = body.particles();
  p.volume[0] = initial;
  for (int s = 0; s < stress_size<2>; ++s) p.stress[s] = s < 3 ? -mean_pressure + (s - 1) * 1e4 : 5e3;
  for (int h = 0; h < body.history_count(); ++h) p.history[h] = h == history_field(law, "dilation") ? dilation : 2;
  body.refer_to_stress(0);
  return p.rest_volume[0];
}

/// By the bulk modulus, E / 3 (1 - 2 nu) = 16.7 MPa: soil that is unloaded expands and has no gaps.
TEST(RestVolume, is_that_without_stress) {
  EXPECT_NEAR(rest(soil(1e3, 0), 3e5, 0), initial * std::exp(3e5 * 1.2 / 20e6), 1e-14 * initial);
  EXPECT_EQ(rest(soil(1e3, 0), 0, 0), initial);
  EXPECT_EQ(rest(soil(1e3, 0), -1e3, 0), initial) << "tension is not taken back";
  EXPECT_NEAR(rest(soil(0, 10), 0, 0.3), initial * std::exp(-0.3), 1e-14 * initial) << "nor is dilation in it";
}

/// The force p V of a law whose pressure is K ln(V_0 / V) is largest at V_0 / e: below, soil would resist less the more
/// it is compressed.
TEST(VolumeLimit, keeps_the_volume_at_which_force_is_largest) {
  EXPECT_NEAR(admitted(1e-9, soil(0, 0), 0), initial / std::exp(1.), 1e-15 * initial);
  EXPECT_NEAR(admitted(1e-9, soil(0, 10), 0.3), initial / std::exp(1.), 1e-15 * initial);
  EXPECT_EQ(admitted(0.4 * initial, soil(0, 0), 0), 0.4 * initial);
  EXPECT_EQ(admitted(1e-9, soil(1e3, 0), 0, 0), 1e-9) << "no limits where there is no cap";
}

/// Those that stay keep their order and all their fields; numbers and positions tell them apart.
TEST(Body, loses_the_particles_that_are_taken_out_and_no_others) {
  BodySource source;
  Body<2> body;
  constexpr int count = 500;  // more than the spare room of a swarm
  ASSERT_EQ(body.create(PETSC_COMM_SELF, source, soil(1e3, 5), 1, 0), 0);
  ASSERT_EQ(body.resize(count), 0);
  const auto fill = [&](int i) {
    ParticleArrays<2> &p = body.particles();
    p.id[i] = 1000 + i, p.cell[i] = i, p.mass[i] = i, p.volume[i] = 2 * i, p.position[i] = {3. * i, 4. * i};
    p.fluid_mass[0][i] = 5 * i, p.fluid_velocity[0][i] = {6. * i, 7. * i};
    for (int k = 0; k < stress_size<2>; ++k) p.stress[i * stress_size<2> + k] = 8 * i + k;
    for (int h = 0; h < body.history_count(); ++h) p.history[i * body.history_count() + h] = 9 * i + h;
  };
  for (int i = 0; i < count; ++i) fill(i);
  std::vector<int> gone, kept;
  for (int i = 0; i < count; ++i) (i == 0 || i == count - 1 || i % 3 == 1 ? gone : kept).push_back(i);
  ASSERT_EQ(body.remove(gone), 0);
  const ParticleArrays<2> &p = body.particles();
  ASSERT_EQ(p.count, static_cast<int>(kept.size()));
  for (int j = 0; j < p.count; ++j) {
    const int i = kept[j];
    EXPECT_EQ(p.id[j], 1000 + i);
    EXPECT_EQ(p.cell[j], i);
    EXPECT_EQ(p.mass[j], i);
    EXPECT_EQ(p.volume[j], 2 * i);
    EXPECT_EQ(p.position[j], (Vec<2>{3. * i, 4. * i}));
    EXPECT_EQ(p.fluid_mass[0][j], 5 * i);
    EXPECT_EQ(p.fluid_velocity[0][j], (Vec<2>{6. * i, 7. * i}));
    EXPECT_EQ(p.stress[j * stress_size<2> + 3], 8 * i + 3);
    EXPECT_EQ(p.history[j * body.history_count()], 9 * i);
  }
  std::vector<int> all(p.count);
  for (int j = 0; j < p.count; ++j) all[j] = j;
  ASSERT_EQ(body.remove(all), 0);
  EXPECT_EQ(body.particles().count, 0);
}

}  // namespace
}  // namespace talus
