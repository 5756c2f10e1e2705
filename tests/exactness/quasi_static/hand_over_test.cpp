// What quasi-static stages and motion hand over to each other.
#include "scene/scene.h"
#include "solved.h"

namespace talus {
namespace {

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
  EXPECT_NE(solved.events[0].text.find(" % of the time of stage load (0."), std::string::npos) << "not of its loads";
  EXPECT_GT(solved.events[0].load_time,
            20e3 / 60e3 - 1e-3);  // 2 c is the least that a block can bear, found to the smallest step
  EXPECT_LT(solved.events[0].load_time, 30e3 / 60e3);
  EXPECT_GT(speed.back(), 0);

  // what moves is found in any mesh, also where forces out of balance go up and down by more than a third as it moves
  for (const char *size : {"0.24", "0.26", "0.3", "0.32"}) {
    const Solved moves = solve(text, {"body.soil.law=mohr_coulomb", "body.soil.cohesion=10000", "stage.1.duration=1e-5",
                                      "body.soil.friction_angle=0", std::string("mesh.size=") + size});
    ASSERT_FALSE(moves.events.empty()) << size;
    const std::string &said = moves.events[0].text;
    EXPECT_NE(said.find("of it) move without end around"), std::string::npos) << size << ": " << said;
  }
}

/// Too few iterations for Newton's steps lose the equilibrium of soil that stands, factor 3.77 c / (rho g h) = 1.32: it
/// is found in another way, with the stress of the weight on the base. Weaker soil, of factor 0.75, is refused.
TEST(QuasiStatic, soil_that_stands_is_found_where_newton_fails) {
  const std::string cut = "gravity = 10\n" + block +
                          "softening = false\n[boundary.base]\nkind = \"fixed\"\n[boundary.left]\nkind = \"roller\"\n";
  const std::vector<std::string> lost{"body.soil.law=mohr_coulomb", "body.soil.cohesion=7e3",
                                      "body.soil.friction_angle=0", "quasi_static.elements=quadratic",
                                      "quasi_static.iterations=1",  "quasi_static.smallest_step=0.5",
                                      "stage.0.load_steps=1"};
  const Solved solved = solve(cut, lost);
  ASSERT_FALSE(solved.events.empty());
  const std::string &said = solved.events.back().text;
  EXPECT_NE(said.find("stage load is in equilibrium"), std::string::npos) << said;
  EXPECT_NE(said.find("its load steps ended at 0 %, and the rest came at once, under which the soil crept"),
            std::string::npos)
      << said;
  EXPECT_NEAR(solved.history.column("base_force_y_N").back(), 2000 * 10, 1e-3 * 2000 * 10);
  std::vector<std::string> weak = lost;
  weak[1] = "body.soil.cohesion=4e3";
  try {
    solve(cut, weak);
    ADD_FAILURE();
  } catch (const RunError &error) {
    EXPECT_NE(std::string(error.what()).find("a mechanism of failure was found"), std::string::npos) << error.what();
  }
}

/// Largest displacement since the last reset, as a share of that by gravity, about 1 mm.
double moved(const std::string &text) {
  const Solved solved = solve(text, {"quasi_static.elements=patches", "quasi_static.tolerance=1e-12"});
  return largest(solved, 2, [&](size_t p, int k) { return solved.value("displacement", p, k) / 1e-3; });
}

/// Particles to Gauss points and back: what rests is still in equilibrium.
TEST(QuasiStatic, stress_comes_back_from_particles) {
  const std::string text =
      "gravity = 10\n" + block +
      "reset_displacement = true\n[boundary.base]\nkind = \"fixed\"\n[[stage]]\nname = \"rest\"\nduration = 0.05\n"
      "[[stage]]\nname = \"again\"\nkind = \"quasi_static\"\nduration = 1\n";
  EXPECT_LT(moved(text), 1e-9);
}

/// The same where the motion comes first: it has brought the weight, and finite elements find nothing to move.
TEST(QuasiStatic, stress_comes_from_a_motion_that_was_first) {
  const std::string text =
      "gravity = 10\n" + box +
      "density = 2000\n[boundary.base]\nkind = \"fixed\"\n[[stage]]\nname = \"settle\"\nduration = 2\ndamping = 0.7\n"
      "reset_displacement = true\n[[stage]]\nname = \"again\"\nkind = \"quasi_static\"\nduration = 1\n";
  EXPECT_LT(moved(text), 1e-3);  // the motion has come to rest by far more
}

/// A reset sets plastic strain to zero and not the state of the soil: what clay has been consolidated to stays, in
/// elements as in particles.
TEST(QuasiStatic, consolidation_of_clay_stays_where_plastic_strain_is_reset) {
  const std::string text = R"(
gravity = 10
[mesh]
section = "box.csv"
size = 0.3
[body.soil]
region = "soil"
density = 2000
law = "cam_clay"
compression_slope = 0.1
swelling_slope = 0.01
critical_stress_ratio = 1.2
poisson_ratio = 0.3
void_ratio = 1
preconsolidation_pressure = 4e3
[boundary.base]
kind = "fixed"
[boundary.sides]
group = ["left", "right"]
kind = "roller"
[[stage]]
name = "load"
kind = "quasi_static"
duration = 1
reset_displacement = true
[[stage]]
name = "again"
kind = "quasi_static"
duration = 1
hold_loads = true
)";
  const auto consolidated = [&](const std::vector<std::string> &keys) {
    const Solved solved = solve(text, keys);
    return largest(solved, 1, [&](size_t p, int) { return solved.value("consolidation", p); });
  };
  const double reset = consolidated({});
  EXPECT_GT(reset, 0.5);  // ln of three times the pressure that it had borne
  EXPECT_NEAR(reset, consolidated({"stage.0.reset_displacement=false"}), 1e-9);
}

/// Finite elements have no cells where soil has flown to.
TEST(QuasiStatic, soil_that_has_left_its_region_is_refused) {
  const std::string text =
      "gravity = 0\n[mesh]\nsection = \"flight.csv\"\nsize = 0.15\n[body.block]\nregion = \"block\"\n"
      "density = 2000\nlaw = \"linear_elastic\"\nyoung_modulus = \"10 MPa\"\npoisson_ratio = 0.3\n"
      "velocity = [\"12\", \"0\"]\n[[stage]]\nname = \"flight\"\nduration = 0.05\n"
      "[[stage]]\nname = \"stand\"\nkind = \"quasi_static\"\nduration = 1\n";
  try {
    solve(text);
    FAIL() << "soil outside of its region";
  } catch (const RunError &failure) {
    EXPECT_NE(std::string(failure.what()).find("body.block has soil at ("), std::string::npos) << failure.what();
    EXPECT_NE(std::string(failure.what()).find("outside of its region"), std::string::npos) << failure.what();
  }
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

}  // namespace
}  // namespace talus
