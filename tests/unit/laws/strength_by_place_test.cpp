// Strength that differs from place to place: points that have shares of a law's c and phi, and the functions of a
// scene.
#include "physics/laws/strength_by_place.h"

#include "examples.h"
#include "scene/reader.h"

namespace talus {
namespace {

/// Points with these shares of the law's strength are those of soil that has this strength itself, to the round-off of
/// c and phi, in every compiled case and in the tangent.
template <class OneLaw>
void expect_shares_are_strength() {
  constexpr double of_c = 0.37, of_phi = 0.62;
  Random random;
  for (OneLaw whole : examples<OneLaw>()) {
    OneLaw part = whole;
    part.cohesion *= of_c, part.friction_angle *= of_phi;
    if (part.residual_cohesion > 0) part.residual_cohesion *= of_c;
    if (part.residual_friction_angle > 0) part.residual_friction_angle *= of_phi;
    whole.reads_shares = true;
    constexpr int count = 40;
    Points<3> shared(whole, count, 0.5);
    for (int i = 0; i < count; ++i) {
      shared.stress[i] = random.symmetric<3>(5e3);
      for (int k = 0; k < 3; ++k) shared.stress[i][k] -= 30e3;
      shared.increment[i].strain = random.symmetric<3>(3e-3);
    }
    Points<3> own = shared;
    own.law = part;
    const std::vector<double> c(count, of_c), phi(count, of_phi);
    StressPoints<3> view = shared.view();
    view.cohesion_share = c.data(), view.friction_share = phi.data();
    std::vector<double> tangent(count * 36), own_tangent(count * 36);
    admit_stress<3>(shared.law, view), own.admit();
    update_stress_with_tangent<3>(shared.law, view, tangent.data());
    update_stress_with_tangent<3>(own.law, own.view(), own_tangent.data());
    for (int i = 0; i < count; ++i)
      for (int k = 0; k < 6; ++k) EXPECT_NEAR(shared.stress[i][k], own.stress[i][k], 1e-6) << OneLaw::name;
    for (std::size_t k = 0; k < tangent.size(); ++k) EXPECT_NEAR(tangent[k], own_tangent[k], 1) << OneLaw::name;
  }
}
TEST(StrengthByPlace, is_the_strength_of_a_law_of_its_own_mohr_coulomb) { expect_shares_are_strength<MohrCoulomb>(); }
TEST(StrengthByPlace, is_the_strength_of_a_law_of_its_own_drucker_prager) {
  expect_shares_are_strength<DruckerPrager>();
}
TEST(StrengthByPlace, is_the_strength_of_a_law_of_its_own_hencky) { expect_shares_are_strength<HenckyMohrCoulomb>(); }

/// Each point reads its own shares, in all lanes of a block and beyond; without arrays the shares are 1, and soil that
/// does not read them does not change if they are there.
TEST(StrengthByPlace, differs_from_point_to_point) {
  for (const bool softening : {false, true}) {
    MohrCoulomb clay = mohr_coulomb(40e3, 0);
    if (softening) clay.shape_factor = 1e-9;
    clay.reads_shares = true;
    constexpr int count = 21;
    Points<2> points(clay, count);
    std::vector<double> share(count), one(count, 1);
    for (int i = 0; i < count; ++i) {
      share[i] = (i + 1.) / count, points.stress[i] = {-4e4, -4e4, -4e4, 0};
      points.increment[i].strain = {0, 0, 0, 0.05};
    }
    Points<2> plain = points, blind = points;
    clay.reads_shares = false, blind.law = clay;
    StressPoints<2> view = points.view(), unread = blind.view();
    view.cohesion_share = share.data(), view.friction_share = one.data();
    unread.cohesion_share = share.data(), unread.friction_share = one.data();
    update_stress<2>(points.law, view), update_stress<2>(blind.law, unread);
    plain.update();
    for (int i = 0; i < count; ++i) {
      EXPECT_NEAR(points.stress[i][3], 40e3 * share[i], 1e-7);
      EXPECT_NEAR(plain.stress[i][3], 40e3, 1e-7);
      EXPECT_NEAR(blind.stress[i][3], 40e3, 1e-7);
    }
  }
}

/// A ratio is that of each place, which one number for the residual strength cannot be.
TEST(StrengthByPlace, softens_to_a_ratio_of_the_peak_of_each_point) {
  MohrCoulomb clay = mohr_coulomb(40e3, 0);
  clay.residual_ratio = 0.25, clay.shape_factor = 50, clay.reads_shares = true;
  constexpr int count = 10;
  Points<2> points(clay, count);
  std::vector<double> share(count), whole(count, 1);
  for (int i = 0; i < count; ++i) {
    share[i] = (i + 1.) / count, points.stress[i] = {-4e4, -4e4, -4e4, 0};
    points.increment[i].strain = {0, 0, 0, 0.05};
  }
  StressPoints<2> view = points.view();
  view.cohesion_share = share.data(), view.friction_share = whole.data();
  for (int step = 0; step < 50; ++step) update_stress<2>(points.law, view);
  for (int i = 0; i < count; ++i) EXPECT_NEAR(points.stress[i][3], 0.25 * 40e3 * share[i], 1e-3);
}

struct Soil {
  DeferredTable law;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.deferred("law", law, "soil model");
  }
};
DeferredTable table(const std::string &keys) {
  Soil soil;
  TableReader::from_text("young_modulus = 1e7\npoisson_ratio = 0.3\n" + keys, "slope.toml").fill(soil);
  return soil.law;
}

TEST(StrengthByPlace, is_read_from_expressions) {
  const DeferredTable body =
      table("law = \"mohr_coulomb\"\ncohesion = \"20e3 + 1500 * (10 - y)\"\nfriction_angle = 30\n");
  Law law = read_law(body);
  EXPECT_TRUE(reads_shares(law));
  EXPECT_TRUE(strength_varies(law));
  const StrengthByPlace strength(body, law);
  ASSERT_TRUE(strength.given());
  StrengthRange range = strength_of(law);
  strength.widen(range, 0, 4, 0), strength.widen(range, 7, 10, 0);
  EXPECT_EQ(range.cohesion[0], 20e3);
  EXPECT_EQ(range.cohesion[1], 29e3);
  EXPECT_EQ(take_largest(law, range), "");
  EXPECT_EQ(frictional_strength(law)->cohesion, 29e3);
  EXPECT_NEAR(frictional_strength(law)->friction_angle, 30 * degree.si, 1e-15);
  EXPECT_DOUBLE_EQ(strength.shares(law, 3, 6, 0).cohesion, 26. / 29);
  EXPECT_EQ(strength.shares(law, 3, 6, 0).friction, 1);
  const DeferredTable numbers = table("law = \"drucker_prager\"\ncohesion = \"20 kPa\"\nfriction_angle = 30\n");
  EXPECT_FALSE(reads_shares(read_law(numbers)));
  EXPECT_FALSE(StrengthByPlace(numbers, read_law(numbers)).given());
}

/// Values outside of the range of the key, and what is no number, are faults that name their place; 70 degrees are
/// allowed.
TEST(StrengthByPlace, is_checked_at_its_places) {
  const auto fault_at = [](double x) {
    const DeferredTable body =
        table("law = \"hencky_drucker_prager\"\ncohesion = \"1 / (x != 3)\"\nfriction_angle = \"x * 10\"\n");
    const StrengthByPlace strength(body, read_law(body));
    StrengthRange range = strength_of(read_law(body));
    strength.widen(range, x, 0, 0);
    return body.reader->function_fault();
  };
  const auto says = [&](double x, const char *words) { return fault_at(x).find(words) != std::string::npos; };
  EXPECT_EQ(fault_at(7), "");
  EXPECT_TRUE(says(3, "cohesion = \"1 / (x != 3)\" must be a number from 0 to 1e9 Pa; it is inf Pa at x = 3 m"))
      << fault_at(3);
  EXPECT_TRUE(says(8, "friction_angle = \"x * 10\" must be a number from 0 to 70 deg; it is 80 deg at x = 8 m"))
      << fault_at(8);
  EXPECT_TRUE(says(-1, "it is -10 deg at x = -1 m")) << fault_at(-1);
}

std::string complaint(const std::string &keys) {
  try {
    read_law(table(keys));
  } catch (const SceneError &error) {
    return error.what();
  }
  return "";
}

TEST(StrengthByPlace, is_refused_where_it_makes_no_sense) {
  struct Fault {
    std::string keys, words;
  };
  const std::string soil = "law = \"mohr_coulomb\"\nfriction_angle = 30\n";
  for (const Fault &fault :
       {Fault{soil + "cohesion = \"1e3 * t\"\n", "line 5: cohesion = \"1e3 * t\""},
        {soil + "cohesion = \"1e3 * t\"\n", "or an expression of x, y, z; it cannot depend on t"},
        {soil + "cohesion = \"table\"\n", "it cannot depend on table"},
        {soil + "cohesion = [[0, 1], [1, 2]]\n", "0 to 1e9 Pa, or an expression of x, y, z"},
        {soil + "cohesion = \"1e3 * depth\"\n", "depth"},
        {soil, "needs cohesion"},
        {soil + "cohesion = \"1e3 * y\"\nresidual_cohesion = 100\nshape_factor = 5\n",
         "residual_cohesion = 100 must be 0, or negative (the peak), where the peak is a function of place"},
        {"law = \"cam_clay\"\ncohesion = \"1e3 * y\"\ncompression_slope = 0.2\nswelling_slope = 0.04\n"
         "critical_stress_ratio = 1\nvoid_ratio = 1\npreconsolidation_pressure = \"1e5 * y\"\n",
         "preconsolidation_pressure"}}) {
    const std::string said = complaint(fault.keys);
    EXPECT_NE(said.find(fault.words), std::string::npos) << fault.keys << said;
  }
  EXPECT_EQ(complaint(soil + "cohesion = \"1e3 * y\"\nresidual_cohesion = 0\nshape_factor = 5\n"), "");
}

}  // namespace
}  // namespace talus
