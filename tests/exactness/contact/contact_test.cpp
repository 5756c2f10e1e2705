// Groups of bodies that meet: no momentum is lost, they bounce, slide, stick, hang together and part as Coulomb's law
// says, a bond makes them one body, and ranks and checkpoints change nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/temporary_folder.h"
#include "contact_mesh.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

using test::Place;

/// A folder that all ranks know.
class Contact : public ::testing::Test {
 protected:
  void SetUp() override {
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank_);
    ASSERT_TRUE(rank_ > 0 || folder_.make());
    char path[4096] = "";
    std::strncpy(path, folder_.path().c_str(), sizeof path - 1);
    MPI_Bcast(path, sizeof path, MPI_CHAR, 0, PETSC_COMM_WORLD);
    path_ = path;
  }
  std::string file(const std::string &name) const { return path_ + "/" + name; }
  /// Writes a mesh on one rank.
  void mesh(int dim, const Place &low, const Place &high, double size, double jitter,
            const std::vector<test::Region> &regions) const {
    if (rank_ == 0) test::write_contact_mesh(file("mesh.msh"), dim, low, high, size, jitter, regions);
    MPI_Barrier(PETSC_COMM_WORLD);
  }

  struct Result {
    HistoryTable history;
    std::array<double, 3> momentum_before{}, momentum{};  ///< of all particles [kg m/s]
    double value(const std::string &column) const { return history.column(column).back(); }
  };
  Result run(const std::string &text, RunOptions options = {}, MPI_Comm comm = PETSC_COMM_WORLD) const {
    const Scene scene = parse_scene(text, "contact");
    options.pictures = options.screen = false;
    const auto simulation = make_simulation(comm, scene, options);
    Result result;
    if (!options.resume) result.momentum_before = momentum(*simulation, comm);
    simulation->run();
    result.momentum = momentum(*simulation, comm), result.history = simulation->history();
    return result;
  }
  static std::array<double, 3> momentum(AnySimulation &simulation, MPI_Comm comm) {
    const Snapshot now = simulation.snapshot();
    std::array<double, 3> sum{};
    const auto field = [&](const std::string &name) {
      return *std::ranges::find_if(now.columns, [&](const auto &one) { return one.name == name; });
    };
    const auto mass = field("mass"), velocity = field("velocity");
    for (size_t p = 0; p < mass.values.size(); ++p)
      for (int d = 0; d < velocity.components; ++d)
        sum[d] += mass.values[p] * velocity.values[p * velocity.components + d];
    MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, comm);
    return sum;
  }

  std::string head(const std::string &more = "") const {
    return more + "[mesh]\nfile = \"" + file("mesh.msh") + "\"\n";
  }

 private:
  TemporaryFolder folder_;
  std::string path_;
  int rank_ = 0;
};

std::string body(const std::string &name, const std::string &group, const std::string &more = "",
                 const std::string &modulus = "1e6", double nu = 0) {
  return "[body." + name + "]\nregion = \"" + name + "\"\n" +
         (group.empty() ? "" : "contact_group = \"" + group + "\"\n") +
         "density = 1000\nlaw = \"linear_elastic\"\nyoung_modulus = " + modulus +
         "\npoisson_ratio = " + std::to_string(nu) + "\n" + more;
}
std::string joint(const std::string &keys) { return "[contact.joint]\nbetween = [\"a\", \"b\"]\n" + keys + "\n"; }
std::string stage(double duration, const std::string &more = "") {
  return "[[stage]]\nduration = " + std::to_string(duration) + "\n" + more;
}
const std::string output = "[output]\ninterval = 0\nhistory_interval = 0.001\n";

/// Two bars of 1 m x 0.4 m, 5 cm apart and at an angle to the cells, whose surfaces are those of cells.
struct Bars {
  double c, s;
  explicit Bars(double degrees)
      : c(std::cos(degrees * std::acos(-1.) / 180)), s(std::sin(degrees * std::acos(-1.) / 180)) {}
  std::vector<test::Region> regions() const {
    const auto bar = [*this](double from, double to) {
      return [=, *this](const Place &x) {
        const double along = c * x[0] + s * x[1], across = c * x[1] - s * x[0];
        return from < along && along < to && std::abs(across) < 0.2;
      };
    };
    return {{"a", bar(-1.025, -0.025)}, {"b", bar(0.025, 1.025)}};
  }
  std::string moving(double speed) const {
    return "velocity = [\"" + std::to_string(speed * c) + "\", \"" + std::to_string(speed * s) + "\"]\n";
  }
};

TEST_F(Contact, bars_bounce_without_losing_momentum) {
  const double of_one = 1000 * 0.4 * 0.5, wave = 2 / std::sqrt(1000.);
  for (const double degrees : {0., 27.}) {
    const Bars bars(degrees);
    mesh(2, Place{-1.525, -1}, Place{1.525, 1}, 0.05, degrees == 0 ? 0 : 0.2, bars.regions());
    const Result result = run(head() + body("a", "a", bars.moving(0.5)) + body("b", "b", bars.moving(-0.5)) +
                              joint("friction_angle = 20") + stage(0.2) + output);
    for (int d = 0; d < 2; ++d) EXPECT_NEAR(result.momentum[d], result.momentum_before[d], 1e-12 * of_one) << degrees;
    const auto time = result.history.column("time_s"), x = result.history.column("joint_force_x_N"),
               y = result.history.column("joint_force_y_N");
    const double noticed = 0.1 * 2 * of_one / wave;
    double impulse = 0, first = 0, last = 0;
    for (size_t k = 1; k < time.size(); ++k) {
      const double force = std::hypot(x[k], y[k]);
      impulse += force * (time[k] - time[k - 1]);
      if (force > noticed && first == 0) first = time[k - 1];
      if (force > noticed) last = time[k];
    }
    const auto kinetic = result.history.column("kinetic_J");
    const double energy = (kinetic.back() + result.value("strain_J")) / kinetic[0];
    EXPECT_LT(energy, 1.001) << degrees;
    EXPECT_GT(impulse, 1.6 * of_one) << degrees;
    if (degrees != 0) continue;  // rough surfaces lose more
    EXPECT_GT(energy, 0.9);
    EXPECT_NEAR(impulse, 2 * of_one, 0.06 * 2 * of_one);
    EXPECT_NEAR(first, 0.05, 0.01) << "they meet where their surfaces do";  // to a fifth of a cell, at 1 m/s
    EXPECT_NEAR(last - first, wave, 0.2 * wave);
  }
}

/// A block of 0.8 m x 0.4 m on ground, whose surfaces are those of cells; gravity is tilted.
std::vector<test::Region> block_on_ground() {
  return {{"a", [](const Place &x) { return x[1] < 0; }},
          {"b", [](const Place &x) { return 0.4 < x[0] && x[0] < 1.2 && x[1] < 0.4; }}};
}
std::string on_slope(double degrees) {
  const double slope = degrees * std::acos(-1.) / 180;
  return "gravity = [" + std::to_string(9.81 * std::sin(slope)) + ", " + std::to_string(-9.81 * std::cos(slope)) +
         "]\n";
}
const std::string base = "[boundary.base]\nkind = \"fixed\"\n";
const std::string follow = "[output.point.middle]\nposition = [0.8, 0.2]\n";
std::string sliding_scene(const std::string &head, const std::string &law, const std::string &stages) {
  return head + body("a", "a", "", "5e6", 0.3) + body("b", "b", "", "5e6", 0.3) + base + joint(law) + stages + output +
         follow;
}
const std::string held_first = "friction_angle = [[0, 60], [0.3, 60], [0.30001, 20]]";
std::string settled(double more) { return stage(0.3, "gravity_ramp = 0.15\ndamping = 0.7\n") + stage(more); }

TEST_F(Contact, a_block_slides_with_its_friction_and_sticks_below_it) {
  mesh(2, Place{0, -0.4}, Place{2.4, 0.6}, 0.1, 0.2, block_on_ground());
  const Result slides = run(sliding_scene(head(on_slope(30)), held_first, settled(0.4)));
  const auto v = slides.history.column("middle_velocity_m_s"), t = slides.history.column("time_s");
  const size_t from = std::ranges::lower_bound(t, 0.45) - t.begin();
  const double gained = (v.back() - v[from]) / (t.back() - t[from]);
  const double friction = (0.5 - gained / 9.81) / std::sqrt(0.75) / std::tan(std::acos(-1.) / 9);
  EXPECT_NEAR(friction, 1, 0.15) << "of a rough block, in units of Coulomb's";
  const Result sticks = run(sliding_scene(head(on_slope(15)), held_first, settled(0.4)));
  EXPECT_NEAR(sticks.value("middle_velocity_m_s"), 0, 0.01);
  EXPECT_NEAR(sticks.value("joint_friction"), std::tan(std::acos(-1.) / 12), 0.02) << "as much as holds it";
  const Result adheres = run(sliding_scene(head(on_slope(15)), "friction_angle = 0\nadhesion = 1250", settled(0.4)));
  EXPECT_NEAR(adheres.value("middle_velocity_m_s"), 0, 0.02);
}

/// Bars that touch are drawn apart: they hang together up to the strength, and part beyond it.
TEST_F(Contact, tension_is_cut_off) {
  const auto halves =
      std::vector<test::Region>{{"a", [](const Place &x) { return x[0] < 0 && std::abs(x[1]) < 0.2; }},
                                {"b", [](const Place &x) { return x[0] > 0 && x[0] < 0.8 && std::abs(x[1]) < 0.2; }}};
  mesh(2, Place{-0.6, -0.4}, Place{1.8, 0.4}, 0.1, 0., halves);
  const auto pulled = [&](const std::string &strength) {
    return run(head() + body("a", "a") + body("b", "b", "body_acceleration = [\"20 * min(1, t / 0.2)\", \"0\"]\n") +
               "[boundary.left]\nkind = \"fixed\"\n" + joint("friction_angle = 0\ntensile_strength = " + strength) +
               stage(0.3, "damping = 0.5\n") + output + "[output.point.middle]\nposition = [0.3, 0]\n");
  };
  const double weight = 1000 * 0.8 * 0.4 * 20, stress = weight / 0.4;
  const Result hangs = pulled(std::to_string(2 * stress)), parts = pulled(std::to_string(0.5 * stress));
  EXPECT_NEAR(hangs.value("joint_force_x_N"), -weight, 0.02 * weight);
  EXPECT_EQ(parts.value("joint_force_x_N"), 0);
  EXPECT_GT(parts.value("middle_displacement_x_m"), 3 * hangs.value("middle_displacement_x_m"));
}

TEST_F(Contact, bonded_groups_are_one_body) {
  mesh(2, Place{0, -0.4}, Place{1.6, 0.6}, 0.1, 0., block_on_ground());
  const auto shaken = [&](const std::string &group_b, const std::string &contact) {
    return run(head(on_slope(10)) + body("a", "a", "", "5e6", 0.3) + body("b", group_b, "", "5e6", 0.3) + base +
               contact + stage(0.2) + output + follow);
  };
  const Result one = shaken("a", ""), two = shaken("b", joint("bonded = true"));
  for (const std::string column : {"kinetic_J", "strain_J", "middle_velocity_m_s", "middle_displacement_y_m"}) {
    const auto a = one.history.column(column), b = two.history.column(column);
    const double scale = *std::ranges::max_element(a, {}, [](double x) { return std::abs(x); });
    for (size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(b[k], a[k], 1e-9 * std::abs(scale)) << column << " " << k;
  }
}

TEST_F(Contact, one_group_is_what_it_was) {
  mesh(2, Place{0, -0.4}, Place{1.6, 0.6}, 0.1, 0.2, block_on_ground());
  const auto rows = [&](const std::string &group) {
    return run(head(on_slope(30)) + body("a", group, "velocity = [\"0\", \"1\"]\n", "1e6", 0.3) +
               body("b", group, "", "1e6", 0.3) + base + stage(0.2) + output)
        .history.rows;
  };
  EXPECT_EQ(rows(""), rows("soil"));
}

/// Sliding, with a body that is thrown at the block.
std::string busy(const std::string &head) {
  return head + body("a", "a", "", "2e6", 0.3) + body("b", "b", "", "2e6", 0.3) +
         body("c", "a", "velocity = [\"-2\", \"-1\"]\n", "2e6", 0.3) + base +
         joint("friction_angle = 20\nadhesion = 100\ntensile_strength = 200");
}
std::vector<test::Region> busy_regions() {
  auto regions = block_on_ground();
  regions.push_back({"c", [](const Place &x) { return 1.4 < x[0] && x[0] < 1.8 && 0.2 < x[1] && x[1] < 0.6; }});
  return regions;
}

TEST_F(Contact, ranks_change_nothing) {
  mesh(2, Place{0, -0.4}, Place{2.4, 1}, 0.1, 0.2, busy_regions());
  const std::string stages = stage(0.2) + output;
  const auto alone = run(busy(head(on_slope(30))) + stages, {}, PETSC_COMM_SELF).history;
  for (const std::string balance : {"never", "always"}) {  // the mesh is divided anew as groups move
    const auto together = run(busy(head(on_slope(30)) + "balance_ranks = \"" + balance + "\"\n") + stages).history;
    ASSERT_EQ(alone.names, together.names);
    for (size_t k = 0; k < alone.names.size(); ++k) {
      double scale = 1e-3;
      for (const auto &row : alone.rows) scale = std::max(scale, std::abs(row[k]));
      EXPECT_NEAR(together.rows.back()[k], alone.rows.back()[k], 1e-6 * scale) << alone.names[k] << " " << balance;
    }
  }
}

TEST_F(Contact, goes_on_from_a_checkpoint_bit_for_bit) {
  mesh(2, Place{0, -0.4}, Place{2.4, 1}, 0.1, 0.2, busy_regions());
  RunOptions options;
  options.directory = file("run");
  const std::string scene = busy(head(on_slope(30)));
  run(scene + stage(0.1) + output, options);
  options.resume = true;
  const auto resumed = run(scene + stage(0.1) + stage(0.1) + output, options).history.rows.back(),
             whole = run(scene + stage(0.1) + stage(0.1) + output).history.rows.back();
  EXPECT_EQ(resumed, whole);
}

TEST_F(Contact, three_groups_in_one_place_end_the_run) {
  mesh(2, Place{0, -0.4}, Place{1.6, 0.6}, 0.1, 0.,
       {{"a", [](const Place &x) { return x[1] < 0; }},
        {"b", [](const Place &x) { return x[0] < 0.8 && x[1] < 0.4; }},
        {"c", [](const Place &x) { return x[0] > 0.8 && x[1] < 0.4; }}});
  const auto meeting = [](const std::string &a, const std::string &b) {
    return "[contact." + a + b + "]\nbetween = [\"" + a + "\", \"" + b + "\"]\nfriction_angle = 20\n";
  };
  const std::string text = head() + body("a", "a") + body("b", "b") + body("c", "c") + base + meeting("a", "b") +
                           meeting("b", "c") + meeting("a", "c") + stage(0.1) + output;
  try {
    run(text);
    FAIL() << "it ran";
  } catch (const RunError &error) {
    EXPECT_NE(std::string(error.what()).find("three contact groups meet"), std::string::npos) << error.what();
  }
}

/// A block of 0.6 m on ground in 3D, on a slope of 30 degrees that falls at 25 degrees to the cells.
TEST_F(Contact, a_block_slides_down_the_slope_in_3d) {
  mesh(3, Place{0, 0, -0.2}, Place{1.4, 1.2, 0.6}, 0.1, 0.,
       {{"a", [](const Place &x) { return x[2] < 0; }},
        {"b", [](const Place &x) { return 0.2 < x[0] && x[0] < 0.8 && 0.2 < x[1] && x[1] < 0.8 && x[2] < 0.4; }}});
  const double slope = std::acos(-1.) / 6, azimuth = 25 * std::acos(-1.) / 180, down = 9.81 * std::sin(slope);
  const std::string gravity = "dimension = 3\nup = \"z\"\ngravity = [" + std::to_string(down * std::cos(azimuth)) +
                              ", " + std::to_string(down * std::sin(azimuth)) + ", " +
                              std::to_string(-9.81 * std::cos(slope)) + "]\n";
  const Result slides = run(head(gravity) + body("a", "a", "", "5e6", 0.3) + body("b", "b", "", "5e6", 0.3) + base +
                            joint("friction_angle = [[0, 60], [0.15, 60], [0.15001, 20]]") +
                            stage(0.15, "gravity_ramp = 0.1\ndamping = 0.7\n") + stage(0.2) + output +
                            "[output.point.middle]\nposition = [0.5, 0.5, 0.2]\n");
  const auto x = slides.history.column("middle_displacement_x_m"), y = slides.history.column("middle_displacement_y_m"),
             v = slides.history.column("middle_velocity_m_s"), t = slides.history.column("time_s");
  const size_t from = std::ranges::lower_bound(t, 0.2) - t.begin();
  EXPECT_NEAR(std::atan2(y.back() - y[from], x.back() - x[from]), azimuth, 0.02);
  const double gained = (v.back() - v[from]) / (t.back() - t[from]);
  const double friction = (0.5 - gained / 9.81) / std::sqrt(0.75) / std::tan(std::acos(-1.) / 9);
  EXPECT_NEAR(friction, 1, 0.15);
}

}  // namespace
}  // namespace talus
