// What practice asks of a slope: earthquakes as a share of gravity, weights given as unit weights, strength that
// differs from place to place.
#include "scene/scene.h"
#include "solved.h"

namespace talus {
namespace {

const std::string walls = "gravity = 10\n" + box + R"(
[boundary.base]
kind = "roller"
[boundary.left]
kind = "roller"
)";

/// The supports of 1 m2 of soil carry its inertia, and where water fills the pores that of the water too.
TEST(Practice, supports_carry_the_inertia_of_soil_and_water) {
  const std::string stages =
      "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n"
      "[[stage]]\nkind = \"quasi_static\"\nduration = 1\nseismic_coefficient = [0.2, -0.1]\n"
      "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n";
  for (const bool wet : {false, true}) {
    const std::string soil = wet ? "porosity=0.4" : "density=2000";
    std::vector<std::string> overrides{"body.soil." + soil};
    if (wet)
      overrides = overrides + std::vector<std::string>{"body.soil.grain_density=2650", "phases=drained",
                                                       "water.table=[[0, 1], [1, 1]]"};
    const double density = wet ? 0.6 * 2650 + 400 : 2000, uplift = wet ? 1000 * 10 : 0;
    const Solved solved = solve(walls + stages, overrides);
    const std::vector<double> x = solved.history.column("left_force_x_N"), y = solved.history.column("base_force_y_N"),
                              t = solved.history.column("time_s");
    for (size_t i = 0; i < t.size(); ++i) {
      if (t[i] == 0 || t[i] != std::round(t[i])) continue;  // ends of gravity, of the earthquake, and of rest after it
      const double share = t[i] == 2 ? 1 : 0;
      EXPECT_NEAR(x[i], -0.2 * share * density * 10, 1e-8) << wet << " at t = " << t[i];
      EXPECT_NEAR(y[i], (1 + 0.1 * share) * density * 10 - uplift, 1e-8) << wet << " at t = " << t[i];
    }
  }
}

/// Soil in free flight falls with the sum of gravity and the pseudo-static acceleration.
TEST(Practice, soil_in_flight_feels_the_earthquake) {
  const std::string text = R"(
gravity = 10
[mesh]
section = "flight.csv"
size = 0.25
[body.soil]
region = "block"
unit_weight = "20 kN/m3"
law = "linear_elastic"
young_modulus = "1 MPa"
poisson_ratio = 0.3
[output.point.middle]
position = [0.75, 0.75]
[[stage]]
duration = 0.1
seismic_coefficient = [0.5, 0.4]
[integrator]
step = 1e-3
)";
  const Solved solved = solve(text);
  EXPECT_NEAR(solved.history.column("middle_velocity_m_s").back(), 0.1 * std::hypot(5., 6.), 1e-12);
  EXPECT_NEAR(solved.history.column("mass_kg").back(), 2000 * 0.25, 1e-9);
}

/// history.csv has the motion of the ground beside that of soil in flight, which it moves in the frame of the base: the
/// sum of both is at rest. The ground stays where a stage has left it, and a second one moves it on.
TEST(Practice, history_has_the_motion_of_the_ground) {
  const std::string text = R"(
gravity = 0
[mesh]
section = "flight.csv"
size = 0.25
[body.soil]
region = "block"
density = 2000
law = "linear_elastic"
young_modulus = "1 MPa"
poisson_ratio = 0.3
[output]
history_interval = 0.02
point.middle.position = [0.75, 0.75]
[[earthquake]]
kind = "sine"
amplitude = 4
frequency = 5
duration = 0.2
[[stage]]
duration = 0.2
earthquake = true
[[stage]]
duration = 0.1
reset_displacement = true
[[stage]]
duration = 0.2
earthquake = true
[integrator]
step = 1e-4
)";
  const Solved solved = solve(text);
  const std::vector<double> t = solved.history.column("time_s"), u = solved.history.column("middle_displacement_x_m"),
                            a = solved.history.column("ground_acceleration_x_m_s2"),
                            v = solved.history.column("ground_velocity_x_m_s"),
                            x = solved.history.column("ground_displacement_x_m");
  const double left = 4 * 0.2 / (10 * M_PI);  // a sine over its period: A T / w
  for (size_t k = 0; k < t.size(); ++k) {
    if (t[k] < 0.2 - 1e-9) {
      EXPECT_NEAR(a[k], 4 * std::sin(10 * M_PI * t[k]), 0.02) << "between values of the motion, at " << t[k];
      EXPECT_NEAR(x[k], -u[k], 1e-4 * left) << "at " << t[k];
    } else if (t[k] > 0.2 + 1e-9 && t[k] < 0.3 - 1e-9) {
      EXPECT_EQ(a[k], 0);
      EXPECT_EQ(v[k], 0);
      EXPECT_NEAR(x[k], left, 1e-3 * left);
    }
  }
  EXPECT_NEAR(x.back(), 2 * left, 2e-3 * left);
  EXPECT_EQ(solved.history.column("ground_displacement_y_m").back(), 0);
}

/// Unit weights above and below a water table give the weight of each part; so does a density, the same on both sides.
TEST(Practice, unit_weights_give_the_weight_above_and_below_the_water_table) {
  const std::string stage = "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n";
  const std::vector<std::string> wet{"phases=drained", "water.table=[[0, 0.4], [1, 0.4]]"};
  const auto weight = [&](const std::vector<std::string> &soil) {
    return solve(walls + stage, wet + soil).history.column("base_force_y_N").back();
  };
  const double uplift = 0.4 * 10e3;
  EXPECT_NEAR(weight({"body.soil.unit_weight=19 kN/m3"}), 19e3 - uplift, 1e-8);
  EXPECT_NEAR(weight({"body.soil.density=1900"}), 19e3 - uplift, 1e-8);
  // cells that the table cuts count by their Gauss points: within 2 kN/m3 over half a cell of 0.3 m
  EXPECT_NEAR(weight({"body.soil.unit_weight=18 kN/m3", "body.soil.saturated_unit_weight=20 kN/m3"}),
              18e3 * 0.6 + 20e3 * 0.4 - uplift, 300);
}

/// A pore pressure ratio gives that share of the weight above, here of two layers whose interface is at 0.5 m.
TEST(Practice, pore_pressure_is_a_share_of_the_weight_above) {
  const std::string text = R"(
gravity = 10
phases = "drained"
[mesh]
section = "layers.csv"
size = 0.2
[water]
[body.upper]
region = "upper"
unit_weight = "16 kN/m3"
pore_pressure_ratio = 0.3
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
[body.lower]
region = "lower"
unit_weight = "20 kN/m3"
pore_pressure_ratio = 0.3
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
[boundary.walls]
group = ["base", "left", "right"]
kind = "roller"
[[stage]]
kind = "quasi_static"
duration = 1
initial_stress = "k0"
)";
  const Solved solved = solve(text, {"mesh.section=" + std::string(TALUS_LAYERS)});
  const auto total = [&](size_t q) {
    const double y = solved.value("position", q, 1);
    return 16e3 * std::min(1 - y, 0.5) + 20e3 * std::max(0.5 - y, 0.);
  };
  EXPECT_LT(largest(solved, 1, [&](size_t q, int) { return solved.value("pore_pressure", q) - 0.3 * total(q); }), 1e-6);
  EXPECT_LT(largest(solved, 1, [&](size_t q, int) { return solved.value("stress", q, 1) + 0.7 * total(q); }), 1e-6);
}

/// What fills a crack presses on both of its walls; a wall that is held needs no load.
TEST(Practice, loads_both_walls_of_a_crack) {
  const std::string text = walls +
                           "[boundary.near]\nkind = \"traction\"\npressure = \"1e4 * (1 - y)\"\n"
                           "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n";
  const std::vector<std::string> slot{"mesh.section=" + std::string(TALUS_SLOT), "body.soil.density=2000"};
  try {
    (void)solve(text, slot);
    ADD_FAILURE();
  } catch (const SceneError &error) {
    EXPECT_NE(std::string(error.what()).find("the wall opposite, 0.1 m away, has no load"), std::string::npos)
        << error.what();
  }
  (void)solve(text, slot + std::vector<std::string>{"boundary.far.kind=roller"});
  (void)solve(text, slot + std::vector<std::string>{"boundary.near.group=[\"near\", \"far\"]"});
}

// ---- strength that differs from place to place ----

/// What the cohesion limits [Pa]: sqrt(J2) of Drucker-Prager; else the radius of Mohr's circle in the plane, which is
/// that of the Kirchhoff stress in Hencky's law.
double shear_stress(const Solved &solved, size_t q, const std::string &law) {
  const auto s = [&](int k) { return solved.value("stress", q, k); };
  const double radius = std::hypot((s(0) - s(1)) / 2, s(3));
  if (law == "hencky_mohr_coulomb") return radius * std::exp(solved.value("volume_strain", q));
  if (law == "mohr_coulomb") return radius;
  const double out = s(2) - (s(0) + s(1)) / 2;
  return std::sqrt(radius * radius + out * out / 3);
}

/// A square of clay under shear. In the first step its strain is that of clay that does not yield: where the shear
/// stress passes the cohesion of the place, what is left is the cohesion. Without averaged stress the place is that of
/// the particle; with it a cell has the mean of its particles.
TEST(Practice, particles_yield_at_the_cohesion_of_their_place) {
  const std::string text = box + R"(
density = 2000
velocity = ["40 * y", "0"]
[integrator]
step = 1e-4
[[stage]]
duration = 1e-4
)";
  const auto sheared = [&](const std::string &law, const std::string &cohesion, bool averaged) {
    return solve(text,
                 {"body.soil.law=" + law, "body.soil.friction_angle=0", "body.soil.cohesion=" + cohesion,
                  std::string("transfer.average_stress=") + (averaged ? "true" : "false"), "transfer.relaxation=0"});
  };
  for (const std::string law : {"mohr_coulomb", "drucker_prager", "hencky_mohr_coulomb"})
    for (const bool averaged : {false, true}) {
      const Solved strong = sheared(law, "1e9", averaged), weak = sheared(law, "5e3 + 4e3 * x + 8e3 * y", averaged);
      ASSERT_EQ(strong.points.id, weak.points.id);
      std::map<long long, double> mean;  // of the three particles of a cell
      for (size_t q = 0; q < weak.points.id.size(); ++q) mean[weak.points.id[q] / 3] += weak.value("cohesion", q) / 3;
      const double cone = law == "drucker_prager" ? 2 / std::sqrt(3.) : 1;  // through triaxial compression
      int yielded[2]{};
      const double error = largest(weak, 1, [&](size_t q, int) {
        const double limit = cone * (averaged ? mean[weak.points.id[q] / 3] : weak.value("cohesion", q));
        const double elastic = shear_stress(strong, q, law);
        ++yielded[elastic > limit];
        return shear_stress(weak, q, law) - std::min(elastic, limit);
      });
      EXPECT_LT(error, 1e-5) << law << averaged;
      MPI_Allreduce(MPI_IN_PLACE, yielded, 2, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
      EXPECT_GT(yielded[0], 10);
      EXPECT_GT(yielded[1], 10);
      const double place = largest(weak, 1, [&](size_t q, int) {
        const double x = weak.value("position", q, 0) - weak.value("displacement", q, 0);
        return weak.value("cohesion", q) - (5e3 + 4e3 * x + 8e3 * weak.value("position", q, 1));
      });
      EXPECT_LT(place, 1e-5);
    }
}

/// A block in flight takes the strength of its particles along, through cells and from rank to rank.
TEST(Practice, soil_in_flight_takes_its_strength_along) {
  const std::string text = R"(
[mesh]
section = "flight.csv"
size = 0.25
[body.soil]
region = "block"
density = 2000
velocity = ["10", "3 * x - 2.25"]
law = "mohr_coulomb"
young_modulus = "1 MPa"
poisson_ratio = 0.3
cohesion = "1e3 + 2e3 * x * y"
friction_angle = "20 + 10 * y"
[[stage]]
duration = 0.15
)";
  const Solved solved = solve(text);
  EXPECT_GT(largest(solved, 1, [&](size_t q, int) { return solved.value("displacement", q); }), 1.4);
  const auto undeformed = [&](size_t q, int k) {
    return solved.value("position", q, k) - solved.value("displacement", q, k);
  };
  EXPECT_LT(largest(solved, 1,
                    [&](size_t q, int) {
                      return solved.value("cohesion", q) - (1e3 + 2e3 * undeformed(q, 0) * undeformed(q, 1));
                    }),
            1e-9);
  EXPECT_LT(largest(solved, 1,
                    [&](size_t q, int) { return solved.value("friction_angle", q) - (20 + 10 * undeformed(q, 1)); }),
            1e-11);
}

/// Earth pressure at rest is that of the friction angle of the place, 1 - sin(phi). This stress is not linear in a
/// cell, so that the elements change it by 2 Pa; with one angle for all places it would be wrong by more than 1 kPa.
TEST(Practice, earth_pressure_at_rest_follows_the_friction_of_the_place) {
  const std::string stage = "[[stage]]\nkind = \"quasi_static\"\nduration = 1\ninitial_stress = \"k0\"\n";
  const Solved solved = solve(walls + "[boundary.right]\nkind = \"roller\"\n" + stage,
                              {"body.soil.density=2000", "body.soil.law=mohr_coulomb", "body.soil.cohesion=1000 * y",
                               "body.soil.friction_angle=20 + 15 * y"});
  EXPECT_LT(largest(solved, 1,
                    [&](size_t q, int) {
                      const double phi = (20 + 15 * solved.value("position", q, 1)) * degree.si;
                      return solved.value("stress", q, 0) - (1 - std::sin(phi)) * solved.value("stress", q, 1);
                    }),
            5);
  EXPECT_LT(
      largest(solved, 1,
              [&](size_t q, int) { return solved.value("stress", q, 1) + 2e4 * (1 - solved.value("position", q, 1)); }),
      5);
}

double factor_of(const std::string &text, const std::vector<std::string> &overrides) {
  Scene scene = parse_scene(text, meshes + "/scene.toml", overrides);
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false;
  return make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety().value();
}

/// An infinite slope of clay, phi = 0, at b = 20 deg with the cohesion c0 + a d^2 at the depth d: it slips where c / d
/// is least, at d = sqrt(c0 / a) inside the slope, with F = 2 sqrt(c0 a) / (gamma sin b). The stress that its ends
/// carry is that of the slope, whose shear stress gamma d sin b is at most c / F. The band in which elements slip is
/// 0.1 m wide, and c / d rises by less than 1 % in it; the bracket is 0.5 % wide.
TEST(Practice, infinite_slope_slips_where_cohesion_over_depth_is_least) {
  const double b = 20 * degree.si, gamma = 20e3, along = gamma * std::sin(b), normal = gamma * std::cos(b);
  const std::string ends = std::to_string(normal) + " * (1 - y)", shear = std::to_string(along) + " * (1 - y)";
  const std::string text = R"(
[mesh]
size = 0.1
[body.soil]
region = "soil"
density = 2000
law = "mohr_coulomb"
young_modulus = "20 MPa"
poisson_ratio = 0.4
cohesion = "2e3 + 8e3 * (1 - y)^2"
friction_angle = 0
[boundary.base]
kind = "fixed"
[boundary.left]
kind = "traction"
traction = [")" + ends + "\", \"-" +
                           shear + R"("]
[boundary.right]
kind = "traction"
traction = ["-)" + ends + "\", \"" +
                           shear + R"("]
[[stage]]
kind = "quasi_static"
duration = 1
)";
  const double exact = 2 * std::sqrt(2e3 * 8e3) / along;
  const double found =
      factor_of(text, {"mesh.section=" + std::string(TALUS_THIN_LAYER),
                       "gravity=[" + std::to_string(along / 2e3) + ", " + std::to_string(-normal / 2e3) + "]"});
  EXPECT_NEAR(found / exact, 1, 0.015) << found;
}

// ---- a water table per soil ----

/// Level ground of two layers, each with water of its own: perched, artesian, or none.
const std::string two_waters = R"(
gravity = 10
phases = "drained"
[mesh]
section = "layers.csv"
size = 0.2
[water]
[body.upper]
region = "upper"
unit_weight = "18 kN/m3"
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = "20 kPa"
friction_angle = 20
[body.lower]
region = "lower"
unit_weight = "20 kN/m3"
law = "linear_elastic"
young_modulus = "5 MPa"
poisson_ratio = 0.3
[boundary.walls]
group = ["base", "left", "right"]
kind = "roller"
[[stage]]
kind = "quasi_static"
duration = 1
reset_displacement = true
)";
struct Waters {
  const char *upper, *lower, *common;
  double upper_at, lower_at;  ///< elevation of the tables; so low that there is none
};
constexpr double no_water = -100;
/// Tables at or beyond the borders of the layers, so that elements hold the pressure exactly; `common` is [water].
const Waters waters[] = {
    {"[[0, 1]]", "[[0, 1.3]]", "", 1, 1.3},               // perched above artesian water
    {"[[0, 1]]", "[[0, -1]]", "", 1, no_water},           // perched above drained soil
    {"", "[[0, 1.2], [1, 1.2]]", "", no_water, 1.2},      // an artesian aquifer alone
    {"", "[[0, 1.2]]", "[[0, 1]]", 1, 1.2},               // beside the table of [water]
    {"[[0, 0.4]]", "", "[[0, 2], [1, 2]]", no_water, 2},  // drained under open water of 1 m depth
};
std::vector<std::string> keys_of(const Waters &w) {
  std::vector<std::string> keys{"mesh.section=" + std::string(TALUS_LAYERS)};
  if (*w.upper) keys.push_back(std::string("body.upper.water_table=") + w.upper);
  if (*w.lower) keys.push_back(std::string("body.lower.water_table=") + w.lower);
  if (*w.common) keys.push_back(std::string("water.table=") + w.common);
  return keys;
}
double pressure_at(double table, double y) { return 10e3 * std::max(0., table - y); }

/// Total stress is that of the weights and of open water, pore pressure that of the layer's own water, and effective
/// stress what is left: at every Gauss point, whether the stage begins with earth pressure at rest or without stress,
/// and after the tables have risen.
TEST(Practice, each_soil_has_its_own_water) {
  for (const Waters &w : waters)
    for (const std::string start : {"k0", "kept"})
      for (const double rise : {0., 0.25}) {
        if (rise > 0 && w.lower_at == no_water) continue;
        const Solved solved = solve(two_waters, keys_of(w) + std::vector<std::string>{"stage.0.initial_stress=" + start,
                                                                                      "water.level=[[0, 0], [1, " +
                                                                                          std::to_string(rise) + "]]"});
        const bool open = *w.common && w.upper_at == no_water;
        const auto pores = [&](size_t q) {
          const double y = solved.value("position", q, 1);
          if (y > 0.5) return w.upper_at == no_water ? 0 : pressure_at(w.upper_at + rise, y);
          return w.lower_at == no_water ? 0 : pressure_at(w.lower_at + rise, y);
        };
        if (rise > 0 && w.upper_at == no_water && *w.upper) continue;  // its table rises into the layer
        const double on_top = *w.common ? pressure_at((open ? 2 : 1) + rise, 1) : 0;
        SCOPED_TRACE(std::string(w.upper) + w.lower + w.common + start);
        EXPECT_LT(largest(solved, 1, [&](size_t q, int) { return solved.value("pore_pressure", q) - pores(q); }), 1e-8);
        EXPECT_LT(largest(solved, 1,
                          [&](size_t q, int) {
                            const double y = solved.value("position", q, 1),
                                         total = on_top + 18e3 * std::min(1 - y, 0.5) + 20e3 * std::max(0.5 - y, 0.);
                            return solved.value("stress", q, 1) + total - pores(q);
                          }),
                  1e-6);
      }
}

/// Soil at rest stays at rest when its motion begins, and has the same effective stress in the mean of each layer.
TEST(Practice, soil_with_its_own_water_stays_at_rest) {
  for (const Waters &w : waters) {
    Scene scene = parse_scene(
        two_waters + "[[stage]]\nduration = 0.02\n", meshes + "/scene.toml",
        keys_of(w) + std::vector<std::string>{"quasi_static.elements=patches", "quasi_static.tolerance=1e-12"});
    RunOptions options;
    options.pictures = options.screen = false;
    const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
    simulation->run();
    const Solved solved{simulation->snapshot(), simulation->history(), simulation->events()};
    SCOPED_TRACE(std::string(w.upper) + w.lower + w.common);
    EXPECT_LT(largest(solved, 2, [&](size_t q, int k) { return solved.value("displacement", q, k); }), 1e-11);
    double sums[4]{};  // stress and volume of the layers
    for (size_t q = 0; q < solved.points.id.size(); ++q) {
      const int b = solved.points.body[q];
      sums[b] += solved.value("volume", q) * solved.value("stress", q, 1), sums[2 + b] += solved.value("volume", q);
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    const double open = *w.common ? pressure_at(w.upper_at == no_water ? 2 : 1, 1) : 0;
    const double upper = w.upper_at == no_water ? 0 : pressure_at(w.upper_at, 0.75),
                 lower = w.lower_at == no_water ? 0 : pressure_at(w.lower_at, 0.25);
    EXPECT_NEAR(sums[0] / sums[2], -(open + 18e3 * 0.25) + upper, 1e-4);
    EXPECT_NEAR(sums[1] / sums[3], -(open + 18e3 * 0.5 + 20e3 * 0.25) + lower, 1e-4);
  }
}

/// Two soils with different pore pressure ratios: each has its own up to the interface.
TEST(Practice, pore_pressure_ratios_differ_from_soil_to_soil) {
  const Solved solved = solve(two_waters, {"mesh.section=" + std::string(TALUS_LAYERS),
                                           "body.upper.pore_pressure_ratio=0.2", "body.lower.pore_pressure_ratio=0.5"});
  EXPECT_LT(largest(solved, 1,
                    [&](size_t q, int) {
                      const double y = solved.value("position", q, 1),
                                   total = 18e3 * std::min(1 - y, 0.5) + 20e3 * std::max(0.5 - y, 0.);
                      return solved.value("stress", q, 1) + (y > 0.5 ? 0.8 : 0.5) * total;
                    }),
            1e-6);
}

}  // namespace
}  // namespace talus
