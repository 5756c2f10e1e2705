// Anchors, nails and geogrids in finite elements, where the answer is known.
#include "solved.h"

namespace talus {
namespace {

/// A square of soil that is stretched by a thousandth along x in a second.
const std::string stretched = box + R"(density = 2000
[boundary.all]
group = ["base", "left", "right", "surface"]
kind = "velocity"
velocity = ["1e-3 * x", "0"]
[[stage]]
name = "stretch"
kind = "quasi_static"
duration = 1
load_steps = 4
)";

/// Keys of a bar that is so soft that the soil does not feel it.
std::string bar(const std::string &kind, const std::string &more) {
  return "[structure.bar]\nkind = \"" + kind + "\"\npoints = [[0.1, 0.43], [0.9, 0.43]]\n" + more;
}

double last(const Solved &solved, const std::string &column) { return solved.history.column("bar_" + column).back(); }

/// The bond of an anchor bears its strength times its length, per bar, whatever the spacing.
TEST(Bars, pulls_out_with_its_bond_times_length) {
  for (const double spacing : {1., 2.5}) {
    const Solved solved =
        solve(stretched + bar("anchor", "spacing = " + std::to_string(spacing) +
                                            "\naxial_stiffness = 1e6\ntensile_capacity = 1e6\nfree_length = 0.3\n"
                                            "bond_strength = 40\n"));
    EXPECT_NEAR(last(solved, "head_force_N") / (0.5 * 40), 1, 1e-6);
    EXPECT_NEAR(last(solved, "slipping"), 1, 1e-12);
  }
}

/// Adhesion and friction on the perimeter, under the mean stress across the bar, which is that of plane strain.
TEST(Bars, friction_follows_the_stress_around) {
  const double lambda = 10e6 * 0.3 / (1.3 * 0.4);
  const Solved solved =
      solve(stretched + bar("anchor",
                            "spacing = 1\naxial_stiffness = 1e6\ntensile_capacity = 1e6\nfree_length = 0.3\n"
                            "diameter = 1e-3\nbond_adhesion = 10\nbond_friction_angle = 20\n"),
            {"boundary.all.velocity=['1e-4 * x', '-1e-3 * y']"});
  const double mu = 10e6 / 2.6, yy = lambda * (1e-4 - 1e-3) + 2 * mu * -1e-3, zz = lambda * (1e-4 - 1e-3);
  const double bond =
      3.14159265358979323846 * 1e-3 * (10 - (yy + zz) / 2 * std::tan(20 * 3.14159265358979323846 / 180));
  EXPECT_NEAR(last(solved, "head_force_N") / (0.5 * bond), 1, 1e-3);  // it presses the soil a little
}

/// A bar that is held along all of its length stretches with the soil, at any inclination and in both dimensions.
TEST(Bars, stretches_with_the_soil) {
  for (const int dim : {2, 3}) {
    const std::string ends = dim == 2 ? "[[0.2, 0.1], [0.8, 0.7]]" : "[[0.2, 0.1, 0.3], [0.8, 0.7, 0.3]]";
    const Solved solved =
        solve(stretched + bar("nail", std::string(dim == 2 ? "spacing = 2\n" : "") +
                                          "axial_stiffness = 1\ntensile_capacity = 1e6\nbond_strength = 1e9\n"
                                          "bond_stiffness = 1e9\nplate_capacity = 1e6\n"),
              (dim == 3 ? in_3d + std::vector<std::string>{"boundary.all.group=['base', 'left', 'right', 'surface', "
                                                           "'front', 'back']",
                                                           "boundary.all.velocity=['1e-3 * x', '0', '0']"}
                        : std::vector<std::string>{}) +
                  std::vector<std::string>{"structure.bar.points=" + ends});
    EXPECT_NEAR(last(solved, "axial_force_N") / (1 * 1e-3 / 2), 1, 1e-4) << dim;
  }
}

/// In the stage that installs an anchor its force is the prestress; later it goes with the soil, and a geogrid bears
/// no pressure.
TEST(Bars, prestress_is_that_of_the_stage_that_installs) {
  const std::string text = block + "[boundary.base]\nkind = \"fixed\"\n" +
                           "[[stage]]\nname = \"anchor\"\nkind = \"quasi_static\"\nduration = 1\nadd = \"bar\"\n"
                           "[[stage]]\nname = \"rest\"\nkind = \"quasi_static\"\nduration = 1\n" +
                           "[[stage]]\nname = \"load\"\nkind = \"quasi_static\"\nduration = 1\n" +
                           "[boundary.surface]\nkind = \"traction\"\npressure = [[0, 0], [3, 0], [4, 1e5]]\n" +
                           bar("anchor",
                               "spacing = 1\naxial_stiffness = 1e7\ntensile_capacity = 1e6\nfree_length = 0.3\n"
                               "bond_strength = 1e6\nprestress = 1000\n");
  const Solved solved = solve(text, {"structure.bar.points=[[0.5, 1], [0.5, 0.2]]"});
  const std::vector<double> time = solved.history.column("time_s"), force = solved.history.column("bar_head_force_N");
  for (size_t k = 0; k < time.size(); ++k)
    if (time[k] <= 3) {
      EXPECT_NEAR(force[k], time[k] <= 1 ? 0 : 1000, 1e-3) << time[k];
    }
  EXPECT_LT(force.back(), 900);  // the load presses the soil together
}

/// What an anchor takes from the soil it gives back when it is removed.
TEST(Bars, elastic_soil_springs_back_when_they_go) {
  const Solved solved =
      solve(block + "[boundary.base]\nkind = \"fixed\"\n" +
                "[[stage]]\nname = \"pull\"\nkind = \"quasi_static\"\nduration = 1\nadd = \"bar\"\n"
                "[[stage]]\nname = \"go\"\nkind = \"quasi_static\"\nduration = 1\nremove = \"bar\"\n" +
                bar("anchor",
                    "spacing = 1\naxial_stiffness = 1e7\ntensile_capacity = 1e6\nfree_length = 0.3\n"
                    "bond_strength = 1e6\nprestress = 1e5\n"),
            {"structure.bar.points=[[0.5, 1], [0.5, 0.2]]", "output.point.head.position=[0.5, 0.99]"});
  const std::vector<double> moved = solved.history.column("head_displacement_m");
  EXPECT_GT(*std::max_element(moved.begin(), moved.end()), 1e-4);
  EXPECT_LT(moved.back(), 1e-9);
  EXPECT_EQ(last(solved, "head_force_N"), 0);
}

TEST(Bars, geogrids_bear_no_pressure_and_remember_their_slack) {
  const std::string grid = "axial_stiffness = 1e3\ntensile_capacity = 1e6\nbond_adhesion = 1e9\nbond_stiffness = 1e9\n";
  const Solved solved =
      solve(stretched + bar("geogrid", grid), {"boundary.all.velocity=['-1e-3 * x * sin(3.14159265358979 * t)', '0']",
                                               "stage.stretch.duration=2", "stage.stretch.load_steps=16"});
  for (const double force : solved.history.column("bar_axial_force_N")) EXPECT_GE(force, 0);
  EXPECT_NEAR(last(solved, "axial_force_N"), 0, 1e-3);  // back where it was, and it was never longer
}

/// The force on the soil is in equilibrium: what supports bear does not change.
TEST(Bars, give_the_soil_no_force_as_a_whole) {
  const Solved solved = solve("gravity = 10\n" + block + "[boundary.base]\nkind = \"fixed\"\n" +
                              bar("anchor",
                                  "spacing = 1\naxial_stiffness = 1e8\ntensile_capacity = 1e6\nfree_length = 0.3\n"
                                  "bond_strength = 1e6\n"));
  EXPECT_NEAR(solved.history.column("base_force_y_N").back() / 20e3, 1, 1e-9);
  EXPECT_NEAR(solved.history.column("base_force_x_N").back() / 20e3, 0, 1e-9);
}

/// A bar that yields too far tears, and the soil goes on without it.
TEST(Bars, tears_beyond_its_rupture_strain) {
  const std::string keys =
      "spacing = 1\naxial_stiffness = 1e6\ntensile_capacity = 200\nfree_length = 0.3\n"
      "bond_strength = 1e6\n";
  EXPECT_NEAR(last(solve(stretched + bar("anchor", keys)), "head_force_N"), 200, 1e-6);
  EXPECT_EQ(last(solve(stretched + bar("anchor", keys + "rupture_strain = 5e-4\n")), "head_force_N"), 0);
  EXPECT_GT(last(solve(stretched + bar("anchor", keys + "rupture_strain = 2e-3\n")), "head_force_N"), 0);
}

TEST(Bars, all_ranks_give_the_same) {
  const std::string text = "gravity = 10\n" + block + "[boundary.base]\nkind = \"fixed\"\n" +
                           bar("nail",
                               "spacing = 1\naxial_stiffness = 1e7\ntensile_capacity = 1e6\ndiameter = 0.1\n"
                               "bond_adhesion = 100\nbond_friction_angle = 20\ncompressive_capacity = 1e6\n");
  const std::vector<std::string> set{"structure.bar.points=[[0.05, 0.9], [0.93, 0.13]]", "stage.load.load_steps=3"};
  const Solved together = solve(text, set), alone = solve(text, set, PETSC_COMM_SELF);
  for (const char *column : {"axial_force_N", "bond_slip_m", "slipping"})
    EXPECT_NEAR(last(together, column), last(alone, column), 1e-9 * (1e-3 + std::abs(last(alone, column)))) << column;
  EXPECT_LT(last(alone, "axial_force_N"), -1);
}

}  // namespace
}  // namespace talus
