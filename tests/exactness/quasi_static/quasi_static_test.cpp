// Finite elements where the answer is known to round-off: patch tests, columns under weight, soil that comes and goes,
// the same on any number of ranks and by any linear solver. Solutions that the elements hold exactly are right to the
// round-off of a linear solve: 1e-12 of the largest value is asked for, a thousand times a double's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/reader.h"
#include "simulation.h"

namespace talus {
namespace {

const std::string meshes = TALUS_MESHES;

struct Solved {
  Snapshot points;  ///< Gauss points of this rank
  HistoryTable history;
  std::vector<Event> events;

  const Column &column(const std::string &name) const {
    return *std::find_if(points.columns.begin(), points.columns.end(), [&](const Column &c) { return c.name == name; });
  }
  double value(const std::string &name, size_t i, int k = 0) const {
    const Column &c = column(name);
    return c.values[i * c.components + k];
  }
};

Solved solve(const std::string &text, const std::vector<std::string> &overrides = {},
             MPI_Comm comm = PETSC_COMM_WORLD) {
  Scene scene = parse_scene(text, meshes + "/scene.toml", overrides);
  RunOptions options;
  options.pictures = options.screen = false, options.gauss_points = true;
  const auto simulation = make_simulation(comm, scene, options);
  simulation->run();
  return {simulation->snapshot(), simulation->history(), simulation->events()};
}

/// Largest |error(i, k)| over the Gauss points of all ranks.
template <class Error>
double largest(const Solved &solved, int components, Error &&error) {
  double most = 0;
  for (size_t i = 0; i < solved.points.id.size(); ++i)
    for (int k = 0; k < components; ++k) most = std::max(most, std::abs(error(i, k)));
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  return most;
}

const std::string block = R"(
[mesh]
section = "box.csv"
size = 0.3
[body.soil]
region = "soil"
density = 2000
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
[[stage]]
name = "load"
kind = "quasi_static"
duration = 1
load_steps = 1
)";
const std::vector<std::string> in_3d{"dimension=3", "mesh.thickness=1", "mesh.layers=0", "mesh.size=0.45"};
std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string> &b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

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

/// Where equilibrium ends the next stage goes on with motion, from the last state and loads that had one.
TEST(QuasiStatic, motion_takes_over_where_equilibrium_is_lost) {
  const std::string text = block +
                           "when_lost = \"next_stage\"\n[boundary.base]\nkind = \"fixed\"\n[boundary.surface]\nkind = "
                           "\"traction\"\npressure = \"60e3 * t\"\n"
                           "[[stage]]\nname = \"fall\"\nduration = 0.03\n[output.point.corner]\nposition = [1, 1]\n";
  const Solved solved = solve(text, {"body.soil.law=mohr_coulomb", "body.soil.cohesion=10000",
                                     "body.soil.friction_angle=0", "stage.0.load_steps=10"});
  const auto time = solved.history.column("load_time_s"), speed = solved.history.column("corner_velocity_m_s");
  ASSERT_FALSE(solved.events.empty());
  EXPECT_NE(solved.events[0].text.find("no equilibrium beyond"), std::string::npos) << solved.events[0].text;
  EXPECT_GT(solved.events[0].load_time,
            20e3 / 60e3 - 1e-3);  // 2 c is the least that a block can bear, found to the smallest step
  EXPECT_LT(solved.events[0].load_time, 30e3 / 60e3);
  EXPECT_GT(speed.back(), 0);
}

/// Particles to Gauss points and back: what rests is still in equilibrium.
TEST(QuasiStatic, stress_comes_back_from_particles) {
  const std::string text =
      "gravity = 10\n" + block +
      "reset_displacement = true\n[boundary.base]\nkind = \"fixed\"\n[[stage]]\nname = \"rest\"\nduration = 0.05\n"
      "[[stage]]\nname = \"again\"\nkind = \"quasi_static\"\nduration = 1\n";
  const Solved solved = solve(text, {"quasi_static.elements=patches", "quasi_static.tolerance=1e-12"});
  EXPECT_LT(largest(solved, 2, [&](size_t p, int k) { return solved.value("displacement", p, k) / 1e-3; }),
            1e-9);  // of what gravity moved it
}

/// Linear solver and number of ranks change nothing but round-off, in plastic soil either.
TEST(QuasiStatic, slope_is_the_same_on_all_ranks_and_by_both_solvers) {
  const std::string text = R"(gravity = 10
[mesh]
section = "selborne.csv"
size = 3
[body.soil]
region = ["weathered", "unweathered"]
density = 2000
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = "14 kPa"
friction_angle = 20
[boundary.base]
group = ["base", "recharge_base"]
kind = "fixed"
[boundary.sides]
group = ["left", "recharge_side", "right"]
kind = "roller"
[[stage]]
name = "gravity"
kind = "quasi_static"
duration = 1
load_steps = 3
[quasi_static]
tolerance = 1e-11
)";
  int rank, ranks;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank), MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  Solved whole;
  for (int r = 0; r < ranks; ++r) {  // one after the other: they share the file of the mesh
    if (r == rank) whole = solve(text, {}, PETSC_COMM_SELF);
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  std::map<long long, size_t> place;
  for (size_t i = 0; i < whole.points.id.size(); ++i) place[whole.points.id[i]] = i;
  EXPECT_GT(
      *std::max_element(whole.column("plastic_strain").values.begin(), whole.column("plastic_strain").values.end()),
      1e-4);
  for (const char *solver : {"direct", "iterative"}) {
    const Solved shared = solve(text, {"quasi_static.linear_solver=" + std::string(solver)});
    EXPECT_LT(largest(shared, 2,
                      [&](size_t p, int k) {
                        return (shared.value("displacement", p, k) -
                                whole.value("displacement", place.at(shared.points.id[p]), k)) /
                               0.1;
                      }),
              1e-8)
        << solver;
  }
}

/// What a scene says to PETSc while it lives.
struct Options {
  explicit Options(const char *text) { PetscOptionsInsertString(nullptr, text); }
  ~Options() { PetscOptionsClear(nullptr); }
};

/// A body too large for LU goes by multigrid, and the log says so; PETSc's options have the last word.
TEST(QuasiStatic, linear_solver_follows_size_and_options) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const std::string column =
      "gravity = 10\n" + block +
      "[boundary.walls]\ngroup = [\"base\", \"left\", \"right\", \"front\", \"back\"]\nkind = \"roller\"\n";
  const double modulus = 10e6 * 0.7 / (1.3 * 0.4);
  const auto settles = [&](const Solved &solved) {
    return largest(solved, 1, [&](size_t p, int) {
      const double y = solved.value("position", p, 1);
      return (solved.value("displacement", p, 1) + 2e4 / modulus * (y - y * y / 2)) / (2e4 / modulus);
    });
  };
  const Solved small = solve(column, in_3d);
  EXPECT_NE(small.events.at(0).text.find("(LU)"), std::string::npos) << small.events[0].text;
  for (const char *options : {"-talus_ksp_type cg -talus_pc_type hypre -talus_ksp_rtol 1e-12",
                              "-talus_ksp_type gmres -talus_pc_type gamg -talus_ksp_rtol 1e-12"}) {
    const Options given(options);
    EXPECT_LT(settles(solve(column, in_3d)), 1e-8) << options;  // the tolerance of Newton
  }
  {
    const Options given("-talus_ksp_type richardson -talus_pc_type none -talus_ksp_max_it 1");
    EXPECT_THROW(solve(column, in_3d), RunError) << "a solver that cannot";
  }
  if (ranks > 1) return;  // once is enough for so large a body
  const Solved large = solve(column, {"dimension=3", "mesh.thickness=1", "mesh.layers=0", "mesh.size=0.08"});
  EXPECT_NE(large.events.at(0).text.find("(GMRES and multigrid)"), std::string::npos) << large.events[0].text;
  EXPECT_LT(settles(large), 1e-7);  // ten times the tolerance of Newton and GMRES
}

/// What a stage hands over does not depend on ranks: stress of the particles, and the motion that goes on from it.
TEST(QuasiStatic, hand_over_is_the_same_on_all_ranks) {
  const std::string text =
      "gravity = 10\n" + block +
      "reset_displacement = true\n[boundary.base]\nkind = \"fixed\"\n[boundary.left]\nkind = \"non_reflecting\"\n"
      "[[stage]]\nname = \"load\"\nduration = 0.02\n[[stage]]\nname = \"again\"\nkind = \"quasi_static\"\nduration = "
      "1\n"
      "[[stage]]\nname = \"motion\"\nduration = 0.02\n[boundary.right]\nkind = \"traction\"\npressure = \"200 * t\"\n";
  const std::vector<std::string> keys{"quasi_static.elements=patches", "quasi_static.tolerance=1e-12",
                                      "body.soil.law=mohr_coulomb", "body.soil.cohesion=6000",
                                      "body.soil.friction_angle=10"};
  const auto run = [&](MPI_Comm comm) {
    Scene scene = parse_scene(text, meshes + "/scene.toml", keys);
    RunOptions options;
    options.pictures = options.screen = false;
    const auto simulation = make_simulation(comm, scene, options);
    simulation->run();
    return Solved{simulation->snapshot(), simulation->history(), simulation->events()};
  };
  int rank, ranks;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank), MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  Solved whole;
  for (int r = 0; r < ranks; ++r) {  // one after the other: they share the file of the mesh
    if (r == rank) whole = run(PETSC_COMM_SELF);
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  std::map<long long, size_t> place;
  for (size_t i = 0; i < whole.points.id.size(); ++i) place[whole.points.id[i]] = i;
  const Solved shared = run(PETSC_COMM_WORLD);
  const auto differs = [&](const char *field, int components, double scale) {
    return largest(shared, components, [&](size_t p, int k) {
      return (shared.value(field, p, k) - whole.value(field, place.at(shared.points.id[p]), k)) / scale;
    });
  };
  EXPECT_LT(differs("stress", 4, 2e4), 1e-9);         // Newton's tolerance, a thousand times
  EXPECT_LT(differs("displacement", 2, 1e-3), 1e-9);  // of what gravity moved it
  EXPECT_LT(differs("velocity", 2, 1e-2), 1e-9);
}

/// A face that swallows waves bears in a quasi-static stage what its `support` bears, and goes on to do so as a dead
/// load: a column between such faces settles as between rollers and then keeps still.
TEST(QuasiStatic, non_reflecting_faces_hold) {
  const std::string text = "gravity = 10\n" + block +
                           "reset_displacement = true\n[boundary.base]\nkind = \"fixed\"\n[boundary.sides]\ngroup = "
                           "[\"left\", \"right\"]\nkind = \"non_reflecting\"\n";
  const std::vector<std::string> keys{"quasi_static.elements=patches", "quasi_static.tolerance=1e-12"};
  const Solved column = solve(text, keys),
               between_rollers = solve(text, keys + std::vector<std::string>{"boundary.sides.kind=roller"});
  EXPECT_LT(largest(column, 4,
                    [&](size_t p, int k) {
                      return (column.value("stress", p, k) - between_rollers.value("stress", p, k)) / 2e4;
                    }),
            1e-12);
  const Solved moved =
      solve(text + "[[stage]]\nname = \"rest\"\nduration = 1\n[output.point.top]\nposition = [0.5, 1]\n", keys);
  const auto way = moved.history.column("top_displacement_m"), speed = moved.history.column("top_velocity_m_s"),
             push = moved.history.column("sides_force_x_N");
  EXPECT_LT(*std::max_element(way.end() - 100, way.end()), 1e-9);      // gravity moved it by 0.7 mm
  EXPECT_LT(*std::max_element(speed.end() - 100, speed.end()), 1e-9);  // sound goes at 80 m/s
  const Solved free = solve(text, keys + std::vector<std::string>{"boundary.sides.support=none"});
  EXPECT_GT(largest(free, 1,
                    [&](size_t p, int) { return (free.value("stress", p, 0) - column.value("stress", p, 0)) / 2e4; }),
            0.1)
      << "nothing holds it then";
}

const std::string wet_block = R"(
gravity = 10
phases = "saturated"
[mesh]
section = "box.csv"
size = 0.3
[water]
table = [[0, 0.5]]
bulk_modulus = "100 GPa"
[body.soil]
region = "soil"
porosity = 0.3
grain_density = 2600
permeability = 1e-12
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0.3
[boundary.walls]
group = ["base", "left", "right"]
kind = "roller"
)";

/// Full pores, open to the atmosphere above: whatever the pressure was, it becomes that of water at rest, and no force
/// acts on particles that take it over but their weight under water.
TEST(Water, comes_to_rest_and_stays) {
  const std::string text = wet_block +
                           "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n"
                           "[[stage]]\nname = \"soil\"\nkind = \"quasi_static\"\nduration = 1\n";
  for (const int dim : {2, 3}) {
    const Solved solved = solve(text, std::vector<std::string>{"quasi_static.tolerance=1e-8"} +
                                          (dim == 3 ? in_3d + std::vector<std::string>{"boundary.front.kind=roller",
                                                                                       "boundary.back.kind=roller"}
                                                    : std::vector<std::string>{}));
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        return solved.value("pore_pressure", p) / 1e4 - (1 - solved.value("position", p, 1));
                      }),
              1e-6);  // a hundred times the tolerance, which is above the round-off of so slow a flux, 4e-10
    const double weight = 10 * (0.7 * 2600 - 0.7 * 1000);  // of the grains less that of the water they displace
    EXPECT_LT(largest(solved, 1,
                      [&](size_t p, int) {
                        return solved.value("stress", p, 1) / weight + (1 - solved.value("position", p, 1));
                      }),
              1e-6);
  }
}

/// In a drained scene seepage finds the pressure of the stages after it: through a confined block it falls linearly,
/// soil bears its gradient as in a saturated scene, and particles that take over keep still.
TEST(Water, seeps_through_drained_soil) {
  const std::string text =
      wet_block +
      "[boundary.in]\ngroup = \"left\"\nkind = \"pore_pressure\"\npressure = 8e3\n[boundary.out]\ngroup = "
      "\"right\"\nkind = \"pore_pressure\"\n"
      "[boundary.lid]\ngroup = [\"base\", \"surface\"]\nkind = \"impermeable\"\n"
      "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n"
      "[[stage]]\nname = \"soil\"\nkind = \"quasi_static\"\nduration = 1\nreset_displacement = true\n";
  const std::vector<std::string> keys{"phases=drained",
                                      "gravity=0",
                                      "water.table=[]",
                                      "water.open_water_load=false",
                                      "quasi_static.elements=patches",
                                      "quasi_static.tolerance=1e-8",
                                      "boundary.walls.kind=fixed",
                                      "boundary.walls.group=base"};
  for (const int dim : {2, 3}) {
    const Solved drained =
        solve(text, keys + (dim == 3 ? in_3d +
                                           std::vector<std::string>{
                                               "boundary.lid.group=[\"base\", \"surface\", \"front\", \"back\"]"}
                                     : std::vector<std::string>{}));
    EXPECT_LT(largest(drained, 1,
                      [&](size_t p, int) {
                        return drained.value("pore_pressure", p) / 8e3 - (1 - drained.value("position", p, 0));
                      }),
              1e-9)
        << dim;
  }
  const Solved iterative = solve(text, keys + std::vector<std::string>{"quasi_static.linear_solver=iterative"});
  EXPECT_LT(largest(iterative, 1,
                    [&](size_t p, int) {
                      return iterative.value("pore_pressure", p) / 8e3 - (1 - iterative.value("position", p, 0));
                    }),
            1e-7);  // ten times Newton's tolerance
  const std::vector<std::string> fine =
      keys + std::vector<std::string>{"quasi_static.elements=quadratic"};  // patches average pressure in another way
  const Solved given = solve(text, fine), moving = solve(text, fine + std::vector<std::string>{"phases=saturated"});
  EXPECT_LT(
      largest(given, 4,
              [&](size_t p, int k) { return (given.value("stress", p, k) - moving.value("stress", p, k)) / 8e3; }),
      1e-6);
  EXPECT_GT(largest(given, 1, [&](size_t p, int) { return given.value("stress", p, 0) / 8e3; }), 0.1);
  const Solved moved =
      solve(text + "[[stage]]\nname = \"rest\"\nduration = 0.5\n[output.point.top]\nposition = [0.5, 1]\n", keys);
  const auto way = moved.history.column("top_displacement_m");
  EXPECT_LT(*std::max_element(way.end() - 50, way.end()), 1e-9);
}

/// Water that rises by seepage makes a drained column lighter: effective stress follows the table where it stands, in
/// static stages and at the particles.
TEST(Water, rises_in_drained_soil) {
  const std::string text =
      wet_block +
      "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = \"1 kPa\"\nshape = 0.5\n"
      "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.5\n"
      "[boundary.well]\ngroup = \"base\"\nkind = \"pore_pressure\"\npressure = \"min(9e3, 4e3 + t)\"\n"
      "[[stage]]\nname = \"before\"\nkind = \"quasi_static\"\nduration = 1\nhold_loads = true\n"
      "[[stage]]\nname = \"rise\"\nkind = \"seepage\"\nduration = 1e6\n"
      "[[stage]]\nname = \"after\"\nkind = \"quasi_static\"\nduration = 1\nhold_loads = true\nreset_displacement = "
      "true\n"
      "[[stage]]\nname = \"rest\"\nduration = 0.5\n[output.point.foot]\nposition = [0.5, "
      "0.02]\n[output.point.top]\nposition = [0.5, 1]\n";
  const std::vector<std::string> keys{"phases=drained", "water.table=[[0, 0.4]]", "output.history_interval=0.005",
                                      "quasi_static.elements=patches", "quasi_static.tolerance=1e-8"};
  Scene scene = parse_scene(text, meshes + "/scene.toml", keys);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  const auto pressure = simulation->history().column("foot_pore_pressure_Pa"),
             way = simulation->history().column("top_displacement_m");
  EXPECT_NEAR(pressure.front(), 4e3, 1e3);  // the point is near the base, not at it
  EXPECT_NEAR(pressure.back() - pressure.front(), 5e3,
              5e3 * 1e-3);  // hydrostatic at last: time is a thousand times that of the flow
  EXPECT_LT(*std::max_element(way.end() - 50, way.end()), 1e-7);
}

/// What consolidation has pressed out when it is over is what the soil has lost in volume.
TEST(Water, leaves_as_the_soil_settles) {
  const std::string text = wet_block +
                           "[boundary.surface]\nkind = \"traction\"\npressure = \"1 kPa\"\n[boundary.drain]\ngroup = "
                           "\"surface\"\nkind = \"pore_pressure\"\n"
                           "[[stage]]\nname = \"press\"\nkind = \"consolidation\"\nduration = 500\n";
  const Solved solved = solve(text, {"gravity=0", "water.table=[]"});
  const auto time = solved.history.column("time_s"), inflow = solved.history.column("drain_inflow_m3_s"),
             way = solved.history.column("surface_displacement_y_m");
  double water = 0;
  for (size_t i = 1; i < time.size(); ++i) water += (time[i] - time[i - 1]) * inflow[i];
  EXPECT_LT(way.back(), -1e-5);
  EXPECT_NEAR(water, way.back(), 1e-6 * std::abs(way.back()));
}

/// A linear pressure passes from nodes to particles as it is.
TEST(Water, is_handed_to_particles) {
  Scene scene = parse_scene(wet_block +
                                "[boundary.top]\ngroup = \"surface\"\nkind = \"pore_pressure\"\npressure = 7e3\n"
                                "[[stage]]\nname = \"water\"\nkind = \"seepage\"\nsteady = true\nduration = 1\n",
                            meshes + "/scene.toml", {"water.bulk_modulus=2.2e9"});
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  const Snapshot end = simulation->snapshot();
  std::map<long long, std::array<double, 2>> cells;  // sums over the three particles of a cell
  Solved particles{end, simulation->history(), simulation->events()};
  for (size_t i = 0; i < end.id.size(); ++i) {
    auto &cell = cells[end.id[i] / 3];
    cell[0] += particles.value("pore_pressure", i) / 3,
        cell[1] += (7e3 + 1e4 * (1 - particles.value("position", i, 1))) / 3;
  }
  for (const auto &[id, cell] : cells) EXPECT_NEAR(cell[0], cell[1], 1e-5 * cell[1]);
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

// ---- factor of safety ----

struct Reduced {
  FactorOfSafety factor;
  std::vector<Event> events;
};
Reduced reduce(const std::string &text, const std::vector<std::string> &overrides = {}) {
  Scene scene = parse_scene(text, meshes + "/scene.toml", overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const FactorOfSafety factor = simulation->factor_of_safety();
  return {factor, simulation->events()};
}

/// The law, and why its strength cannot be divided, before anything is solved.
TEST(FactorOfSafety, refuses_laws_without_strength_to_divide) {
  using Words = std::vector<std::string>;
  for (const Words &overrides :
       {Words{"body.soil.law=linear_elastic"}, Words{"body.soil.law=newtonian", "body.soil.viscosity=1"},
        Words{"body.soil.law=bingham", "body.soil.viscosity=1", "body.soil.yield_stress=1000"},
        Words{"body.soil.law=mu_i", "body.soil.static_friction=0.4", "body.soil.limiting_friction=0.6",
              "body.soil.grain_size=0.001"}}) {
    const std::string law = overrides[0].substr(overrides[0].find('=') + 1);
    try {
      reduce(block + "[boundary.base]\nkind = \"fixed\"\n", overrides);
      ADD_FAILURE() << law;
    } catch (const std::invalid_argument &error) {
      const std::string said = error.what();
      EXPECT_NE(said.find("body.soil.law"), std::string::npos) << said;
      EXPECT_NE(said.find("but " + law + " "), std::string::npos) << said;
    }
  }
}

/// A cut of clay on elastic rock: the clay fails, and the log says that the rock was left as it is.
TEST(FactorOfSafety, leaves_elastic_soil_beside_other_soil_as_it_is) {
  const std::string layer = "density = 2000\nyoung_modulus = \"10 MPa\"\npoisson_ratio = 0.3\n";
  const Reduced cut = reduce("gravity = 10\n[mesh]\nsection = \"" + std::string(TALUS_LAYERS) +
                             "\"\nsize = 0.25\n[body.rock]\nregion = \"lower\"\nlaw = \"linear_elastic\"\n" + layer +
                             "[body.clay]\nregion = \"upper\"\nlaw = \"mohr_coulomb\"\nfriction_angle = 0\n"
                             "cohesion = \"4 kPa\"\n" +
                             layer +
                             "[boundary.base]\nkind = \"fixed\"\n[boundary.left]\nkind = \"roller\"\n"
                             "[[stage]]\nname = \"gravity\"\nkind = \"quasi_static\"\nduration = 1\n");
  // 3.77 c / (rho g h) of a vertical cut, h = 0.5 m; four cells over its height are stiffer
  EXPECT_GT(cut.factor.value(), 1.4);
  EXPECT_LT(cut.factor.value(), 1.9);
  const auto says = [](const Event &event) {
    return event.text.find("body.rock is not reduced: linear_elastic is elastic") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(cut.events.begin(), cut.events.end(), says), 1);
}

}  // namespace
}  // namespace talus
