// Claims of docs/theory/finite_elements.md section 5: what a factor of safety does not depend on, that it is bracketed
// by an equilibrium and a mechanism, and that neither a slope that does not stand nor a stage without equilibrium ends
// the search. A bracket is 0.5 % wide, so two that hold the same factor have middles within 0.5 %.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"
#include "solvers/quasi_static/bracket.h"
#include "solvers/quasi_static/trial_strength.h"
#include "tests/unit/output/fixtures.h"

namespace talus {
namespace {

using Overrides = std::vector<std::string>;
constexpr double same = 0.005;

FactorOfSafety search(const std::string &file, const Overrides &overrides) {
  Scene scene = read_scene(file[0] == '/' ? file : std::string(TALUS_SLOPES) + "/" + file, overrides);
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false;
  return make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety();
}

/// Claims about the same scene share its factor.
const FactorOfSafety &factor_of(const std::string &file, const Overrides &overrides = {}) {
  static std::map<std::pair<std::string, Overrides>, FactorOfSafety> known;
  const std::pair scene{file, overrides};
  if (!known.contains(scene)) known[scene] = search(file, overrides);
  return known.at(scene);
}

Overrides operator+(Overrides a, const Overrides &b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const Overrides coarse{"mesh.size=2.5"};

/// Every bracket has an equilibrium at its lower end and a mechanism at its upper end among the trials.
void expect_bracketed(const FactorOfSafety &factor) {
  EXPECT_TRUE(factor.decided);
  EXPECT_LE(factor.upper / factor.lower, 1 + 1.01 * bracket_width / (1 - bracket_width));
  const auto has = [&](double at, TrialOutcome outcome) {
    return std::any_of(factor.trials.begin(), factor.trials.end(),
                       [&](const StrengthTrial &t) { return t.factor == at && t.outcome == outcome; });
  };
  EXPECT_TRUE(has(factor.lower, TrialOutcome::equilibrium));
  EXPECT_TRUE(has(factor.upper, TrialOutcome::mechanism));
}

/// The limit load of soil with associated flow depends neither on elasticity nor on initial stress, and so do the
/// bounds of soil with psi < phi; its own factor lies between them and scatters. The values of nu are on both sides of
/// that at which level ground yields: sin(phi) = 1 - 2 nu at nu = 0.33.
TEST(FactorOfSafety, depends_neither_on_elasticity_nor_on_initial_stress) {
  for (const char *psi : {"body.soil.dilation_angle=0", "body.soil.dilation_angle=20"}) {
    const FactorOfSafety first = factor_of("scene.toml", coarse + Overrides{psi});
    expect_bracketed(first);
    const bool own = psi == std::string("body.soil.dilation_angle=0");
    EXPECT_EQ(first.flow, own ? TrialFlow::own : TrialFlow::associated);
    for (const Overrides &change : {Overrides{"body.soil.poisson_ratio=0.45"},
                                    {"body.soil.poisson_ratio=0.1"},
                                    {"body.soil.young_modulus=1e6"},
                                    {"stage.0.initial_stress=k0"}}) {
      const FactorOfSafety other = factor_of("scene.toml", coarse + Overrides{psi} + change);
      for (const auto &[flow, bracket] : first.by_flow)
        EXPECT_NEAR(other.by_flow.at(flow).value() / bracket.value(), 1, flow == TrialFlow::own ? 3 * same : same)
            << psi << " " << name_of(flow) << " " << change[0];
      if (!own) continue;
      EXPECT_GE(other.upper, other.by_flow.at(TrialFlow::davis).lower);
      EXPECT_LE(other.lower, other.by_flow.at(TrialFlow::associated).upper);
    }
  }
}

/// In the corners of a slope the stress of its Gauss points, drawn out linearly, may leave the yield surface.
TEST(FactorOfSafety, leaves_named_points_with_a_stress_that_the_soil_bears) {
  Scene scene =
      read_scene(std::string(TALUS_SLOPES) + "/scene.toml",
                 coarse + Overrides{"output.point={toe={position=[48.768, 0]}, crest={position=[18.288, 15.24]}, "
                                    "face={position=[33.528, 7.62]}, corner={position=[0, 0]}}"});
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->factor_of_safety();
  for (const char *point : {"toe", "crest", "face", "corner"})
    for (const double phi : simulation->history().column(std::string(point) + "_mobilised_friction_deg"))
      EXPECT_LT(phi, 20 * (1 + 1e-6)) << point;
  std::vector<double> dissipated = simulation->history().column("dissipated_J");
  EXPECT_TRUE(std::isnan(dissipated.back())) << "the size of a mechanism is free, and has no balance";
  dissipated.pop_back();
  for (const double of_path : dissipated) EXPECT_TRUE(std::isfinite(of_path));
}

/// Clay in a deep foundation slips as deep as the mesh lets it, which is said; a slope whose toe is on the bottom of
/// the mesh stands on firm ground. The line through the shear band has no spikes: a point is nearer to the chord of its
/// neighbours than half a cell.
TEST(FactorOfSafety, says_where_the_mechanism_ends_with_the_mesh_and_traces_it_smoothly) {
  const auto told = [](const Overrides &overrides) {
    RunOptions options;
    options.pictures = options.screen = false;
    Scene scene = read_scene(std::string(TALUS_SLOPES) + "/scene.toml", overrides);
    scene.add_factor_stage();
    const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
    const auto line = simulation->factor_of_safety().slip_surface;
    EXPECT_GE(line.size(), 8u);
    for (size_t k = 1; k + 1 < line.size(); ++k) {
      const double dx = line[k + 1][0] - line[k - 1][0], dy = line[k + 1][1] - line[k - 1][1];
      const double off = (line[k][0] - line[k - 1][0]) * dy - (line[k][1] - line[k - 1][1]) * dx;
      EXPECT_LT(std::abs(off) / std::hypot(dx, dy), 1) << line[k][0] << ", " << line[k][1];
    }
    return std::ranges::any_of(simulation->events(), [](const Event &event) {
      return event.text.find("the mechanism reaches the fixed bottom of the mesh at y = -7.62 m") != std::string::npos;
    });
  };
  EXPECT_TRUE(told(
      {"mesh.size=2", "mesh.section=griffiths_lane_2.csv", "body.soil.friction_angle=0", "body.soil.cohesion=50e3"}));
  EXPECT_FALSE(told({"mesh.size=3"}));
}

/// Soil with half of the strength has half of the factor, though it does not stand; with twice of it, twice the factor.
TEST(FactorOfSafety, is_proportional_to_strength) {
  const Overrides flow{"body.soil.dilation_angle=20"};
  const double whole = factor_of("scene.toml", coarse + flow).value();
  for (const double share : {0.5, 2.}) {
    const double phi = std::atan(share * std::tan(20 * degree.si)) / degree.si;
    const FactorOfSafety part =
        factor_of("scene.toml", coarse + Overrides{"body.soil.cohesion=" + std::to_string(share * 14962.6),
                                                   "body.soil.friction_angle=" + std::to_string(phi),
                                                   "body.soil.dilation_angle=" + std::to_string(phi)});
    expect_bracketed(part);
    EXPECT_NEAR(part.value() / whole, share, same * share) << share;
    EXPECT_EQ(part.lost_stages.empty(), share > 1);  // half of the strength does not carry the weight of the slope
  }
}

/// The lower estimate of soil with psi < phi is the factor of associated soil with the strength of Davis (1968), the
/// upper bound that with psi = phi. Griffiths & Lane (1999) found 1.40 with psi = 0, in steps of 0.05.
TEST(FactorOfSafety, with_less_dilation_lies_between_its_bounds) {
  const FactorOfSafety none = factor_of("scene.toml", coarse + Overrides{"body.soil.dilation_angle=0"}),
                       full = factor_of("scene.toml", coarse + Overrides{"body.soil.dilation_angle=20"});
  const FactorBracket davis = none.by_flow.at(TrialFlow::davis);
  EXPECT_NEAR(none.by_flow.at(TrialFlow::associated).value() / full.value(), 1, same);
  EXPECT_GT(none.lower, davis.upper);
  EXPECT_LT(none.upper, full.lower);
  EXPECT_NEAR(none.value() / 1.40, 1, 0.025);
  // strength of soil with psi = phi that has the factor 1 by itself if it is that of the failed slope
  const double F = davis.value(), reduced = std::atan(std::tan(20 * degree.si) / F), share = std::cos(reduced);
  const double phi = std::atan(share * std::tan(reduced)) / degree.si;
  const FactorOfSafety one =
      factor_of("scene.toml", coarse + Overrides{"body.soil.cohesion=" + std::to_string(14962.6 / F * share),
                                                 "body.soil.friction_angle=" + std::to_string(phi),
                                                 "body.soil.dilation_angle=" + std::to_string(phi)});
  EXPECT_NEAR(one.value(), 1, same);
}

/// A thin weak seam, and sand without cohesion, both with psi = 0: Newton's iterations stall in the gravity stage of
/// the sand. Limit equilibrium with the same strength (docs/gallery/slope_stability/limit_equilibrium.py) gives 1.289
/// and 1.247; coarse elements are stiffer by up to 6 %.
TEST(FactorOfSafety, of_weak_seam_and_sand_without_dilation_is_found) {
  const auto expect_between = [](const FactorOfSafety &f, double davis) {
    const FactorBracket &low = f.by_flow.at(TrialFlow::davis), &high = f.by_flow.at(TrialFlow::associated);
    EXPECT_NEAR(low.value() / davis, 1.02, 0.04);
    EXPECT_GE(f.upper, low.lower);
    EXPECT_LE(f.lower, high.upper);
  };
  const FactorOfSafety seam = factor_of("weak_seam.toml", {"mesh.size=2.5"});
  expect_between(seam, 1.289);
  expect_between(factor_of("layered.toml", {"mesh.size=2.5"}), 1.247);
  ASSERT_FALSE(seam.slip_surface.empty());
  double lowest = 1e300;
  for (const auto &[x, y] : seam.slip_surface) lowest = std::min(lowest, y);
  EXPECT_GT(lowest, -1.4) << "it does not cut the rock";
  EXPECT_LT(lowest, -1) << "it follows the seam";
}

/// Factor of a circle in clay (phi = 0) of the strength c0 + g (depth below the crest), in the slope of
/// griffiths_lane_2.csv: moments of strength and weight about its centre (Gibson & Morgenstern 1962, Geotechnique 12).
double factor_of_circle(double x, double y, double radius, double c0, double g) {
  constexpr double weight = 2001.6 * 9.81, top = 15.24, crest = 18.288, toe = 48.768, base = -7.62;
  constexpr int columns = 1000;
  const double left = std::max(0., x - radius), width = (std::min(79.248, x + radius) - left) / columns;
  double resisting = 0, driving = 0;
  for (int k = 0; k < columns; ++k) {
    const double at = left + (k + 0.5) * width, height = std::sqrt(radius * radius - (at - x) * (at - x));
    const double bottom = y - height, ground = top * std::clamp((toe - at) / (toe - crest), 0., 1.);
    if (bottom > ground) continue;
    if (bottom < base) return 1e9;
    resisting += (c0 + g * (top - bottom)) * width * radius / height * radius;
    driving += weight * (ground - bottom) * (x - at) * width;
  }
  return driving > 0 ? resisting / driving : 1e9;
}

/// A slope in clay whose strength grows with depth: its factor is that of the worst circle, which is an upper bound.
/// Elements of 2 m are stiffer than the soil by 1 to 2 %, as with uniform strength.
TEST(FactorOfSafety, of_clay_whose_strength_grows_with_depth_is_that_of_the_worst_circle) {
  for (const auto &[c0, g] : {std::pair{10e3, 2e3}, {0., 3e3}}) {
    double least = 1e9;
    for (double x = 24; x < 50; x += 2)
      for (double y = 20; y < 50; y += 2)
        for (double radius = 10; radius < 58; radius += 0.5)
          least = std::min(least, factor_of_circle(x, y, radius, c0, g));
    const FactorOfSafety found = factor_of(
        "scene.toml", {"mesh.section=griffiths_lane_2.csv", "mesh.size=2", "body.soil.friction_angle=0",
                       "body.soil.cohesion=" + std::to_string(c0) + " + " + std::to_string(g) + " * (15.24 - y)"});
    expect_bracketed(found);
    EXPECT_NEAR(found.value() / least, 1.01, 0.02) << c0;
  }
}

/// A vertical cut in clay whose strength is g times the depth: F = 2 g / gamma, exactly. The stress sigma_v = gamma z,
/// sigma_h = 0 yields at F everywhere, and so does a plane at 45 degrees through any point of the face.
TEST(FactorOfSafety, of_a_vertical_cut_whose_strength_is_proportional_to_depth_is_exact) {
  const FactorOfSafety found = factor_of("../../../tests/verification/fem_vertical_cut/scene.toml",
                                         {"mesh.size=0.25", "mesh.refine=[]", "body.soil.cohesion=10e3 * (1 - y)"});
  expect_bracketed(found);
  EXPECT_NEAR(found.value(), 1, 0.01);
}

/// c and tan(phi) are divided, psi is at most the reduced phi; by Davis both are multiplied by his share, and flow is
/// associated.
TEST(FactorOfSafety, divides_the_strength_of_a_point) {
  constexpr double c = 20e3, phi = 35 * degree.si, factor = 1.7;
  const double reduced = std::atan(std::tan(phi) / factor);
  for (const double psi : {0., 10 * degree.si, reduced, phi})
    for (const TrialFlow by : {TrialFlow::own, TrialFlow::davis, TrialFlow::associated}) {
      const FrictionalPoint found = strength_of_trial({c, phi, psi}, factor, by);
      const double flow = std::min(psi, reduced),
                   davis = std::cos(flow) * std::cos(reduced) / (1 - std::sin(flow) * std::sin(reduced)),
                   share = by == TrialFlow::davis ? davis : 1;
      EXPECT_NEAR(found.c, share * c / factor, 1e-9);
      EXPECT_NEAR(std::tan(found.phi), share * std::tan(phi) / factor, 1e-14);
      EXPECT_EQ(found.psi, by == TrialFlow::own ? flow : found.phi);
    }
}

const Overrides dry_wedge{"body.seam.water_table=[[0, -10]]", "boundary.crack.pressure=0"};

/// A block of rock on a thin weak seam before a tension crack, dry and with water: the planar wedge of Hoek & Bray
/// (1981), F = [c A + (W cos b - U - V sin b) tan phi] / (W sin b + V cos b). The slip surface is the middle of the
/// seam; the row of elements in which it shears makes F 1 % too small or large.
TEST(FactorOfSafety, of_a_wedge_before_a_tension_crack_is_that_of_hoek_and_bray) {
  const double b = 30 * degree.si, c = 20e3, phi = 30 * degree.si, area = 10 / std::cos(b), bottom = 0.1 + 5.7735;
  const double weight = 25e3 * 42.5325;  // of the rock and of half of the seam
  for (const double level : {0., 7.5, 9.}) {
    const double deep = std::max(0., level - bottom), v = 10e3 * deep * deep / 2, u = 10e3 * deep * area / 2;
    const double normal = weight * std::cos(b) - u - v * std::sin(b), shear = weight * std::sin(b) + v * std::cos(b);
    const double exact = (c * area + normal * std::tan(phi)) / shear;
    Overrides water{"body.seam.water_table=[[0, 0.1], [10, " + std::to_string(level) + "]]",
                    "boundary.crack.pressure=1e4 * max(0, " + std::to_string(level) + " - y)"};
    if (level == 0) water = dry_wedge;
    EXPECT_NEAR(factor_of("../../guide/wedge.toml", water).value() / exact, 1, 0.015) << level;
  }
}

/// A vertical cut in clay with phi = 0 fails at gamma H / c = 3.776; without tensile strength at 2 (Drucker & Prager
/// 1952: sigma_v = gamma z and sigma_h = 0 are admissible up to there). The slab that breaks off is as thin as the
/// cells allow, so F is too large by about the width of a cell over twice the height; so it is with tensile strength in
/// cells so large.
TEST(FactorOfSafety, of_a_cut_without_tensile_strength_is_half) {
  const Overrides cut{"mesh.size=0.25", "mesh.refine=[]", "body.soil.cohesion=10e3"};
  const std::string file = "../../../tests/verification/fem_vertical_cut/scene.toml";
  const double whole = factor_of(file, cut).value(),
               open = factor_of(file, cut + Overrides{"body.soil.tension_cutoff=0"}).value();
  EXPECT_GT(whole, 3.776 / 2);
  EXPECT_LT(whole, 3.776 / 2 * (1 + 0.25 / 2));
  EXPECT_GT(open, 0.997);
  EXPECT_LT(open, 1 + 0.25 / 2);
}

/// The rock of the wedge as soil of its own strength, of which no factor is taken: what fails is the seam, as beside
/// elastic rock. A scene in which nothing is left to divide is refused.
TEST(FactorOfSafety, leaves_soil_that_keeps_its_strength) {
  const Overrides seam_kept{"body.seam.reduce_strength=false"};
  const Overrides rock{"body.rock.law=mohr_coulomb",      "body.rock.cohesion=60e3",
                       "body.rock.friction_angle=40",     "body.rock.dilation_angle=40",
                       "body.rock.reduce_strength=false", "boundary.crack.pressure=0",
                       "body.seam.water_table=[[0, -10]]"};
  const double dry = factor_of("../../guide/wedge.toml", dry_wedge).value();
  EXPECT_NEAR(factor_of("../../guide/wedge.toml", rock).value() / dry, 1, 0.01);
  // rock so weak that it fails before the seam if its strength is divided too: 1.10 against 1.28
  const Overrides weak{"body.rock.cohesion=20e3", "body.rock.friction_angle=30", "body.rock.dilation_angle=30"};
  EXPECT_GT(
      factor_of("../../guide/wedge.toml", rock + weak).value(),
      1.1 * factor_of("../../guide/wedge.toml", rock + weak + Overrides{"body.rock.reduce_strength=true"}).value());
  EXPECT_THROW(factor_of("../../guide/wedge.toml", seam_kept), std::invalid_argument);
}

/// Soil that would soften keeps its peak strength in trials if it has not sheared.
TEST(FactorOfSafety, trials_take_no_strength_from_soil_that_softens) {
  const Overrides held{"stage.0.softening=false", "body.soil.dilation_angle=20"};
  const double hard = factor_of("scene.toml", coarse + held).value();
  const double soft =
      factor_of("scene.toml", coarse + held +
                                  Overrides{"body.soil.residual_cohesion=1e3", "body.soil.residual_friction_angle=10",
                                            "body.soil.residual_dilation_angle=10", "body.soil.shape_factor=50"})
          .value();
  EXPECT_NEAR(soft / hard, 1, same);
}

const Overrides one_mechanism{"factor_of_safety.mechanisms=1"};

/// Both flanks of an embankment come out in one run, with the factors that each has by itself. Between them the search
/// meets shoulders of the first slide, which are not sold as others. A polygon around the other flank gives its factor.
TEST(FactorOfSafety, names_the_mechanisms_of_both_flanks) {
  const auto alone = [](const char *section) {
    return factor_of("embankment.toml",
                     one_mechanism + Overrides{"mesh.section=" + std::string(TALUS_HALVES) + section});
  };
  const FactorOfSafety steep = alone("/embankment_left.csv"), gentle = alone("/embankment_right.csv"),
                       two = factor_of("embankment.toml");
  EXPECT_NEAR(two.value() / steep.value(), 1, same);
  ASSERT_EQ(two.further.size(), 1u);
  EXPECT_NEAR(two.further[0].value() / gentle.value(), 1, same);
  EXPECT_LT(two.high[0], 25) << "the slide of the steep flank ends on the crest";
  EXPECT_GT(two.further[0].low[0], 25) << "so does that of the gentle one";
  EXPECT_EQ(two.further[0].of_critical, 0);
  EXPECT_NEAR(two.further[0].moving_volume / gentle.moving_volume, 1, 0.2);
  ASSERT_GE(two.further[0].slip_surface.size(), 5u);

  const FactorOfSafety inside = factor_of(
      "embankment.toml", one_mechanism + Overrides{"factor_of_safety.within=[[25, 0], [56, 0], [56, 9], [25, 9]]"});
  EXPECT_NEAR(inside.value() / gentle.value(), 1, same);
  EXPECT_GT(inside.low[0], 25);
}

/// A slope of two benches slips at each bench by itself, or as a whole. The local mechanisms have the factors of slopes
/// of one bench alone, to a bracket and the 1 % by which their other triangles change it, on ten meshes with cells
/// of 1.4 to 1.6 m. The last mechanism moves the soil of both.
TEST(FactorOfSafety, names_local_and_global_mechanisms_of_benches) {
  const auto of = [](const std::string &section, int mechanisms) {
    return factor_of("embankment.toml", {"mesh.section=" + section, "mesh.size=1.5",
                                         "factor_of_safety.mechanisms=" + std::to_string(mechanisms)});
  };
  const FactorOfSafety lower = of(TALUS_HALVES "/lower_bench.csv", 1), upper = of(TALUS_HALVES "/upper_bench.csv", 1),
                       all = of("benches.csv", 3);
  EXPECT_NEAR(all.value() / lower.value(), 1, 3 * same);
  EXPECT_LT(all.high[0], 32) << "the lower bench slips first";
  ASSERT_EQ(all.further.size(), 2u);
  EXPECT_NEAR(all.further[0].value() / upper.value(), 1, 3 * same);
  EXPECT_GT(all.further[0].low[0], 28);
  EXPECT_GT(all.further[1].lower, all.further[0].upper);
  EXPECT_LT(all.further[1].low[0], 12) << "from the toe of the lower bench";
  EXPECT_GT(all.further[1].high[0], 38) << "to the crest of the upper one";
}

/// Soil that slips along a circle has the factor of this circle by limit equilibrium
/// (docs/gallery/slope_stability/limit_equilibrium.py: Spencer 2.084). A band of two elements, which cannot slip on a
/// line, is stronger, by up to 6 %.
TEST(FactorOfSafety, along_a_circle_is_that_of_limit_equilibrium) {
  const FactorOfSafety circle = factor_of(
      "embankment.toml",
      one_mechanism +
          Overrides{"factor_of_safety.along=[[26, 9], [28, 6.663], [30, 4.93], [32, 3.611], [34, 2.614], [36, 1.885], "
                    "[38, 1.395], [40, 1.124], [42, 1.064], [44, 1.213], [46, 1.575], [48, 2.163], [50, 3]]"});
  expect_bracketed(circle);
  EXPECT_NEAR(circle.value() / 2.084, 1.03, 0.03);
}

/// A line through the strong soil above a weak seam gives more than the seam.
TEST(FactorOfSafety, along_a_line_above_a_weak_seam_is_larger) {
  const Overrides dilating{"mesh.size=2", "body.soil.dilation_angle=30", "body.seam.dilation_angle=12"},
      line{"factor_of_safety.width=2", "factor_of_safety.along=[[10, 10], [16, 2], [30, 1], [35, 0]]"};
  EXPECT_GT(factor_of("weak_seam.toml", dilating + line).lower, 1.2 * factor_of("weak_seam.toml", dilating).upper);
}

/// What the curve of each trial says: what is out of balance, or the force of the prop, vanishes in equilibrium and
/// remains with a mechanism.
TEST(FactorOfSafety, curves_show_equilibrium_and_mechanism) {
  const FactorOfSafety factor = factor_of("scene.toml", coarse);
  for (const StrengthTrial &t : factor.trials) {
    if (t.steps == 0) {
      ASSERT_FALSE(t.curve.empty());
    }
    if (t.outcome == TrialOutcome::equilibrium && t.steps == 0) {
      EXPECT_LT(t.curve.back().second, 1e-5) << t.factor;
    } else if (t.outcome == TrialOutcome::mechanism) {
      ASSERT_GE(t.curve.size(), 2u);
      const auto &[moved, force] = t.curve.back();
      const auto &[moved_before, force_before] = t.curve[t.curve.size() - 2];
      EXPECT_GT(moved, (t.steps > 0 ? 1.2 : 1.5) * moved_before) << t.factor;
      EXPECT_GT(force, 0.1 * force_before) << t.factor;
      EXPECT_GT(t.surplus, 0);
    }
  }
}

/// A slope of 1:2 under an excess pressure of half of its weight (Spencer 1969: 1.04 by slices, psi = phi), in soil
/// with phi = 40 and psi = 0. Gravity is in equilibrium with its strength, which Davis's lower estimate denies. Its
/// factor is proportional to strength, though half of it bears gravity by no flow.
TEST(FactorOfSafety, of_steep_friction_without_dilation_is_that_of_its_own_flow) {
  const std::string file = TALUS_HALVES "/steep_friction.toml";
  const FactorOfSafety whole = factor_of(file);
  EXPECT_GE(whole.lower, 1);
  EXPECT_LE(whole.lower, whole.by_flow.at(TrialFlow::associated).upper);
  EXPECT_LT(whole.by_flow.at(TrialFlow::davis).upper, 0.7);
  const double half_phi = std::atan(std::tan(40 * degree.si) / 2) / degree.si;
  const FactorOfSafety half =
      factor_of(file, {"body.soil.cohesion=5400", "body.soil.friction_angle=" + std::to_string(half_phi)});
  EXPECT_NEAR(half.value() / whole.value(), 0.5, 0.03);
}

/// A signal ends the search, in a stage or in the first trial after the stages. The run goes on from there to the same
/// factor.
TEST(FactorOfSafety, ends_when_interrupted) {
  const SharedFolder folder;
  Scene scene = read_scene(std::string(TALUS_SLOPES) + "/scene.toml", coarse);
  RunOptions options;
  options.pictures = options.screen = false, options.directory = folder / "run";
  make_simulation(PETSC_COMM_WORLD, scene, options)->run();
  scene.add_factor_stage();
  options.resume = true;
  auto resumed = make_simulation(PETSC_COMM_WORLD, scene, options);
  interrupted = 1;
  EXPECT_THROW(search("scene.toml", coarse), RunError);
  EXPECT_THROW(resumed->run(), RunError);
  interrupted = 0;
  int trials = 0;
  for (const Event &event : resumed->events()) trials += event.kind == std::string(event::strength_trial);
  EXPECT_EQ(trials, 0);
  resumed.reset();  // which leaves the folder to the next run
  const auto again = make_simulation(PETSC_COMM_WORLD, scene, options);
  again->run();
  EXPECT_NEAR(again->factor_of_safety().value(), search("scene.toml", coarse).value(), 1e-9);
}

}  // namespace
}  // namespace talus
