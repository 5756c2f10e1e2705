// The same equilibrium on any number of ranks and by any linear solver.
#include <numeric>

#include "solved.h"
#include "solvers/quasi_static/linear_system.h"

namespace talus {
namespace {

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
  const std::vector<std::string> halved{"mesh.size=6", "mesh.halvings=1"};
  for (std::vector<std::string> keys : std::vector<std::vector<std::string>>{{}, halved}) {
    Solved whole;
    for (int r = 0; r < ranks; ++r) {  // one after the other: they share the file of the mesh
      if (r == rank) whole = solve(text, keys, PETSC_COMM_SELF);
      MPI_Barrier(PETSC_COMM_WORLD);
    }
    std::map<long long, size_t> place;
    for (size_t i = 0; i < whole.points.id.size(); ++i) place[whole.points.id[i]] = i;
    EXPECT_GT(
        *std::max_element(whole.column("plastic_strain").values.begin(), whole.column("plastic_strain").values.end()),
        1e-4);
    for (const char *solver : {"direct", "iterative"}) {
      keys.push_back("quasi_static.linear_solver=" + std::string(solver));
      const Solved shared = solve(text, keys);
      keys.pop_back();
      EXPECT_LT(largest(shared, 2,
                        [&](size_t p, int k) {
                          return (shared.value("displacement", p, k) -
                                  whole.value("displacement", place.at(shared.points.id[p]), k)) /
                                 0.1;
                        }),
                1e-8)
          << solver << ", " << keys.size() << " keys";
    }
  }
}

/// Cholesky's method has no factor of a symmetric matrix that is not positive definite: said on all ranks, and LU
/// solves.
TEST(LinearSystem, a_matrix_that_is_not_positive_definite_is_not_factored_by_cholesky) {
  constexpr PetscInt size =
      100;  // of a rank's block, all of it filled: CHOLMOD factors sparse ones as L D L^T, whatever the sign of D
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  std::vector<PetscInt> mine(size);
  std::iota(mine.begin(), mine.end(), size * rank);
  SparseMatrix matrix;
  const auto put = [&](double beside) {  // the diagonal
    std::vector<double> block(size * size, beside);
    for (PetscInt i = 0; i < size; ++i) block[i * (size + 1)] = 1;
    return matrix.add(size, mine.data(), size, mine.data(), block.data());
  };
  ASSERT_EQ(matrix.make(PETSC_COMM_WORLD, size, size, 1, [&] { return put(1); }), 0);
  for (const double beside : {0.5, 2.}) {
    ASSERT_EQ(matrix.clear(), 0);
    ASSERT_EQ(put(beside), 0);
    ASSERT_EQ(matrix.finish(), 0);
    for (const Factorization way : {Factorization::cholesky, Factorization::lu}) {
      Vector b, x;
      Owned<KSP, KSPDestroy> solver;
      bool solved;
      double largest;
      ASSERT_EQ(MatCreateVecs(matrix, x.create(), b.create()), 0);
      ASSERT_EQ(VecSet(b, 1), 0);
      ASSERT_EQ(KSPCreate(PETSC_COMM_WORLD, solver.create()), 0);
      ASSERT_EQ(solve_directly(solver, matrix, way), 0);
      ASSERT_EQ(solve_system(solver, matrix, b, x, &solved), 0);
      EXPECT_EQ(solved, way == Factorization::lu || beside < 1) << beside;
      if (!solved) continue;
      ASSERT_EQ(VecNorm(x, NORM_INFINITY, &largest), 0);
      EXPECT_NEAR(largest * (1 + (size - 1) * beside), 1, 1e-12);
    }
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

/// PETSc's search for a critical point says "converged" where force and step are perpendicular; here it is made to say
/// so of any step. The iterations against a prop, which come second, find the equilibrium.
TEST(QuasiStatic, a_search_that_gives_up_is_no_equilibrium) {
  const std::string column =
      "gravity = 10\n" + block + "[boundary.walls]\ngroup = [\"base\", \"left\", \"right\"]\nkind = \"roller\"\n";
  const auto wanted = solve(column).column("displacement").values;
  const std::string gives_up = "-talus_snes_linesearch_atol 1e9 -talus_flow_snes_linesearch_atol 1e9";
  const Options given(gives_up.c_str());
  const auto found = solve(column).column("displacement").values;
  ASSERT_EQ(found.size(), wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-8);  // the tolerance of Newton
}

/// What several ranks add to one number, they add in an order of their own, and factors are not shared: the same run
/// has the same digits, also where Newton's iterations run away and each of them magnifies the last digit.
TEST(QuasiStatic, a_run_repeats_to_the_bit) {
  const std::string text = "gravity = 10\n" + box +
                           "density = 2000\n[boundary.base]\nkind = \"friction\"\nfriction_angle = 20\n"
                           "[boundary.left]\nkind = \"traction\"\npressure = \"20e3 * t\"\n"
                           "[[stage]]\nname = \"push\"\nkind = \"quasi_static\"\nduration = 1\nload_steps = 10\n"
                           "when_lost = \"next_stage\"\n[[stage]]\nname = \"fall\"\nduration = 1e-5\n";
  const Solved first = solve(text);
  ASSERT_FALSE(first.events.empty());
  for (int run = 0; run < 8; ++run) {
    const Solved again = solve(text);
    ASSERT_EQ(again.events.size(), first.events.size());
    for (size_t k = 0; k < first.events.size(); ++k) EXPECT_EQ(again.events[k].text, first.events[k].text);
    EXPECT_EQ(again.column("stress").values, first.column("stress").values);
  }
}

}  // namespace
}  // namespace talus
