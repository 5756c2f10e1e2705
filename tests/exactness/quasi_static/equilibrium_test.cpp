// Equilibrium where the answer is known to round-off: patch tests, columns under weight, soil that comes and goes, and
// the scenes that are refused.
#include "solved.h"

namespace talus {
namespace {

/// A linear displacement at the surface gives the same inside, and its uniform stress.
TEST(QuasiStatic, patch_test) {
  const double lambda = 10e6 * 0.3 / (1.3 * 0.4), mu = 10e6 / 2.6;
  for (const int dim : {2, 3})
    for (const char *elements : {"quadratic", "linear", "patches"}) {
      const double g[3][3] = {{1e-3, 2e-3, -1e-3}, {0.5e-3, -2e-3, 1.5e-3}, {0.7e-3, -0.3e-3, 0.4e-3}};
      std::string velocity;
      const char axis[] = "xyz";
      for (int i = 0; i < dim; ++i) {
        velocity += std::string(i ? ", " : "[") + "\"0";
        for (int j = 0; j < dim; ++j) velocity += " + (" + std::to_string(g[i][j]) + ") * " + axis[j];
        velocity += "\"";
      }
      std::string groups = R"("base", "left", "right", "surface")";
      if (dim == 3) groups += R"(, "front", "back")";
      const Solved solved =
          solve(block + "[boundary.all]\ngroup = [" + groups + "]\nkind = \"velocity\"\nvelocity = " + velocity + "]\n",
                (dim == 3 ? in_3d : std::vector<std::string>{}) +
                    std::vector<std::string>{"quasi_static.elements=" + std::string(elements)});
      double trace = 0;
      for (int i = 0; i < dim; ++i) trace += g[i][i];
      const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
      EXPECT_LT(largest(solved, dim,
                        [&](size_t p, int i) {
                          double exact = 0;
                          for (int j = 0; j < dim; ++j) exact += g[i][j] * solved.value("position", p, j);
                          return (solved.value("displacement", p, i) - exact) / 4e-3;
                        }),
                1e-12)
          << dim << elements;
      EXPECT_LT(largest(solved, dim == 2 ? 4 : 6,
                        [&](size_t p, int k) {
                          const auto [i, j] = pairs[k];
                          const double shear = i < dim && j < dim ? mu * (g[i][j] + g[j][i]) : 0;
                          return (solved.value("stress", p, k) - shear - (i == j ? lambda * trace : 0)) / 4e4;
                        }),
                1e-12)
          << dim << elements;
    }
}

/// Along a path the loads come by shares, at the nodes that a support holds as inside: soil without stress gets its
/// weight by shares, soil that bears it keeps it, and an upward earthquake of 0.2 takes it off by shares again.
TEST(QuasiStatic, boundaries_bear_the_share_of_the_path) {
  std::string text = "gravity = 10\n" + box + "density = 2000\n[boundary.base]\nkind = \"fixed\"\n";
  for (const char *keys : {"name = \"weight\"\n", "name = \"rest\"\n", "seismic_coefficient = [0, 0.2]\n"})
    text += std::string("[[stage]]\nkind = \"quasi_static\"\nduration = 1\nload_steps = 4\n") + keys;
  const Solved solved = solve(text);
  const std::vector<double> time = solved.history.column("time_s"), force = solved.history.column("base_force_y_N");
  constexpr double weight = 2000 * 10;  // of the unit square
  ASSERT_EQ(time.size(), 13u);
  for (size_t k = 1; k < time.size(); ++k) {
    const double share = time[k] < 1 ? time[k] : time[k] < 2 ? 1 : 1 - 0.2 * (time[k] - 2);
    EXPECT_NEAR(force[k] / weight, share, 1e-9) << time[k];  // round-off of a linear solve, far above 1e-12
  }
}

/// The same on faces that are not axes, held by oblique rollers: a block that is pressed uniformly.
TEST(QuasiStatic, pressure_between_rollers) {
  for (const int dim : {2, 3}) {
    const std::string rollers = "[boundary.rollers]\ngroup = [\"base\", \"left\"" +
                                std::string(dim == 3 ? ", \"front\", \"back\"" : "") +
                                "]\nkind = \"roller\"\n[boundary.load]\ngroup = [\"surface\", \"right\"]\nkind = "
                                "\"traction\"\npressure = \"1 kPa\"\n";
    const Solved solved = solve(block + rollers, dim == 3 ? in_3d : std::vector<std::string>{});
    EXPECT_LT(largest(solved, 2, [&](size_t p, int k) { return (solved.value("stress", p, k) + 1e3) / 1e3; }), 1e-12);
    EXPECT_NEAR(solved.history.column("rollers_force_x_N").back(), 1e3, 1e-9);
  }
}

/// Weight of a column: stress is linear, displacement quadratic in depth, which elements of second order hold exactly.
TEST(QuasiStatic, column_under_its_weight) {
  const double modulus = 10e6 * 0.7 / (1.3 * 0.4), rho = 2000, g = 10;
  const std::string walls =
      "gravity = 10\n" + block + "[boundary.walls]\ngroup = [\"base\", \"left\", \"right\"]\nkind = \"roller\"\n";
  for (const int dim : {2, 3}) {
    const Solved solved = solve(
        walls, dim == 3 ? in_3d + std::vector<std::string>{"boundary.front.kind=roller", "boundary.back.kind=roller"}
                        : std::vector<std::string>{});
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        return (solved.value("stress", p, 1) + rho * g * (1 - solved.value("position", p, 1))) / 20e3;
                      }),
              1e-12);
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        const double y = solved.value("position", p, 1);
                        return (solved.value("displacement", p, 1) + rho * g / modulus * (y - y * y / 2)) /
                               (rho * g / modulus);
                      }),
              1e-12);
    EXPECT_NEAR(solved.history.column("walls_force_y_N").back(), rho * g, 1e-7);
  }
}

/// Cells of a patch share their volumetric strain, theory of finite elements (2.1), and with it the mean stress of
/// elastic soil: each value occurs at more than one point. (Their forces would be the same without.)
TEST(QuasiStatic, cells_of_a_patch_share_their_mean_stress) {
  for (const int dim : {2, 3}) {
    const Solved solved = solve(
        "gravity = 10\n" + block + "[boundary.base]\nkind = \"fixed\"\n",
        (dim == 3 ? in_3d : std::vector<std::string>{}) + std::vector<std::string>{"quasi_static.elements=patches"});
    std::vector<double> mean;
    for (size_t i = 0; i < solved.points.id.size(); ++i)
      mean.push_back(solved.value("stress", i, 0) + solved.value("stress", i, 1) + solved.value("stress", i, 2));
    std::sort(mean.begin(), mean.end());
    int alone = 0;
    for (size_t i = 0; i < mean.size(); ++i)
      alone += (i == 0 || mean[i] - mean[i - 1] > 1e-6) && (i + 1 == mean.size() || mean[i + 1] - mean[i] > 1e-6);
    EXPECT_LT(alone, 0.2 * static_cast<double>(mean.size())) << dim;  // cells that no neighbour was left for
  }
}

/// A body acceleration acts on elements as weight does.
TEST(QuasiStatic, body_acceleration_is_a_weight) {
  const Solved solved =
      solve("gravity = 0\n" + block + "[boundary.walls]\ngroup = [\"base\", \"left\", \"right\"]\nkind = \"roller\"\n",
            {"body.soil.body_acceleration=[0, -10]"});
  EXPECT_LT(largest(solved, 1,
                    [&](size_t p, int) {
                      return (solved.value("stress", p, 1) + 2000 * 10 * (1 - solved.value("position", p, 1))) / 20e3;
                    }),
            1e-12);
}

/// Level ground starts at rest with any k0, and stays there.
TEST(QuasiStatic, ground_at_rest_does_not_move) {
  const std::string text =
      "gravity = 10\n" + block +
      "initial_stress = \"k0\"\n[boundary.walls]\ngroup = [\"base\", \"left\", \"right\"]\nkind = \"roller\"\n";
  const Solved solved = solve(text, {"body.soil.k0=1.7"});
  EXPECT_LT(largest(solved, 1, [&](size_t p, int) { return solved.value("displacement", p, 1) / 1e-3; }), 1e-12);
  EXPECT_LT(largest(solved, 1,
                    [&](size_t p, int) {
                      return (solved.value("stress", p, 0) - 1.7 * solved.value("stress", p, 1)) / 20e3;
                    }),
            1e-12);
}

/// Soil taken away unloads what is left, soil put back loads it again: each state is that of a column of the height it
/// has.
TEST(QuasiStatic, excavation_and_fill) {
  const std::string layer =
      "density = 2000\nlaw = \"linear_elastic\"\nyoung_modulus = \"10 MPa\"\npoisson_ratio = 0.3\n";
  const std::string text =
      "gravity = 10\n[mesh]\nsection = \"" + std::string(TALUS_LAYERS) +
      "\"\nsize = 0.25\n[body.lower]\nregion = \"lower\"\n" + layer + "[body.upper]\nregion = \"upper\"\n" + layer +
      "[boundary.walls]\ngroup = [\"base\", \"left\", \"right\"]\nkind = \"roller\"\n"
      "[[stage]]\nname = \"gravity\"\nkind = \"quasi_static\"\nduration = 1\n"
      "[[stage]]\nname = \"excavation\"\nkind = \"quasi_static\"\nduration = 1\nremove = \"upper\"\n";
  const double modulus = 10e6 * 0.7 / (1.3 * 0.4), rho = 2000, g = 10;
  const Solved dug = solve(text);
  EXPECT_LT(largest(dug, 1,
                    [&](size_t p, int) {
                      return (dug.value("stress", p, 1) + rho * g * (0.5 - dug.value("position", p, 1))) / 20e3;
                    }),
            1e-12);
  EXPECT_LT(largest(dug, 1,
                    [&](size_t p, int) {
                      const double y = dug.value("position", p, 1);
                      return (dug.value("displacement", p, 1) + rho * g / modulus * (y / 2 - y * y / 2)) /
                             (rho * g / modulus);
                    }),
            1e-12);
  EXPECT_NEAR(dug.history.column("mass_kg").back(), 1000, 1e-9);
  const Solved filled =
      solve(text + "[[stage]]\nname = \"fill\"\nkind = \"quasi_static\"\nduration = 1\nadd = \"upper\"\n",
            {"stage.1.remove=[]"});
  EXPECT_LT(largest(filled, 1,
                    [&](size_t p, int) {
                      return (filled.value("stress", p, 1) + rho * g * (1 - filled.value("position", p, 1))) / 20e3;
                    }),
            1e-12);
  EXPECT_NEAR(filled.history.column("mass_kg").back(), 2000, 1e-9);
}

/// A point has values while its body is there.
TEST(QuasiStatic, points_have_no_values_without_soil) {
  const std::string layer =
      "density = 2000\nlaw = \"linear_elastic\"\nyoung_modulus = \"10 MPa\"\npoisson_ratio = 0.3\n";
  const auto stage = [](const std::string &name, const std::string &key) {
    return "[[stage]]\nname = \"" + name + "\"\nkind = \"quasi_static\"\nduration = 1\n" + key;
  };
  const Solved built = solve(
      "gravity = 10\n[mesh]\nsection = \"" + std::string(TALUS_LAYERS) +
      "\"\nsize = 0.25\n[body.lower]\nregion = \"lower\"\n" + layer + "[body.upper]\nregion = \"upper\"\n" + layer +
      "[boundary.walls]\ngroup = [\"base\", \"left\", \"right\"]\nkind = \"roller\"\n"
      "[output.point.top]\nposition = [0.5, 0.9]\n" +
      stage("gravity", "") + stage("fill", "add = \"upper\"\n") + stage("cut", "remove = \"upper\"\n"));
  const std::vector<double> time = built.history.column("time_s"), moved = built.history.column("top_displacement_m");
  ASSERT_FALSE(time.empty());
  for (std::size_t k = 0; k < time.size(); ++k)
    EXPECT_EQ(std::isnan(moved[k]), time[k] <= 1 || time[k] > 2) << "at t = " << time[k] << " s: " << moved[k];
}

/// One element across a layer is too few for elements of first order.
TEST(QuasiStatic, one_element_across_is_refused) {
  try {
    solve("gravity = 10\n" + block + "[boundary.base]\nkind = \"fixed\"\n",
          {"mesh.section=" + std::string(TALUS_THIN_LAYER), "mesh.size=3", "quasi_static.elements=linear"});
    ADD_FAILURE();
  } catch (const RunError &error) {
    EXPECT_NE(std::string(error.what()).find("body.soil is one element across"), std::string::npos) << error.what();
  }
}

/// Soil that a support does not hold as a whole is found before the stiffness is factorised.
TEST(QuasiStatic, soil_without_support_is_refused) {
  for (const auto &[supports, words] : {std::pair{"[boundary.base]\nkind = \"roller\"\n", "along x"},
                                        {"[boundary.left]\nkind = \"roller\"\n", "along y"}})
    try {
      solve("gravity = 10\n" + block + supports);
      ADD_FAILURE() << supports;
    } catch (const RunError &error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace talus
