// Limit loads of a few cells that are known: a weightless block between a smooth base and a smooth wall, under a
// pressure q on its top. Its stress is uniform, which the elements hold exactly. It fails at
// q = 2 c tan(45 deg + phi / 2), so that the only errors are the width of the bracket and what counts as equilibrium,
// 1e-5 of the loads; 1e-4 of the factor is allowed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/read_file.h"
#include "base/temporary_folder.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"
#include "solvers/quasi_static/bracket.h"

namespace talus {
namespace {

using Overrides = std::vector<std::string>;

constexpr double q = 10e3, E = 10e6, nu = 0.3;
const std::string block = R"(
[mesh]
section = "box.csv"
size = 0.25
[body.soil]
region = "soil"
density = 2000
law = "mohr_coulomb"
young_modulus = 10e6
poisson_ratio = 0.3
cohesion = 14e3
friction_angle = 0
[boundary.base]
kind = "roller"
[boundary.left]
kind = "roller"
[boundary.surface]
kind = "traction"
pressure = 10e3
[[stage]]
name = "load"
kind = "quasi_static"
duration = 1
)";

FactorOfSafety factor_of(const Overrides &overrides, const std::string &further_stages = "") {
  Scene scene = parse_scene(block + further_stages, std::string(TALUS_MESHES) + "/scene.toml", overrides);
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false;
  return make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety();
}

/// Pressure that the block bears with c and tan(phi) divided by F; with `davis` both times cos(phi_F) besides, the
/// strength of Davis (1968) for psi = 0.
double limit_of(double c, double phi, double F, bool davis) {
  const double reduced = std::atan(std::tan(phi) / F), share = davis ? std::cos(reduced) : 1,
               angle = std::atan(share * std::tan(reduced));
  return 2 * c / F * share * std::tan(M_PI / 4 + angle / 2);
}

/// The factor at which the block bears q, by bisection.
double exact_factor(double c, double phi, bool davis) {
  double low = 0.01, high = 100;
  for (int k = 0; k < 100; ++k) {
    const double middle = std::sqrt(low * high);
    (limit_of(c, phi, middle, davis) > q ? low : high) = middle;
  }
  return low;
}

void expect_holds(const FactorBracket &b, double exact) {
  constexpr double tolerance = 1e-4;
  EXPECT_TRUE(b.decided);
  EXPECT_LE(b.upper - b.lower, 1.0001 * bracket_width * b.upper);
  EXPECT_LE(b.lower, exact * (1 + tolerance));
  EXPECT_GE(b.upper, exact * (1 - tolerance));
}

TEST(Block, has_its_exact_factor_with_and_without_dilation) {
  for (const double c : {3e3, 14e3})
    for (const double phi : {0., 30.}) {
      const Overrides soil{"body.soil.cohesion=" + std::to_string(c),
                           "body.soil.friction_angle=" + std::to_string(phi)};
      Overrides dilating = soil;
      dilating.push_back("body.soil.dilation_angle=" + std::to_string(phi));
      const FactorOfSafety none = factor_of(soil), full = factor_of(dilating);
      EXPECT_EQ(none.flow, phi > 0 ? TrialFlow::own : TrialFlow::associated);
      EXPECT_EQ(full.flow, TrialFlow::associated);
      const double angle = phi * degree.si;
      for (const FactorOfSafety &factor : {none, full})
        for (const auto &[flow, bracket] : factor.by_flow)
          expect_holds(bracket, exact_factor(c, angle, flow == TrialFlow::davis));
    }
}

/// What each trial found: out of balance by at most 1e-5 of the loads in equilibrium; else a displacement of at least
/// ten times that of elastic soil, q / E' over a height of 1 m, and a prop that carries what the soil does not,
/// 1 - F_exact / F of the load, to the 5 % of the force of the prop that may be out of balance.
TEST(Block, leans_on_the_prop_with_what_it_cannot_carry) {
  const double exact = 2 * 14e3 / q, elastic = q * (1 - nu * nu) / E;
  const FactorOfSafety factor = factor_of({});
  for (const StrengthTrial &t : factor.trials) {
    ASSERT_NE(t.outcome, TrialOutcome::undecided);
    if (t.outcome == TrialOutcome::equilibrium) {
      EXPECT_LE(t.residual, 1e-5);
      EXPECT_LT(t.displacement, 2 * elastic);
      continue;
    }
    const double surplus = 1 - exact / t.factor;
    EXPECT_GT(t.displacement, 10 * elastic) << t.factor;
    EXPECT_NEAR(t.surplus, surplus, 0.05 * surplus + 1e-4) << t.factor;
  }
}

/// A mechanism that is few cells high has too large a factor, which the run says.
TEST(Block, is_doubted_where_it_is_few_cells_high) {
  const auto doubted = [](const std::string &size) {
    Scene scene = parse_scene(block, std::string(TALUS_MESHES) + "/scene.toml",
                              {"gravity=10", "boundary.surface.pressure=0", "boundary.base.kind=fixed",
                               "body.soil.cohesion=8e3", "mesh.size=" + size});
    scene.add_factor_stage();
    RunOptions options;
    options.pictures = options.screen = false;
    const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
    (void)simulation->factor_of_safety();
    return std::ranges::any_of(simulation->events(), [](const Event &event) {
      return event.text.find("is some per cent too large. Take smaller cells there") != std::string::npos;
    });
  };
  EXPECT_TRUE(doubted("0.25"));
  EXPECT_FALSE(doubted("0.08"));
}

/// The weight of ground at rest that is elastic makes it yield where nu is small, but not where its stress begins with
/// that of k0.
TEST(Block, is_said_to_yield_under_its_weight_where_nu_gives_its_lateral_stress) {
  for (const std::string begins : {"kept", "k0"}) {
    Scene scene =
        parse_scene(block + "[[stage]]\nname = \"more\"\nkind = \"quasi_static\"\nduration = 1\n",
                    std::string(TALUS_MESHES) + "/scene.toml",
                    {"gravity=10", "boundary.surface.pressure=0", "boundary.base.kind=fixed", "body.soil.cohesion=8e3",
                     "body.soil.friction_angle=20", "body.soil.dilation_angle=20", "stage.0.initial_stress=" + begins});
    scene.add_factor_stage();
    RunOptions options;
    options.pictures = options.screen = options.checkpoints = false;
    TemporaryFolder folder;
    ASSERT_TRUE(folder.make());
    options.directory = folder.path() + "/run";
    (void)make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety();
    const std::string log = read_file(options.directory + "/run.log");
    EXPECT_EQ(log.find("yields under its own weight even where it is level") != std::string::npos, begins == "kept")
        << log;
  }
}

/// A factor is always one of elements of second order, also where a host program asks for it; what has been solved by
/// others cannot be gone on from.
TEST(Block, has_a_factor_of_second_order_elements_whatever_the_scene_sets) {
  const Overrides cut{"gravity=10", "boundary.surface.pressure=0", "boundary.base.kind=fixed",
                      "body.soil.cohesion=8e3"};
  const FactorOfSafety second = factor_of(cut);
  for (const char *elements : {"patches", "linear"}) {
    Overrides words = cut;
    words.push_back(std::string("quasi_static.elements=") + elements);
    EXPECT_EQ(factor_of(words).value(), second.value()) << elements;
  }
}

/// The mechanism stretches all of the block: displacement is in proportion to the distance from its corner, so that
/// less than a tenth of the largest, sqrt(2), moves a quarter of a circle of 0.141 m. Gauss points stand for 0.01 m2.
TEST(Block, moves_as_a_whole) {
  const FactorOfSafety factor = factor_of({});
  EXPECT_NEAR(factor.moving_volume, 1 - M_PI / 4 * 0.02, 0.02);
}

/// A vertical cut of undrained clay slips on a plane at 45 degrees through its foot, within a cell of 0.25 m. No
/// mechanism is said to lack more resistance than it does: 1 - F_exact / F of the load at most.
TEST(Block, cut_slips_through_its_foot) {
  const FactorOfSafety cut =
      factor_of({"gravity=10", "boundary.surface.pressure=0", "boundary.base.kind=fixed", "body.soil.cohesion=8e3"});
  EXPECT_TRUE(cut.decided);
  for (const StrengthTrial &t : cut.trials) {
    if (t.outcome == TrialOutcome::equilibrium) continue;
    EXPECT_LE(t.surplus, 1.05 * (1 - cut.lower / t.factor)) << t.factor;
  }
  // 3.776 c / (rho g h) = 1.51 (Pastor et al. 2000); three to four cells over the height are stiffer by 9 to 13 %, on
  // 20 meshes of two versions of Gmsh with cells of 0.21 to 0.3 m
  EXPECT_NEAR(cut.value(), 1.11 * 3.776 * 8e3 / 20e3, 0.04 * 1.51);
  ASSERT_GE(cut.slip_surface.size(), 4u);
  for (const auto &[x, y] : cut.slip_surface) EXPECT_NEAR(x + y, 1, 0.25);
  EXPECT_GT(cut.moving_volume, 0.5) << "the wedge";
  EXPECT_LT(cut.moving_volume, 0.5 + 0.25 * std::sqrt(2.)) << "and a cell on its slip plane";
}

/// A slice of tetrahedra between smooth ends has the factor of plane strain, within 3 %: its triangles are those of the
/// section, its tetrahedra a little stiffer. Rough ends hold it.
TEST(Block, slice_in_three_dimensions_has_the_factor_of_plane_strain) {
  const Overrides cut{"gravity=10",
                      "boundary.surface.pressure=0",
                      "boundary.base.kind=fixed",
                      "body.soil.cohesion=5e3",
                      "body.soil.friction_angle=20",
                      "body.soil.dilation_angle=20"};
  const auto slice = [&](const std::string &ends) {
    Overrides words = cut;
    words.insert(words.end(), {"dimension=3", "mesh.thickness=0.25", "mesh.layers=1",
                               "boundary.ends.group=[\"front\",\"back\"]", "boundary.ends.kind=" + ends});
    return factor_of(words);
  };
  const FactorOfSafety plane = factor_of(cut), smooth = slice("roller");
  EXPECT_TRUE(smooth.decided);
  EXPECT_NEAR(smooth.value() / plane.value(), 1, 0.03);
  EXPECT_NEAR(smooth.moving_volume / (0.25 * plane.moving_volume), 1, 0.1);
  EXPECT_GT(slice("fixed").lower, 1.5 * plane.upper);
}

/// Clay that leans on a soft elastic wall moves by far more than elastic clay and yet stands at any strength: large
/// displacement is no mechanism.
TEST(Block, stands_at_any_strength_before_an_elastic_wall) {
  try {
    factor_of({"mesh.section=" + std::string(TALUS_WALL), "gravity=10", "boundary.surface.pressure=0",
               "body.soil.cohesion=8e3", "body.wall.region=wall", "body.wall.density=1", "body.wall.law=linear_elastic",
               "body.wall.young_modulus=2e4", "body.wall.poisson_ratio=0", "boundary.right.kind=roller"});
    ADD_FAILURE() << "a mechanism";
  } catch (const RunError &error) {
    EXPECT_NE(std::string(error.what()).find("still has an equilibrium: there is nothing to fail"), std::string::npos)
        << error.what();
  }
}

/// Clay that has yielded against a wall, by several per cent in most places, keeps little of its peak strength, twice
/// the residual one, when the wall and most of the pressure are taken away. Trials take nothing from it. Newton's
/// iterations need steps of about one per cent of that second stage: it is not lost.
TEST(Block, has_the_strength_that_the_stages_left) {
  const Overrides words{"mesh.section=" + std::string(TALUS_WALL),
                        "boundary.surface.pressure=[[0, 0], [1, 1e5], [2, 1e4]]",
                        "body.soil.residual_cohesion=7e3",
                        "body.soil.shape_factor=30",
                        "body.wall.region=wall",
                        "body.wall.density=1",
                        "body.wall.law=linear_elastic",
                        "body.wall.young_modulus=1e6",
                        "body.wall.poisson_ratio=0",
                        "boundary.right.kind=roller"};
  const std::string without_wall =
      "[[stage]]\nkind = \"quasi_static\"\nduration = 1\nremove = \"wall\"\nsoftening = false\n";
  const FactorOfSafety left = factor_of(words, without_wall);
  EXPECT_GT(left.lower, 1.4);
  EXPECT_LT(left.upper, 1.7) << "of 2.8 at its peak";
  EXPECT_TRUE(left.lost_stages.empty()) << left.lost_stages[0];
}

/// A stage whose soil softens and that is lost leaves a strength that depends on the steps, also where nothing has
/// softened yet: one step for all of the load, which is too large for the soil, leaves the peak strength at 0 % of it.
TEST(Block, has_no_factor_where_soil_that_softens_loses_its_equilibrium) {
  const Overrides words{"boundary.surface.pressure=[[0, 0], [1, 30e3]]", "body.soil.residual_cohesion=7e3",
                        "body.soil.shape_factor=30", "stage.load.load_steps=1", "quasi_static.smallest_step=1"};
  try {
    factor_of(words);
    ADD_FAILURE() << "a factor";
  } catch (const RunError &error) {
    for (const char *part : {"no equilibrium beyond 0 %", "and this on the steps", "softening = false"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
  Overrides fresh = words;
  fresh.push_back("stage.load.softening=false");
  const FactorOfSafety peak = factor_of(fresh);
  EXPECT_EQ(peak.lost_stages.size(), 1);
  expect_holds(peak, 28. / 30);
}

/// A run whose stages end without a step is not run again by the question for its factor, whose folder is in use.
TEST(Block, is_asked_for_its_factor_after_a_run_without_steps) {
  TemporaryFolder folder;
  ASSERT_TRUE(folder.make());
  Scene scene = parse_scene(block, std::string(TALUS_MESHES) + "/scene.toml",
                            {"boundary.surface.pressure=30e3", "stage.load.load_steps=1",
                             "quasi_static.smallest_step=1", "stage.load.softening=false"});
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = options.checkpoints = false, options.directory = folder.path() + "/run";
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  expect_holds(simulation->factor_of_safety(), 28. / 30);
}

/// Where the strength is too small for the loads a trial says so after the second step that failed, and the smallest
/// steps are not tried: the stage ends far above them. The factor is that of the block.
TEST(Block, fails_before_small_steps_are_tried) {
  TemporaryFolder folder;
  ASSERT_TRUE(folder.make());
  Scene scene = parse_scene(block, std::string(TALUS_MESHES) + "/scene.toml", {"boundary.surface.pressure=30e3"});
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = options.checkpoints = false, options.directory = folder.path() + "/run";
  const FactorOfSafety factor = make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety();
  EXPECT_EQ(factor.lost_stages.size(), 1);
  expect_holds(factor, 28. / 30);
  const std::string log = read_file(options.directory + "/run.log");
  EXPECT_NE(log.find("a mechanism of failure was found under all of its loads, even with psi = phi"), std::string::npos)
      << log;
  const std::string warning = "stage load found no equilibrium, so the search";
  EXPECT_EQ(log.find(warning), log.rfind(warning)) << "said once";
}

/// Outside of the polygon soil keeps its strength: where nothing else is divided than soil that cannot fail alone,
/// nothing fails. A band on a line that covers everything changes nothing.
TEST(Block, keeps_its_strength_outside_of_the_search) {
  try {
    factor_of({"factor_of_safety.within=[[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]]"});
    ADD_FAILURE() << "a mechanism";
  } catch (const RunError &error) {
    EXPECT_NE(std::string(error.what()).find("inside factor_of_safety.within and along still has an equilibrium"),
              std::string::npos)
        << error.what();
  }
  EXPECT_THROW(factor_of({"factor_of_safety.within=[[4, 4], [5, 4], [5, 5]]"}), std::invalid_argument);
  expect_holds(factor_of({"factor_of_safety.along=[[0, 0.5], [1, 0.5]]", "factor_of_safety.width=1.1"}), 2.8);
}

/// Undecided trials leave a bracket: a narrow one says what the factor is, one from 0.2 to 1 that the search has
/// failed.
TEST(FactorBracket, is_no_answer_where_it_is_wide) {
  EXPECT_FALSE((FactorBracket{.lower = 0.983, .upper = 0.99, .decided = false}.failed()));
  EXPECT_TRUE((FactorBracket{.lower = 0.209, .upper = 1.003, .decided = false}.failed()));
  EXPECT_FALSE((FactorBracket{.lower = 0.209, .upper = 1.003, .decided = true}.failed()));
}

/// A linear solver that gives up, here for want of iterations, leaves trials to damped motion, which needs none.
struct FewIterations {
  explicit FewIterations(int most) { PetscOptionsSetValue(nullptr, "-talus_ksp_max_it", std::to_string(most).c_str()); }
  ~FewIterations() { PetscOptionsClearValue(nullptr, "-talus_ksp_max_it"); }
};

TEST(Block, has_the_same_factor_by_damped_motion) {
  const double exact = exact_factor(14e3, 0, false);
  const FewIterations none(1);
  const FactorOfSafety factor = factor_of({"quasi_static.linear_solver=iterative"});
  EXPECT_TRUE(std::ranges::any_of(factor.trials, [](const StrengthTrial &t) { return t.steps > 0; }));
  expect_holds(factor, exact);
}

}  // namespace
}  // namespace talus
