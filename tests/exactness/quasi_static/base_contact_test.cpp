// Bases with friction in quasi-static stages: blocks on a plane and a wedge in a groove whose forces and limits are
// those of rigid bodies. Resultant forces are exact whatever the elements and the springs of the contact are, to
// Newton's tolerance; limits are found to the smallest step of the loads, 1e-3 of them.
#include "solvers/quasi_static/base_contact.h"

#include <filesystem>
#include <fstream>

#include "scene/scene.h"
#include "solved.h"

namespace talus {
namespace {

using Keys = std::vector<std::string>;

const double degree = M_PI / 180;
const Keys sharp{"quasi_static.tolerance=1e-10"};

/// A block of 2000 kg on the base y = 0, under gravity of 10 m/s2 that is tilted by `dip`.
std::string block_on_plane(double dip, const std::string &further = "") {
  std::ostringstream text;
  text.precision(17);
  text << "gravity = [" << 10 * std::sin(dip) << ", " << -10 * std::cos(dip) << "]\n"
       << box << "density = 2000\n[boundary.base]\nkind = \"friction\"\nfriction_angle = 20\n"
       << "[[stage]]\nname = \"weight\"\nkind = \"quasi_static\"\nduration = 1\nhold_loads = true\n"
       << further;
  return text.str();
}
const std::string push =
    "[boundary.left]\nkind = \"traction\"\npressure = \"20e3 * t\"\n"
    "[[stage]]\nname = \"push\"\nkind = \"quasi_static\"\nduration = 1\nload_steps = 10\nwhen_lost = \"next_stage\"\n"
    "[[stage]]\nname = \"fall\"\nduration = 1e-5\n";

/// Load time at which equilibrium ended.
double end_of_equilibrium(const Solved &solved) {
  for (const Event &event : solved.events)
    if (event.kind == event::equilibrium_lost) return event.load_time;
  return -1;
}

TEST(BaseContact, bears_the_weight_of_a_block_that_sticks) {
  for (const char *elements : {"quadratic", "linear", "patches"}) {
    const Solved solved =
        solve(block_on_plane(15 * degree), sharp + Keys{std::string("quasi_static.elements=") + elements});
    EXPECT_NEAR(solved.history.column("base_force_x_N").back(), -20e3 * std::sin(15 * degree), 1e-4) << elements;
    EXPECT_NEAR(solved.history.column("base_force_y_N").back(), 20e3 * std::cos(15 * degree), 1e-4) << elements;
  }
}

TEST(BaseContact, bears_a_block_in_3d) {
  const Solved solved = solve(
      block_on_plane(15 * degree),
      sharp + in_3d + Keys{"gravity=[2.588190451025207, -9.659258262890683, 0]", "quasi_static.elements=patches"});
  EXPECT_NEAR(solved.history.column("base_force_x_N").back(), -20e3 * std::sin(15 * degree), 1e-4);
  EXPECT_NEAR(solved.history.column("base_force_y_N").back(), 20e3 * std::cos(15 * degree), 1e-4);
}

/// Steeper than the friction angle nothing stands; the program says so instead of an answer.
TEST(BaseContact, lets_a_block_slide) {
  EXPECT_NO_THROW(solve(block_on_plane(19.5 * degree)));
  EXPECT_THROW(solve(block_on_plane(20.5 * degree)), std::exception);
}

/// Soil that has moved further than the mesh is long has no equilibrium, whatever the forces of small strains say: here
/// it is pressed into its base; on a base of two friction angles it slides until its weight rests on the rough part.
TEST(BaseContact, finds_no_equilibrium_far_away) {
  const std::string text = "gravity = 10\n" + box +
                           "density = 2000\n[boundary.base]\nkind = \"fixed\"\n"
                           "[[stage]]\nname = \"weight\"\nkind = \"quasi_static\"\nduration = 1\n";
  EXPECT_NO_THROW(solve(text, {"body.soil.young_modulus=1e5"}));  // it settles by a tenth of its height
  EXPECT_THROW(solve(text, {"body.soil.young_modulus=1e3"}), RunError);
}

/// A push of H = W tan(phi) moves the block; beyond phi = 45 degrees it turns over instead, where H / 2 = W / 2.
TEST(BaseContact, gives_way_to_a_push) {
  const Solved slides = solve(block_on_plane(0, push));
  EXPECT_NEAR(end_of_equilibrium(slides), std::tan(20 * degree), 2e-3);
  const Solved turns =
      solve(block_on_plane(0, push), {"boundary.base.friction_angle=60", "boundary.left.pressure=25e3 * t"});
  EXPECT_NEAR(end_of_equilibrium(turns), 20. / 25, 2e-3);
}

/// Adhesion that grows along the base: its resultant is 10 kN, which the shares of the nodes sum up exactly.
TEST(BaseContact, takes_its_strength_by_place_and_time) {
  const Solved slides = solve(block_on_plane(0, push), {"gravity=40", "boundary.base.friction_angle=0",
                                                        "boundary.base.adhesion=20e3 * x * (0.5 + 0.2 * t)"});
  EXPECT_NEAR(end_of_equilibrium(slides), 5. / 18, 2e-3);  // 20 t = 10 (0.5 + 0.2 t)
}

std::string groove(const std::string &further = "") {
  return "gravity = 10\n[mesh]\nsection = \"" TALUS_GROOVE
         "\"\nsize = 0.3\n[body.soil]\nregion = \"soil\"\ndensity = 1000\nlaw = \"mohr_coulomb\"\nyoung_modulus = 1e7\n"
         "poisson_ratio = 0.3\ncohesion = 1e7\nfriction_angle = 0\nbody_acceleration = [\"7 * t\", \"0\"]\n"
         "[boundary.left_plane]\nkind = \"friction\"\nfriction_angle = 0\n[boundary.right_plane]\nkind = \"friction\"\n"
         "friction_angle = 0\n[[stage]]\nname = \"weight\"\nkind = \"quasi_static\"\nduration = 1\nhold_loads = "
         "true\n" +
         further;
}
const double weight = 1e4 * (1.7320508075688774 + 1.1917535925942100) / 2;
const Keys rough{"boundary.left_plane.friction_angle=10", "boundary.right_plane.friction_angle=10"};

/// Between smooth planes both forces follow from equilibrium.
TEST(BaseContact, bears_a_wedge_in_a_groove) {
  const Solved solved = solve(groove(), sharp);
  const double left = weight * std::sin(30 * degree) / std::sin(70 * degree),
               right = weight * std::sin(40 * degree) / std::sin(70 * degree);
  EXPECT_NEAR(solved.history.column("left_plane_force_x_N").back(), left * std::sin(40 * degree), 1e-4);
  EXPECT_NEAR(solved.history.column("left_plane_force_y_N").back(), left * std::cos(40 * degree), 1e-4);
  EXPECT_NEAR(solved.history.column("right_plane_force_x_N").back(), -right * std::sin(30 * degree), 1e-4);
  EXPECT_NEAR(solved.history.column("right_plane_force_y_N").back(), right * std::cos(30 * degree), 1e-4);
}

/// A wedge that is accelerated to the right lifts off the left plane and moves up the right one at tan(30 + phi) of its
/// weight.
TEST(BaseContact, lifts_a_wedge_out_of_a_groove) {
  const Solved solved = solve(groove("[[stage]]\nname = \"push\"\nkind = \"quasi_static\"\nduration = 2\nload_steps = "
                                     "10\nwhen_lost = \"next_stage\"\n[[stage]]\nname = \"fall\"\nduration = 1e-5\n"),
                              rough);
  EXPECT_NEAR(end_of_equilibrium(solved), std::tan(40 * degree) / 0.7, 2 * 2e-3);
  const auto left = solved.history.column("left_plane_force_x_N");
  EXPECT_NEAR(*std::min_element(left.begin(), left.end()), 0, 1e-6) << "it has left this plane before it slides";
}

FactorOfSafety factor_of(const std::string &text, const Keys &keys) {
  Scene scene = parse_scene(text, meshes + "/scene.toml", keys);
  scene.add_factor_stage();
  RunOptions options;
  options.pictures = options.screen = false;
  return make_simulation(PETSC_COMM_WORLD, scene, options)->factor_of_safety();
}
void expect_holds(const FactorBracket &bracket, double exact) {
  EXPECT_TRUE(bracket.decided);
  EXPECT_LT(bracket.lower, exact * (1 + 1e-3));
  EXPECT_GT(bracket.upper, exact * (1 - 1e-3));
  EXPECT_LT(bracket.upper, 1.01 * bracket.lower);
}

/// tan(phi) / tan(dip), and with adhesion c A / (W sin(dip)) more; the soil itself is far from its strength.
TEST(BaseContact, leaves_the_factor_of_a_block) {
  const Keys strong{"body.soil.law=mohr_coulomb", "body.soil.cohesion=1e7", "body.soil.friction_angle=0"};
  expect_holds(factor_of(block_on_plane(15 * degree), strong), std::tan(20 * degree) / std::tan(15 * degree));
  expect_holds(factor_of(block_on_plane(15 * degree), strong + Keys{"boundary.base.adhesion=2000"}),
               std::tan(20 * degree) / std::tan(15 * degree) + 2e3 / (20e3 * std::sin(15 * degree)));
}
TEST(BaseContact, leaves_the_factor_of_a_block_that_never_fails) {
  expect_holds(factor_of(block_on_plane(15 * degree), {}), std::tan(20 * degree) / std::tan(15 * degree));
}
/// Friction that grows linearly along the base is, in sum, that at the point where the normal force acts: half the
/// height times tan(dip) downhill of the middle, by the moments of the block. It does not matter how it spreads.
TEST(BaseContact, leaves_the_factor_of_a_base_whose_friction_varies) {
  const double dip = 15 * degree, at = 0.5 * std::tan(dip);
  for (const double slope : {0.5, -0.5}) {  // of tan(phi) along x
    std::ostringstream angle;
    angle << "boundary.base.friction_angle=atan(0.6 + " << slope << " * (x - 0.5)) * 180 / pi";
    const Keys keys{"body.soil.law=mohr_coulomb", "body.soil.cohesion=1e7", "body.soil.friction_angle=0", angle.str()};
    expect_holds(factor_of(block_on_plane(dip), keys), (0.6 + slope * at) / std::tan(dip));
  }
}
/// k = tan(30 + phi_F), the friction of both planes divided alike.
TEST(BaseContact, leaves_the_factor_of_a_wedge) {
  const std::string text = groove("[[stage]]\nname = \"push\"\nkind = \"quasi_static\"\nduration = 1\n");
  expect_holds(factor_of(text, rough), std::tan(10 * degree) / std::tan(std::atan(0.7) - 30 * degree));
}

/// Friction goes on as it was when motion begins. It would else have to build up over the delay of (6.2), in which the
/// block gets a speed of g sin(dip) times the delay, 0.004 m/s here.
TEST(BaseContact, goes_on_in_motion) {
  const Solved solved =
      solve(block_on_plane(15 * degree, "reset_displacement = true\n[[stage]]\nname = \"rest\"\nduration = 0.1\n"),
            sharp + Keys{"quasi_static.elements=patches", "body.soil.poisson_ratio=0"});
  const double most = largest(solved, 2, [&](size_t p, int k) { return solved.value("velocity", p, k); });
  EXPECT_LT(most, 4e-4);
}

// ---- rough ground ---------------------------------------------------------------------------------------------------

/// Terrain that falls by 37 degrees, with relief at all scales down to its grid of 10 m.
double rough_ground(double x, double y) {
  const auto at = [](double i, double j, int k) {
    const double h = std::sin(i * 127.1 + j * 311.7 + k * 74.7) * 43758.5453;
    return 2 * (h - std::floor(h)) - 1;
  };
  double z = 1000 + 0.75 * x;
  for (int k = 0; k < 5; ++k) {
    const double length = 160 / std::pow(2, k), i = std::floor(x / length), j = std::floor(y / length);
    double u = x / length - i, v = y / length - j;
    u = u * u * (3 - 2 * u), v = v * v * (3 - 2 * v);
    z += 15 / std::pow(2, k) *
         ((1 - v) * ((1 - u) * at(i, j, k) + u * at(i + 1, j, k)) +
          v * ((1 - u) * at(i, j + 1, k) + u * at(i + 1, j + 1, k)));
  }
  return z;
}

Solved stand_on_rough_ground(const Keys &keys, const std::string &more = "") {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "talus_rough_ground";
  int rank, ranks;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank), MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const std::filesystem::path file = folder / ("ground_" + std::to_string(ranks) + ".asc");
  if (rank == 0) {
    std::filesystem::create_directories(folder);
    std::ofstream grid(file);
    grid << "ncols 41\nnrows 41\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n";
    for (int j = 40; j >= 0; --j)
      for (int i = 0; i < 41; ++i)
        grid << std::llround(100 * rough_ground(10 * (i + 0.5), 10 * (j + 0.5))) / 100. << (i < 40 ? " " : "\n");
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  return solve("dimension = 3\nup = \"z\"\ngravity = 10\n[mesh]\n[mesh.terrain]\nfile = \"" + file.string() +
                   "\"\nwindow = [10, 10, 400, 400]\nair = 20\nfar_size = 40\n[mesh.terrain.ellipsoid]\n"
                   "centre = [205, 205, 1155]\nsemi_axes = [90, 70, 25]\ndip = 37\ndip_direction = 270\n"
                   "[body.debris]\nregion = \"slide\"\ndensity = 2000\nlaw = \"linear_elastic\"\n"
                   "young_modulus = 5e7\npoisson_ratio = 0.3\n[boundary.bed]\ngroup = \"base\"\nkind = \"friction\"\n"
                   "friction_angle = 50\n[quasi_static]\nelements = \"patches\"\n"
                   "[[stage]]\nname = \"gravity\"\nkind = \"quasi_static\"\nduration = 1\nload_steps = 1\n" +
                   more,
               keys);
}
double left_out(const Solved &solved) {  // volume by the log [m3]
  for (const Event &event : solved.events)
    if (const size_t at = event.text.find(" of soil, ");
        at != std::string::npos && event.text.find("left out") < event.text.npos)
      return std::stod(event.text.substr(at + 10));
  return 0;
}

/// Where contact opens, corners of the soil turn about edges of the mesh until they rest on the base again. The base
/// bears the weight of all soil but that of pieces that nothing holds; the log gives their volume by three figures.
TEST(BaseContact, bears_soil_on_rough_ground) {
  for (const char *size : {"12", "7"}) {
    const Solved solved = stand_on_rough_ground({std::string("mesh.size=") + size, "quasi_static.tolerance=1e-8"});
    const double weight = 10 * solved.history.column("mass_kg").back(), out = 2e4 * left_out(solved);
    EXPECT_NEAR(solved.history.column("bed_force_z_N").back(), weight - out, 1e-6 * weight + 5e-3 * out) << size;
    EXPECT_NEAR(solved.history.column("bed_force_x_N").back(), 0, 1e-6 * weight) << size;
    EXPECT_NEAR(solved.history.column("bed_force_y_N").back(), 0, 1e-6 * weight) << size;
    EXPECT_LT(out, 0.01 * weight) << size;
  }
}

/// Motion and finite elements have the same normals of a base, also on relief, so that soil stays where these have put
/// it. Gravity has done work by the settlement; if each facet had a normal of its own it would do another 25 % in
/// motion.
TEST(BaseContact, soil_on_rough_ground_stays_when_motion_begins) {
  const HistoryTable history =
      stand_on_rough_ground({"mesh.size=12"}, "[[stage]]\nname = \"motion\"\nduration = 0.5\n").history;
  const std::vector<double> work = history.column("work_gravity_J");
  const size_t last = work.size() - 1;
  size_t settled = last;
  while (settled > 0 && history.column("time_s")[settled] > 1) --settled;
  EXPECT_NEAR(work[last], work[settled], 0.01 * work[settled]);
}

/// On a base that is too smooth for it the soil slides as a whole, which the message says with its place.
TEST(BaseContact, says_where_soil_slides_off_rough_ground) {
  try {
    stand_on_rough_ground({"mesh.size=12", "boundary.bed.friction_angle=30", "quasi_static.smallest_step=0.5"});
    FAIL() << "it stands";
  } catch (const std::exception &error) {
    EXPECT_NE(std::string(error.what()).find("move without end around ("), std::string::npos) << error.what();
  }
}

// ---- the law of the contact -----------------------------------------------------------------------------------------

/// Tangents are the derivative of the force, in every case that the laws distinguish.
TEST(BaseContact, has_a_consistent_tangent) {
  const Vec<3> n{0, 0.6, 0.8};
  for (const bool given : {false, true})
    for (const double adhesion : {0., 0.3}) {
      const auto force = [&](const Vec<3> &spring) {
        return given ? force_at_given_friction<3>(spring, n, adhesion) : force_on_base<3>(spring, n, 0.4, adhesion);
      };
      for (const Vec<3> &spring : {Vec<3>{0.1, 0.6, 0.8}, Vec<3>{2, 0.6, 0.8}, Vec<3>{0.2, -0.6, -0.8},
                                   Vec<3>{2, -0.6, -0.7}, Vec<3>{1, 0.9, 0.1}}) {
        const BaseForce<3> f = force(spring);
        for (int k = 0; k < 3; ++k) {
          constexpr double step = 1e-6;
          Vec<3> more = spring, less = spring;
          more[k] += step, less[k] -= step;
          const BaseForce<3> high = force(more), low = force(less);
          for (int d = 0; d < 3; ++d) EXPECT_NEAR(f.tangent(d, k), (high.borne[d] - low.borne[d]) / (2 * step), 1e-8);
        }
      }
    }
}

/// What it bears presses, and rubs with no more than friction and adhesion; slip leaves the normal force as it is.
TEST(BaseContact, bears_what_coulomb_admits) {
  const Vec<2> n{0, -1};
  for (double x = -2; x <= 2; x += 0.25)
    for (double y = -2; y <= 2; y += 0.25) {
      const BaseForce<2> f = force_on_base<2>({x, y}, n, 0.5, 0.25);
      EXPECT_EQ(f.borne[1], std::min(0., y));
      EXPECT_LE(std::abs(f.borne[0]), 0.25 - 0.5 * f.borne[1] + 1e-12);
    }
}

/// Adhesion comes with the force that presses, so that nothing jumps where soil lifts off, and acts in full where that
/// force is a half of it, for friction of 1.
TEST(BaseContact, does_not_jump_as_soil_lifts_off) {
  const Vec<2> n{0, -1};
  EXPECT_NEAR(force_on_base<2>({5, -1e-9}, n, 1, 4).borne[0], 3e-9, 1e-20);
  EXPECT_EQ(force_on_base<2>({5, 1e-9}, n, 1, 4).borne[0], 0);
  EXPECT_NEAR(force_on_base<2>({9, -2}, n, 1, 4).borne[0], 6, 1e-12);
  EXPECT_NEAR(force_on_base<2>({9, -3}, n, 1, 4).borne[0], 7, 1e-12);
}

/// Where friction is given, no admissible force is closer to that of the spring: the way to each of them leads away
/// from it.
TEST(BaseContact, bears_the_closest_force_where_friction_is_given) {
  const Vec<2> n{0, -1};
  constexpr double most = 0.75;
  for (double x = -2; x <= 2; x += 0.25)
    for (double y = -2; y <= 2; y += 0.25) {
      const Vec<2> borne = force_at_given_friction<2>({x, y}, n, most).borne;
      for (double pressing = 0; pressing <= 2; pressing += 0.25)
        for (const double share : {-1., 0., 1.})
          EXPECT_LE((x - borne[0]) * (share * most - borne[0]) + (y - borne[1]) * (-pressing - borne[1]), 1e-12);
    }
}

}  // namespace
}  // namespace talus
