// Claims of output/pictures.h and of the scripts in src/output/plots.
#include "output/pictures.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "base/version.h"
#include "fixtures.h"
#include "output/history.h"
#include "output/strength.h"

namespace talus {
namespace {

/// history_columns.csv of a history made by hand.
void describe(const std::string &dir, const std::string &rows) {
  std::ofstream(dir + "/history_columns.csv") << "column,quantity,unit,of,which\n" + rows;
}

TEST(Pictures, and_a_report_are_drawn_from_the_results) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  History history(MPI_COMM_WORLD, dir + "/history.csv", {"crest_displacement_m", "kinetic_J", "mass_kg"});
  for (int n = 0; n < 3; ++n) {
    run.write(small_snapshot(n, n));
    history.row(n, n, "slide", {0.1 * n, 2. * n, 100});
  }
  if (world_rank()) return;
  describe(dir,
           "crest_displacement_m,displacement,m,point,crest\nkinetic_J,energy,J,run,kinetic\nmass_kg,mass,kg,run,\n");
  ASSERT_TRUE(draw_pictures(dir));
  for (const char *name : {"displacement.png", "plastic_strain_large.png", "history_displacement.png", "energy.png"})
    EXPECT_EQ(content(dir + "/pictures/" + name).substr(1, 3), "PNG") << name;
  const std::string drawn_by = std::string("Software") + '\0' + program + ",";  // of PNG's type tEXt
  EXPECT_NE(content(dir + "/pictures/displacement.png").find(drawn_by), std::string::npos);
  const std::string report = content(dir + "/report.html");
  EXPECT_NE(report.find("a small slope"), std::string::npos);
  EXPECT_NE(report.find("data:image/png;base64,"), std::string::npos);
  EXPECT_EQ(report.find("src=\"http"), std::string::npos) << "a report stands alone";
}

const std::string frictional_scene = R"(
title = "a frictional slope"
[mesh]
file = "slope.msh"
[body.sand]
region = "sand"
density = 2000
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = "1 kPa"
friction_angle = 30
residual_cohesion = 0
shape_factor = 50
[body.clay]
region = "clay"
density = 2000
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
[boundary.base]
kind = "fixed"
[[stage]]
name = "slide"
duration = 1
)";

/// q = 6 (c cos(phi) + p sin(phi)) / (3 - sin(phi)) in triaxial compression; elastic soil has no line.
TEST(Strength, is_that_of_the_law) {
  const auto lines = strength_lines(frictional_scene);
  ASSERT_EQ(lines.size(), 2u);
  for (const StrengthLine &line : lines) {
    EXPECT_EQ(line.body, "sand");
    EXPECT_NEAR(line.slope, 1.2, 1e-12);
    EXPECT_NEAR(line.intercept, line.residual ? 0 : 2.4e3 * std::cos(M_PI / 6), 1e-9);
  }
}

TEST(Strength, grows_with_suction) {
  const std::string keys = "friction_angle = 30\nsuction_cohesion = \"154 kPa\"\nsuction_cohesion_rate = 7e-7\n";
  std::string scene = frictional_scene;
  scene.replace(scene.find("friction_angle"), std::string("friction_angle = 30\n").size(), keys);
  const auto lines = strength_lines(scene);
  const double steep = 2.4 * std::cos(M_PI / 6);
  ASSERT_EQ(lines.size(), 22u);  // peak and residual at 0, 1, 2, 5 ... 1000 kPa
  EXPECT_EQ(lines[10].suction, 1e6);
  EXPECT_NEAR(lines[10].intercept, steep * (1e3 + 154e3 * (1 - std::exp(-0.7))), 1e-6);
}

TEST(Pictures, show_stress_paths_and_the_water_ledger) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunHeader header = small_header();
  header.values = frictional_scene;  // the text as read may have other values than the overrides of the run
  RunFile run(MPI_COMM_WORLD, dir, header, small_mesh());
  History history(MPI_COMM_WORLD, dir + "/history.csv",
                  {"crest_x_m", "crest_y_m", "crest_mean_pressure_Pa", "crest_deviator_Pa",
                   "crest_mobilised_friction_deg", "water_kg", "water_out_kg", "water_given_kg", "water_error_kg"});
  for (int n = 0; n < 3; ++n) {
    Snapshot snapshot = small_snapshot(n, n);
    Column friction{"mobilised_friction", "deg", "mobilised friction", 1, {}};
    Column state{"state", "-", "state", 1, {}};
    for (const long long id : snapshot.id) {  // some without stress, and some that have softened
      friction.values.push_back(id ? 0.1 * static_cast<double>(id) : std::nan(""));
      state.values.push_back(static_cast<double>(id % 4));
    }
    snapshot.columns.push_back(friction), snapshot.columns.push_back(state);
    run.write(snapshot);
    history.row(n, n, "slide", {0.5, 0.4, 5e3 * n, 4e3 * n, 10. * n, 100. - n, 1. * n, 0, 1e-14 * n});
  }
  if (world_rank()) return;
  describe(dir,
           "crest_x_m,x,m,point,crest\ncrest_y_m,y,m,point,crest\ncrest_mean_pressure_Pa,mean_pressure,Pa,point,crest\n"
           "crest_deviator_Pa,deviator,Pa,point,crest\n"
           "crest_mobilised_friction_deg,mobilised_friction,deg,point,crest\nwater_kg,water_ledger,kg,run,stored\n"
           "water_out_kg,water_ledger,kg,run,out\nwater_given_kg,water_ledger,kg,run,given\nwater_error_kg,water_"
           "ledger,kg,run,error\n");
  ASSERT_TRUE(draw_pictures(dir));
  EXPECT_EQ(content(dir + "/pictures/strength.csv").substr(0, 40), "body,state,suction_Pa,slope,intercept_Pa");
  for (const char *name : {"stress_paths.png", "mobilised_friction_large.png", "state_large.png", "water_ledger.png"})
    EXPECT_EQ(content(dir + "/pictures/" + name).substr(1, 3), "PNG") << name;
}

/// A run that broke off or was killed says so on top of its report, unless it was resumed and came to its end.
TEST(Pictures, and_report_tell_how_a_run_broke_off) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  run.write(small_snapshot(1, 1));
  if (world_rank()) return;
  const auto top_of_report = [&] {
    EXPECT_TRUE(draw_pictures(dir, {{"displacement"}, {}}));
    const std::string report = content(dir + "/report.html");
    return report.substr(report.find("<header>"), report.find("</header>") - report.find("<header>"));
  };
  const auto happens = [&](const std::vector<std::string> &kinds) {
    std::ofstream events(dir + "/events.jsonl");
    for (const std::string &kind : kinds)
      events << R"({"kind": ")" << kind
             << R"(", "stage": "slide", "time_s": 1, "load_time_s": 1, "values": {}, "warning": false, "text": )"
             << "\"a particle left the mesh near (3, 1) m\"}\n";
  };
  happens({"broke_off"});
  EXPECT_NE(top_of_report().find("a particle left the mesh near (3, 1) m"), std::string::npos);
  happens({"resumed"});
  EXPECT_EQ(top_of_report().find("broke off"), std::string::npos);
  EXPECT_NE(top_of_report().find("it was killed, or still runs"), std::string::npos);
  happens({"resumed", "end"});
  EXPECT_EQ(top_of_report().find("class=\"ending\""), std::string::npos);
}

/// What particles took away is one of the energies, and round-off of the table is no error of the ledger.
TEST(Pictures, and_report_count_what_left_the_mesh) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  run.write(small_snapshot(1, 1));
  if (world_rank()) return;
  const auto mass_ledger = [&](double lost) {
    History history(MPI_COMM_SELF, dir + "/history.csv",
                    {"kinetic_J", "escaped_energy_J", "mass_kg", "escaped_mass_kg"});
    history.row(0, 0, "slide", {1, 0, 1000, 0}), history.row(1, 1, "slide", {2, 3, 900 - lost, 100});
    describe(dir,
             "kinetic_J,energy,J,run,kinetic\nescaped_energy_J,energy,J,run,escaped_energy\nmass_kg,mass,kg,run,\n"
             "escaped_mass_kg,escaped_mass,kg,run,\n");
    EXPECT_TRUE(draw_pictures(dir, {{"displacement"}, {}}));
    const std::string report = content(dir + "/report.html");
    return report.substr(report.find("Mass ledger"), 120);
  };
  EXPECT_NE(mass_ledger(1e-9).find("closed"), std::string::npos);
  EXPECT_NE(mass_ledger(2).find("-2.0e+00 kg/m"), std::string::npos) << mass_ledger(2);
  EXPECT_FALSE(std::filesystem::exists(dir + "/pictures/history_escaped_energy.png")) << "it is in energy.png";
}

/// A band of plastic strain two rows high that descends by one row in five columns: the line passes through its middle,
/// at the places that the soil had at the start.
TEST(Pictures, find_the_slip_surface) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  for (int n = 0; n < 2; ++n) {
    Snapshot snapshot = small_snapshot(30 * n, n);
    for (Column &column : snapshot.columns)
      if (column.name == "plastic_strain")
        for (size_t i = 0; i < snapshot.id.size(); ++i) {
          const long long row = snapshot.id[i] / 20, middle = 6 - snapshot.id[i] % 20 / 5;
          column.values[i] = n * (row == middle || row == middle + 1 ? 0.5 : 0.01);
        }
    run.write(snapshot);
  }
  if (world_rank()) return;
  PictureChoice choice;
  choice.fields = {"displacement"}, choice.slip_surface = true;
  ASSERT_TRUE(draw_pictures(dir, choice));
  std::istringstream table(content(dir + "/pictures/slip_surface.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "x_m,elevation_m");
  int points = 0;
  while (std::getline(table, line)) {
    const double x = std::stod(line), y = std::stod(line.substr(line.find(',') + 1));
    EXPECT_NEAR(y, 0.65 - 0.1 * std::floor(x / 0.5 + 1e-9), 0.1) << x;
    ++points;
  }
  EXPECT_GE(points, 8);
  EXPECT_EQ(content(dir + "/pictures/slip_surface.png").substr(1, 3), "PNG");
}

/// A film is drawn instead of pictures and report. Its GIF needs no ffmpeg.
TEST(Pictures, move) {
  const SharedFolder folder;
  const std::string dir = folder / "run", film = dir + "/pictures/movie_displacement.gif";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  PictureChoice choice;
  choice.fields = {"displacement"}, choice.movie = true;
  const auto complaint = [&] {
    testing::internal::CaptureStderr();
    EXPECT_FALSE(draw_pictures(dir, choice));
    return testing::internal::GetCapturedStderr();
  };
  run.write(small_snapshot(0, 0));
  if (!world_rank()) {
    EXPECT_NE(complaint().find("a film needs two"), std::string::npos);
  }
  run.write(small_snapshot(1, 1)), run.write(small_snapshot(2, 2));
  if (world_rank()) return;
  ASSERT_TRUE(draw_pictures(dir, choice));
  EXPECT_EQ(content(film).substr(0, 6), "GIF89a");
  EXPECT_FALSE(std::filesystem::exists(dir + "/report.html"));
  choice.fields = {"plastic_strein"};
  EXPECT_NE(complaint().find("did you mean plastic_strain?"), std::string::npos);
  choice.fields = {};  // plastic strain
  ASSERT_TRUE(draw_pictures(dir, choice));
  EXPECT_TRUE(std::filesystem::exists(dir + "/pictures/movie_plastic_strain.gif"));
  std::filesystem::remove_all(dir + "/pictures");
  std::ofstream(dir + "/pictures") << "a file in the place of the folder";
  EXPECT_NE(complaint().find("cannot write the film in " + dir + "/pictures"), std::string::npos);
}

/// What was asked for and is not there is an error of the user, with status 2; times beyond the run are said.
TEST(Pictures, say_what_they_cannot_show) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  run.write(small_snapshot(0, 0)), run.write(small_snapshot(2, 2));
  if (world_rank()) return;
  const auto drawn = [&](const std::string &field, const std::string &time) {
    testing::internal::CaptureStderr();
    const int status = status_of_pictures(dir, {{field}, {time}});
    return std::pair{status, testing::internal::GetCapturedStderr()};
  };
  const double last = 2;
  const auto [good, nothing] = drawn("displacement", std::to_string(last / 2));
  EXPECT_EQ(good, 0);
  EXPECT_EQ(nothing, "");
  const auto [refused, nearest] = drawn("plastic_strein", "1");
  EXPECT_EQ(refused, 2);
  EXPECT_NE(nearest.find("has no field plastic_strein; did you mean plastic_strain?"), std::string::npos) << nearest;
  const auto [late, said] = drawn("displacement", "1000");
  EXPECT_EQ(late, 0);
  EXPECT_NE(said.find("talus: --times 1000: the run has snapshots from "), std::string::npos) << said;
}

TEST(Pictures, never_fail_a_run) {
  const SharedFolder folder;
  if (world_rank()) return;
  EXPECT_FALSE(draw_pictures(folder / "nothing"));
}

}  // namespace
}  // namespace talus
