// An integrator that looks ahead sees what it will get: forces of a trial state are those of the same state once
// accepted, bit by bit, and looking changes nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>

#include "soil.h"

namespace talus {
namespace {

std::string scene_of(int dimension, const std::string &transfer) {
  return "phases = \"dry\"\ndimension = " + std::to_string(dimension) + "\ngravity = 9.81\n[mesh]\nsection = \"" +
         TALUS_MESHES + "/dam.csv\"\nsize = 0.25\n" + (dimension == 3 ? "thickness = 0.5\nlayers = 0\n" : "") +
         "[body.soil]\nregion = \"soil\"\ndensity = 2000\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.3\nlaw = "
         "\"mohr_coulomb\"\n"
         "cohesion = \"2 kPa\"\nfriction_angle = 35\nresidual_cohesion = \"1 kPa\"\nresidual_friction_angle = "
         "25\nshape_factor = 50\n"
         "[boundary.base]\nkind = \"friction\"\nfriction_angle = 20\n[boundary.left]\nkind = "
         "\"roller\"\n[[stage]]\nduration = 1\n[transfer]\n" +
         transfer + "\n";
}

/// Compressed unevenly, so that some cells yield.
template <int dim>
void compress(Soil<dim> &soil) {
  ParticleArrays<dim> &p = soil.particles();
  for (int i = 0; i < p.count; ++i)
    for (int d = 0; d < 3; ++d)
      p.stress[i * stress_size<dim> + d] = -1e4 * (1 + std::sin(3 * p.position[i][0] + 2 * d));
}

template <int dim>
void expect_that_looking_ahead_is_exact(const std::string &transfer) {
  Soil<dim> soil(scene_of(dim, transfer), 0.1);
  compress(soil);
  SoilMotion<dim, Dry> &motion = *soil.motion;
  ASSERT_EQ(motion.begin(0), 0);
  const int size = motion.size();
  std::vector<double> u(size), v(size), start(size), du(size), dv(size), du2(size), dv2(size);
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < size / dim; ++i)
      for (int d = 0; d < dim; ++d) {
        const Vec<dim> &x = motion.grid().position[i];
        u[i * dim + d] = 2e-3 * std::sin(7 * x[0] + 5 * x[1] + d + round),
                    v[i * dim + d] = std::cos(4 * x[0] - 3 * x[1] + d);
      }
    ASSERT_EQ(motion.rates(0, nullptr, v.data(), start.data(), dv.data()), 0);
    std::vector<double> before = dv;
    ASSERT_EQ(motion.rates(0, u.data(), v.data(), du.data(), dv.data()), 0);
    EXPECT_FALSE(motion.inverted());
    ASSERT_EQ(motion.rates(0, nullptr, v.data(), du2.data(), dv2.data()), 0);
    EXPECT_EQ(std::memcmp(before.data(), dv2.data(), size * sizeof(double)), 0) << "looking ahead changes nothing";
    ASSERT_EQ(motion.accept(0, u.data(), v.data()), 0);
    ASSERT_EQ(motion.rates(0, nullptr, v.data(), du2.data(), dv2.data()), 0);
    EXPECT_EQ(std::memcmp(du.data(), du2.data(), size * sizeof(double)), 0);
    EXPECT_EQ(std::memcmp(dv.data(), dv2.data(), size * sizeof(double)), 0);
    double change = 0;
    for (int i = 0; i < size; ++i) change = std::max(change, std::abs(dv[i] - before[i]));
    EXPECT_GT(change, 1) << "the state is not the one before";
  }
  std::fill(u.begin(), u.end(), 0.);
  for (int i = 0; i < size / dim; ++i) u[i * dim] = -2 * motion.grid().position[i][0];  // mirrored
  ASSERT_EQ(motion.rates(0, u.data(), v.data(), du.data(), dv.data()), 0);
  EXPECT_TRUE(motion.inverted());
}

TEST(LookAhead, is_exact_on_triangles) { expect_that_looking_ahead_is_exact<2>(""); }
TEST(LookAhead, is_exact_on_tetrahedra) { expect_that_looking_ahead_is_exact<3>(""); }
TEST(LookAhead, is_exact_with_stress_per_particle) {
  expect_that_looking_ahead_is_exact<2>("average_stress = false\nlocking = \"nodal\"");
}

}  // namespace
}  // namespace talus
