// Rows of history.csv: output points in stages by finite elements are the places that the scene gives, and rows do not
// change the steps of the motion.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../quasi_static/solved.h"
#include "scene/scene.h"

namespace talus {
namespace {

const std::string slope = std::string(TALUS_MESHES) + "/../tests/exactness/ranks/slope.toml";
const std::string column = "gravity = 10\n" + box + R"(
density = 2000
[boundary.walls]
group = ["base", "left", "right"]
kind = "roller"
)";

/// A column under its weight sinks by a quadratic function of height, which elements of second order hold exactly: a
/// point shows it at its own place, between nodes as well as on an edge or a corner of the soil. The nearest particle
/// is 0.05 m away, where the displacement differs by a tenth and more.
TEST(HistoryRows, static_stages_show_the_place_itself) {
  const double modulus = 10e6 * 0.7 / (1.3 * 0.4), weight = 2000 * 10;
  const std::vector<std::pair<std::string, double>> points{
      {"[0.37, 0.61]", 0.61}, {"[0.5, 1]", 1}, {"[0, 1]", 1}, {"[1, 0.2]", 0.2}};
  std::string text = column + "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n";
  for (size_t i = 0; i < points.size(); ++i)
    text += "[output.point.p" + std::to_string(i) + "]\nposition = " + points[i].first + "\n";
  const HistoryTable history = solve(text).history;
  for (size_t i = 0; i < points.size(); ++i) {
    const std::string name = "p" + std::to_string(i);
    const double y = points[i].second, exact = weight / modulus * (y - y * y / 2);
    EXPECT_NEAR(history.column(name + "_displacement_m").back(), exact, 1e-12 * weight / modulus) << points[i].first;
    EXPECT_EQ(history.column(name + "_y_m").back(), y) << points[i].first;
    EXPECT_EQ(history.column(name + "_velocity_m_s").back(), 0) << points[i].first;
  }
}

/// Energies of the last row [J].
struct Energies {
  double strain, gravity, imposed, dissipated;
  explicit Energies(const HistoryTable &history)
      : strain(history.column("strain_J").back()),
        gravity(history.column("work_gravity_J").back()),
        imposed(history.column("work_imposed_J").back()),
        dissipated(history.column("dissipated_J").back()) {}
};
constexpr double round_off = 1e-9;
const std::string equilibrium = "[[stage]]\nname = \"rest\"\nkind = \"quasi_static\"\nduration = 1\n";

/// Weight that grows from nothing along a path does half of the work of the whole weight on the same way: all of it is
/// strain energy of elastic soil, w^2 h^3 / (6 M) per width, in however many steps.
TEST(HistoryRows, static_stages_do_the_work_that_elastic_soil_stores) {
  const double modulus = 10e6 * 0.7 / (1.3 * 0.4), weight = 2000 * 10, exact = weight * weight / (6 * modulus);
  for (const char *steps : {"stage.rest.load_steps=1", "stage.rest.load_steps=5"}) {
    const Energies e(solve(column + equilibrium, {steps}).history);
    EXPECT_NEAR(e.strain, exact, round_off * exact) << steps;
    EXPECT_NEAR(e.gravity, exact, round_off * exact) << steps;
    EXPECT_NEAR(e.imposed, 0, round_off * exact);
    EXPECT_NEAR(e.dissipated, 0, round_off * exact);
  }
}

/// So do loads and plates, each under its name; a second path adds to the first.
TEST(HistoryRows, static_stages_count_the_work_of_loads_and_plates) {
  const std::string more = equilibrium + "[[stage]]\nname = \"more\"\nkind = \"quasi_static\"\nduration = 1\n";
  const double modulus = 10e6 * 0.7 / (1.3 * 0.4);
  const HistoryTable pressed = solve(column + more + "[boundary.top]\nkind = \"traction\"\npressure = \"1e4 * t\"\n",
                                     {"gravity=0", "boundary.top.group=surface"})
                                   .history;
  const double stored = 2e4 * 2e4 / (2 * modulus);
  EXPECT_NEAR(pressed.column("strain_J").back(), stored, round_off * stored);
  EXPECT_NEAR(pressed.column("work_top_J").back(), stored, round_off * stored);
  EXPECT_NEAR(pressed.column("dissipated_J").back(), 0, round_off * stored);
  const HistoryTable moved =
      solve(column + more + "[boundary.top]\nkind = \"velocity\"\nvelocity = [\"0\", \"-1e-3\"]\n",
            {"gravity=0", "boundary.top.group=surface"})
          .history;
  const double squeezed = modulus * 2e-3 * 2e-3 / 2;
  EXPECT_NEAR(moved.column("strain_J").back(), squeezed, round_off * squeezed);
  EXPECT_NEAR(moved.column("work_top_J").back(), squeezed, round_off * squeezed);
  EXPECT_NEAR(moved.column("dissipated_J").back(), 0, round_off * squeezed);
}

/// Stress that a stage begins with is imposed; soil that yields dissipates; water that is prescribed does work too.
TEST(HistoryRows, static_stages_dissipate_what_yields) {
  const Energies at_rest(solve(column + equilibrium, {"stage.rest.initial_stress=k0"}).history);
  EXPECT_GT(at_rest.imposed, 0.9 * at_rest.strain);
  EXPECT_NEAR(at_rest.dissipated, 0, round_off * at_rest.strain);
  const Energies wet(solve(column + equilibrium, {"phases=drained", "water.table=[[0, 1], [1, 1]]"}).history);
  EXPECT_NEAR(wet.imposed, -0.5 * wet.gravity, round_off * wet.gravity) << "buoyancy is half of the weight";
  EXPECT_NEAR(wet.dissipated, 0, round_off * wet.strain);
  const Energies yields(solve(column + equilibrium, {"body.soil.law=mohr_coulomb", "body.soil.cohesion=100",
                                                     "body.soil.friction_angle=10", "stage.rest.load_steps=10"})
                            .history);
  EXPECT_GT(yields.dissipated, 0.01 * yields.strain);
  EXPECT_NEAR(yields.gravity, yields.strain + yields.dissipated, round_off * yields.strain);
}

/// In drained soil a support bears the effective weight: the pressure of the water at the base bears the rest.
TEST(HistoryRows, show_the_effective_force_of_drained_soil) {
  const HistoryTable history = solve(column + "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n",
                                     {"phases=drained", "water.table=[[0, 1], [1, 1]]"})
                                   .history;
  EXPECT_NEAR(history.column("walls_force_y_N").back(), (2000 - 1000) * 10, 1e-6);
}

/// Under its weight the column has sigma_yy = -gamma (1 - y) and nu / (1 - nu) of it sideways, which rows show by
/// components, mean pressure, deviator and the friction that they mobilise.
TEST(HistoryRows, show_the_stress_of_a_point) {
  const std::string text = column +
                           "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n"
                           "[output.point.p]\nposition = [0.37, 0.61]\n";
  const HistoryTable history =
      solve(text, {"body.soil.law=mohr_coulomb", "body.soil.cohesion=20000", "body.soil.friction_angle=30"}).history;
  const double vertical = -2000 * 10 * (1 - 0.61), level = 0.3 / 0.7 * vertical, tolerance = 1e-8;
  const auto last = [&](const std::string &name) { return history.column("p_" + name).back() / -vertical; };
  EXPECT_NEAR(last("stress_xx_Pa"), -0.3 / 0.7, tolerance);
  EXPECT_NEAR(last("stress_yy_Pa"), -1, tolerance);
  EXPECT_NEAR(last("stress_zz_Pa"), -0.3 / 0.7, tolerance);
  EXPECT_NEAR(last("stress_xy_Pa"), 0, tolerance);
  EXPECT_NEAR(last("mean_pressure_Pa"), (1 + 2 * 0.3 / 0.7) / 3, tolerance);
  EXPECT_NEAR(last("deviator_Pa"), 1 - 0.3 / 0.7, tolerance);
  const double sine = (level - vertical) / (2 * 20e3 * std::sqrt(3.) - level - vertical);
  EXPECT_NEAR(history.column("p_mobilised_friction_deg").back(), std::asin(sine) * 180 / M_PI, 1e-6);
  EXPECT_EQ(history.column("p_state").back(), 0);
  EXPECT_EQ(history.column("p_plastic_strain").back(), 0);
}

/// A slope too weak to stand slides at its yield surface, with a friction angle of 20 degrees all the while. By the
/// strain with which the law softens, that of the cell or its average, all of the soil that slides mobilises that
/// angle; by the strain of the particles some would mobilise 24 degrees.
TEST(HistoryRows, mobilised_friction_is_that_of_the_strain_by_which_soil_softens) {
  for (const char *length : {"0", "1.5"}) {
    Scene scene = read_scene(slope, {std::string("body.weathered.averaging_length=") + length});
    RunOptions options;
    options.pictures = options.screen = false;
    const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
    for (int step = 0; step < 200; ++step) simulation->single_step();
    const Solved found{simulation->snapshot(), simulation->history(), simulation->events()};
    double counts[2] = {0, 0}, largest = 0;  // soil that has lost strength; of it, at its yield surface
    for (size_t i = 0; i < found.points.id.size(); ++i) {
      if (found.points.body[i] != 0) continue;
      const double angle = found.value("mobilised_friction", i);
      largest = std::max(largest, angle);
      if (found.value("state", i) < 2) continue;
      ++counts[0], counts[1] += angle > 19.9;
    }
    MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    EXPECT_LT(largest, 20.2) << length;
    EXPECT_GT(counts[0], 1000) << length;
    EXPECT_GT(counts[1], 0.6 * counts[0]) << length << ": the others are unloaded by vibration";
  }
}

/// Until the wave from the base arrives, after 12 ms, the top of a column falls freely, but for what mapping spreads
/// over cells before it; the acceleration of a row is
/// the change of velocity since the row before over the time between them.
TEST(HistoryRows, show_the_mean_acceleration_since_the_row_before) {
  const HistoryTable history = solve(column + "[output.point.top]\nposition = [0.5, 1]\n[[stage]]\nduration = 0.1\n",
                                     {"output.history_interval=0.002"})
                                   .history;
  const std::vector<double> a = history.column("top_acceleration_m_s2"), v = history.column("top_velocity_m_s"),
                            t = history.column("time_s");
  EXPECT_EQ(a[0], 0);
  for (size_t i = 1; t[i] < 0.004; ++i) EXPECT_NEAR(a[i], 10, 0.02) << t[i];
  int rising = 0;
  for (size_t i = 1; i < t.size(); ++i) {
    EXPECT_GE(a[i] * (t[i] - t[i - 1]), std::abs(v[i] - v[i - 1]) * (1 - 1e-12)) << t[i];
    rising += v[i] > v[i - 1];
  }
  EXPECT_GT(rising, 5);
}

/// A row at the end of a stage, soon after another one, is a mean over as long a time as the others. The top of a
/// column that falls freely, until the wave from the base arrives after 12 ms, by an acceleration that grows with time
/// shows over which.
TEST(HistoryRows, do_not_end_with_the_acceleration_of_a_single_step) {
  const HistoryTable history =
      solve(column + "[output.point.top]\nposition = [0.5, 1]\n[[stage]]\nduration = 0.0085\n",
            {"output.history_interval=0.002", "mesh.size=0.05", "body.soil.body_acceleration=[\"0\", \"-1000 * t\"]"})
          .history;
  const std::vector<double> a = history.column("top_acceleration_m_s2"), t = history.column("time_s");
  const size_t n = t.size();
  ASSERT_LT(t[n - 1] - t[n - 2], 0.5 * (t[n - 2] - t[n - 3]));
  EXPECT_NEAR(a[n - 2], 10 + 1000 * (t[n - 2] + t[n - 3]) / 2, 0.2);
  EXPECT_NEAR(a[n - 1], 10 + 1000 * (t[n - 1] + t[n - 3]) / 2, 0.2);
}

/// Rows come with the first step that reaches their time, and the motion is the same to the last bit however many there
/// are.
TEST(HistoryRows, do_not_shorten_steps) {
  const std::string text = column + "[output.point.top]\nposition = [0.5, 1]\n[[stage]]\nduration = 0.1\n";
  const HistoryTable a = solve(text, {"output.history_interval=0.1"}).history,
                     b = solve(text, {"output.history_interval=7e-4"}).history;
  EXPECT_EQ(a.rows.size(), 2u) << "start and end";
  EXPECT_GT(b.rows.size(), 20u);
  EXPECT_EQ(a.column("step").back(), b.column("step").back());
  EXPECT_EQ(a.column("top_displacement_m").back(), b.column("top_displacement_m").back());
  const std::vector<double> times = b.column("time_s");
  const double step = 0.1 / b.column("step").back();
  for (size_t i = 1; i + 1 < times.size(); ++i) {
    const double due = 7e-4 * std::floor(times[i] / 7e-4 * (1 + 1e-9));  // the last row time that this step reached
    EXPECT_LT(times[i] - due, 1.01 * step) << i;
    EXPECT_GT(due, times[i - 1]) << i;
  }
}

/// Columns of line_NAME.csv that a run of the scene leaves in a folder of its own.
struct FollowedLine {
  std::map<std::string, std::vector<double>> columns;
  std::vector<std::string> stages;

  FollowedLine(const std::string &text, const std::string &name, const std::vector<std::string> &overrides = {}) {
    int rank;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    std::string folder = std::filesystem::temp_directory_path() / ("talus_line_" + std::to_string(::getpid()));
    unsigned long length = folder.size();
    MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, 0, PETSC_COMM_WORLD);
    folder.resize(length);
    MPI_Bcast(folder.data(), static_cast<int>(length), MPI_CHAR, 0, PETSC_COMM_WORLD);
    Scene scene = parse_scene(text, meshes + "/scene.toml", overrides);
    RunOptions options;
    options.pictures = options.screen = false, options.directory = folder;
    make_simulation(PETSC_COMM_WORLD, scene, options)->run();
    MPI_Barrier(PETSC_COMM_WORLD);
    std::ifstream file(folder + "/line_" + name + ".csv");
    std::string line, cell;
    std::getline(file, line);
    std::vector<std::string> names;
    for (std::istringstream header(line); std::getline(header, cell, ',');) names.push_back(cell);
    while (std::getline(file, line)) {
      std::istringstream row(line);
      for (const std::string &column : names) {
        std::getline(row, cell, ',');
        if (column == "stage")
          stages.push_back(cell);
        else
          columns[column].push_back(std::strtod(cell.c_str(), nullptr));
      }
    }
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank == 0) std::filesystem::remove_all(folder);
  }
};

/// A line in a static stage shows its own places: those of equal distances through its points, of which the ones above
/// the soil are left out, with the displacement and the stress of a column under its weight.
TEST(FollowedLines, show_the_places_along_them) {
  const FollowedLine line(column +
                              "[[stage]]\nkind = \"quasi_static\"\nduration = 1\n"
                              "[output.line.down]\npoints = [[0.4, 3], [0.4, 0.5], [0.8, 0.2]]\nspacing = 0.1\n",
                          "down");
  const double weight = 2000 * 10, modulus = 10e6 * 0.7 / (1.3 * 0.4);
  int rows = 0;
  for (size_t i = 0; i < line.stages.size(); ++i) {
    if (line.stages[i] == "start") continue;
    const double s = line.columns.at("distance_m")[i], x = line.columns.at("x_m")[i], y = line.columns.at("y_m")[i];
    EXPECT_NEAR(std::remainder(s, 0.1), 0, 1e-9);
    EXPECT_NEAR(x, s < 2.5 ? 0.4 : 0.4 + 0.8 * (s - 2.5), 1e-9) << s;
    EXPECT_NEAR(y, s < 2.5 ? 3 - s : 0.5 - 0.6 * (s - 2.5), 1e-9) << s;
    if (y > 1 || line.columns.at("time_s")[i] < 1) continue;  // a little above the soil, or not the end
    EXPECT_NEAR(line.columns.at("displacement_m")[i], weight / modulus * (y - y * y / 2), 1e-9 * weight / modulus);
    EXPECT_NEAR(line.columns.at("stress_yy_Pa")[i], -weight * (1 - y), 1e-7 * weight) << y;
    ++rows;
  }
  EXPECT_EQ(rows, 11);  // six in the upper piece and five in the lower one
}

/// In motion a line is its particles: they fall with the body, at the times of the history, each time all of them.
TEST(FollowedLines, move_with_the_soil) {
  const FollowedLine line(column +
                              "[output.line.level]\npoints = [[0.1, 0.9], [0.9, 0.9]]\nspacing = 0.2\n"
                              "[[stage]]\nduration = 0.01\n[output]\nhistory_interval = 0.002\n",
                          "level");
  const auto &time = line.columns.at("time_s"), &y = line.columns.at("y_m"), &step = line.columns.at("step");
  ASSERT_EQ(time.size() % 5, 0u);
  ASSERT_GE(time.size() / 5, 5u);
  for (size_t i = 5; i < time.size(); ++i) {
    EXPECT_EQ(time[i], time[i - i % 5]);
    const double fall = 5 * time[i] * time[i] * (1 + 1 / step[i]);  // of Euler's steps
    if (time[i] < 0.004) {
      EXPECT_NEAR(y[i] - y[i % 5], -fall, 1e-3 * fall) << time[i];
    }
  }
}

/// Particles stand for the places in the soil, not for those in the air above it, where they would be the same again.
TEST(FollowedLines, end_with_the_soil) {
  const FollowedLine line(column +
                              "[output.line.up]\npoints = [[0.5, 0.5], [0.5, 2]]\nspacing = 0.1\n"
                              "[[stage]]\nduration = 0.001\n",
                          "up");
  const auto &distance = line.columns.at("distance_m");
  for (const double s : distance) EXPECT_LT(s, 0.55);
  EXPECT_NEAR(*std::max_element(distance.begin(), distance.end()), 0.5, 1e-9) << "the surface is the soil's too";
}

TEST(FollowedLines, are_refused_where_they_are_none) {
  const std::string text = column + "[[stage]]\nduration = 0.01\n";
  const auto why = [&](const std::vector<std::string> &overrides) -> std::string {
    try {
      solve(text, overrides);
    } catch (const SceneError &error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(why({"output.line.a.points=[[5, 5], [6, 6]]"}).find("must be a line in the soil; of 40 places"),
            std::string::npos);
  EXPECT_NE(why({"output.line.a.points=[[0.5, 0.5]]"}).find("must be two or more different points"), std::string::npos);
  EXPECT_NE(why({"output.line.a.points=[[0.5, 0.5], [0.5, 0.5]]"}).find("two or more"), std::string::npos);
  EXPECT_NE(why({"output.line.a.points=[[0.5, 0.5, 0], [0.5, 0.9, 0]]"}).find("coordinates"), std::string::npos);
  EXPECT_NE(why({"output.line.a.points=[[0.5, 0.5], [0.5, 0.9]]", "output.line.a.spacing=1"}).find("must not exceed"),
            std::string::npos);
  EXPECT_NE(why({"output.line.a.points=[[0.5, 0.5], [0.5, 0.9]]", "output.line.a.spacing=1e-5"}).find("at least"),
            std::string::npos);
}

}  // namespace
}  // namespace talus
