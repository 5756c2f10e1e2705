// A granular column runs out over a base with friction and comes to rest. Its front is one particle thick: contact must
// not lift what lies on the base (docs/theory, section 6), so nothing is ever above the column's first height.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

const std::string block = std::string(TALUS_VERIFICATION) + "/incline_block/scene.toml";
const std::string column = std::string(TALUS_GALLERY) + "/column/scene.toml";
constexpr double height = 0.1;

/// A scene with overrides, once it has run. The simulation reads the scene as long as it lives.
class Ended {
 public:
  Ended(const std::string &file, const std::vector<std::string> &overrides) : scene_(read_scene(file, overrides)) {
    RunOptions options;
    options.pictures = options.screen = false;
    simulation_ = make_simulation(PETSC_COMM_WORLD, scene_, options);
    simulation_->run();  // ends with an error if a particle leaves the mesh
  }
  Ended(const Ended &) = delete;
  Ended &operator=(const Ended &) = delete;
  AnySimulation *operator->() const { return simulation_.get(); }
  const AnySimulation &operator*() const { return *simulation_; }

 private:
  Scene scene_;
  std::unique_ptr<AnySimulation> simulation_;
};

void expect_rest(std::vector<std::string> overrides) {
  for (const char *more : {"boundary.base.kind=friction", "boundary.base.friction_angle=19.8", "stage.0.until=rest",
                           "stage.0.rest_speed=0.005", "stage.0.duration=3", "output.interval=0"})
    overrides.emplace_back(more);
  Scene scene = read_scene(column, overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const long long particles = simulation->particles();
  double highest = 0;
  simulation->run();  // ends with an error if a particle leaves the mesh
  const Snapshot end = simulation->snapshot();
  const Column &position = end.columns.front();
  for (size_t i = 0; i < end.id.size(); ++i) highest = std::max(highest, position.values[i * position.components + 1]);
  long long count = static_cast<long long>(end.id.size());
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_LONG_LONG, MPI_SUM, PETSC_COMM_WORLD);
  EXPECT_EQ(count, particles);
  EXPECT_LE(highest, height);
  ASSERT_EQ(simulation->events().size(), 1u);
  EXPECT_NE(simulation->events()[0].text.find("came to rest"), std::string::npos) << simulation->events()[0].text;
}

TEST(FrictionalBase, column_comes_to_rest_on_it) { expect_rest({"mesh.size=0.01"}); }
TEST(FrictionalBase, column_comes_to_rest_on_it_in_3d) {
  const std::string k0 = "\"-9.81 * 2650 * (0.1 - y) * 0.3 / 0.7\"";
  expect_rest({"mesh.size=0.0125", "dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller",
               "output.point.corner.position=[0.2, 0.1, 0.006]",
               "body.bars.stress=[" + k0 + ", \"-9.81 * 2650 * (0.1 - y)\", " + k0 + ", \"0\", \"0\", \"0\"]"});
}

/// Slip is the way of the block while the stage records it, and none after a reset; the heat of the base is the work of
/// friction. The block of 1 m covers new places as it slides on, so the mean slip below it falls behind its way by half
/// of its square. Where it begins and ends is known to a cell of 0.1 m. The work that is left behind with the tail is
/// less than s / 2 of it, since friction presses the front down.
TEST(FrictionalBase, remembers_slip_and_heat_where_the_stage_says_so) {
  const auto at_end = [](const std::string &keys, const char *column) {
    const Ended simulation(
        block, {"boundary.base.kind=heated_friction", "boundary.base.thickness=0.01", "boundary.base.storage=1e-9",
                "boundary.base.hydraulic_conductivity=1e-11", "boundary.base.thermal_pressurisation=1e3",
                "stage=[{name='first', duration=0.2, " + keys + "}, {name='second', duration=0.4}]"});
    return simulation->history().column(column).back();
  };
  const double way = at_end("softening=true", "base_slip_m"), half = at_end("softening=false", "base_slip_m"),
               again = at_end("reset_displacement=true", "base_slip_m");
  const double acceleration = 0.5 * 9.81 - std::tan(M_PI / 9) * std::sqrt(0.75) * 9.81;
  const auto mean = [](double s) { return s - s * s / 2; };
  EXPECT_NEAR(way, mean(acceleration * 0.18), 0.1 * acceleration * 0.18);
  EXPECT_NEAR(half, mean(acceleration * 0.16), 0.1 * acceleration * 0.16);
  EXPECT_NEAR(again, mean(acceleration * 0.08), 0.1 * acceleration * 0.08);  // the reset stops the block
  const double heat = at_end("softening=true", "base_heat_J"), work = at_end("softening=true", "work_base_J");
  EXPECT_GT(heat, -work * (1 - acceleration * 0.18 / 2));
  EXPECT_LT(heat, -work * 1.05);
  // in a single row friction lags behind a normal force that varies by a tenth, as the block still vibrates
  EXPECT_NEAR(at_end("softening=false", "base_friction"), std::tan(M_PI / 9), 0.1 * std::tan(M_PI / 9));
}

/// The block stands until its base loses friction at 0.6 s, long after a stage would have ended by its rest: the stage
/// waits for that, unless loads are held, or nothing will change while it lasts.
TEST(FrictionalBase, a_stage_does_not_end_by_rest_before_loads_have_changed) {
  const auto run = [](const std::string &friction, const std::string &stages) {
    return Ended(block, {"boundary.base.friction_angle=" + friction, "output.interval=0",
                         "functions.loss=[[0, 40], [0.6, 40], [0.61, 20]]", "stage=[" + stages + "]"});
  };
  const std::string rest = "name='first', duration=1.5, until='rest', rest_speed=0.02, damping=0.5";
  const auto waits = run("'loss(t)'", "{" + rest + "}");
  EXPECT_NEAR(waits->history().column("time_s").back(), 1.5, 1e-9);
  EXPECT_LT(waits->history().column("work_base_J").back(), -100);
  ASSERT_FALSE(waits->events().empty());
  EXPECT_EQ(waits->events()[0].text,
            "the rms speed of all soil is below rest_speed, but the stage first goes on: boundary.base changes until t "
            "= 0.61 s; hold_loads = true "
            "would keep loads as they are");
  const std::string unknown = run("'t < 2 ? 40 : 20'", "{" + rest + "}")->events().at(0).text;
  EXPECT_NE(unknown.find("boundary.base is a function of t; "), std::string::npos) << unknown;
  const std::string end = run("'t < 2 ? 40 : 20'", "{" + rest + "}")->events().back().text;
  EXPECT_NE(end.find("below rest_speed but is no rest: boundary.base is a function of t"), std::string::npos) << end;
  for (const auto &[friction, stages] :
       {std::pair<std::string, std::string>{"40", "{" + rest + "}"},
        {"'loss(t)'", "{" + rest + ", hold_loads=true}"},
        {"'loss(t)'", "{name='first', duration=0.5, until='rest', rest_speed=0.02, damping=0.5}"}}) {
    const auto ends = run(friction, stages);
    EXPECT_EQ(ends->events().back().text, "stage first came to rest") << stages;
    EXPECT_LT(ends->history().column("time_s").back(), 0.6) << stages;
  }
}

/// The columns of a base: friction over normal force is that of the forces in the same row, less what acts on nodes
/// that slide upwards for a moment, as light nodes do in front of the soil and behind it. Soil that
/// starts 20 mm higher has 20 mm more clearance, in the same cells.
TEST(FrictionalBase, reports_its_friction_and_the_clearance_of_the_soil) {
  const auto run = [](std::vector<std::string> more) {
    more.insert(more.end(), {"output.interval=0", "output.history_interval=0.05", "stage.0.duration=0.8"});
    return Ended(block, more);
  };
  const auto slides = run({});
  const auto friction = slides->history().column("base_friction"), x = slides->history().column("base_force_x_N"),
             y = slides->history().column("base_force_y_N");
  ASSERT_GE(friction.size(), 17u);
  for (size_t i = 1; i < friction.size(); ++i) EXPECT_GT(friction[i], -x[i] / y[i] - 1e-9);
  for (size_t i = friction.size() - 4; i < friction.size(); ++i) EXPECT_NEAR(friction[i], -x[i] / y[i], 2e-3);
  EXPECT_NEAR(friction.back(), std::tan(M_PI / 9), 0.1 * std::tan(M_PI / 9));
  const double lies = slides->history().column("base_clearance_m").front(),
               raised = run({"body.block.displacement=['0', '0.02']"})->history().column("base_clearance_m").front();
  EXPECT_NEAR(raised - lies, 0.02, 1e-12);
  // a sixth of the altitude of triangles of 0.1 m, which Gmsh makes up to a fifth higher or lower than regular ones
  EXPECT_NEAR(lies, std::sqrt(0.75) * 0.1 / 6, 0.2 * 0.1 / 6);
}

/// A file with a section, which is removed at the end.
class SectionFile {
 public:
  explicit SectionFile(const std::string &text) {
    int process = static_cast<int>(getpid());  // of rank 0: other runs of the test have files of their own
    MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    name_ = std::string(P_tmpdir) + "/talus_section_" + std::to_string(process) + ".csv";
    if (rank() == 0) std::ofstream(name_) << "part,x,y\n" << text;
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  ~SectionFile() {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank() == 0) std::remove(name_.c_str());
  }
  SectionFile(const SectionFile &) = delete;
  SectionFile &operator=(const SectionFile &) = delete;
  const std::string &name() const { return name_; }

 private:
  static int rank() {
    int rank;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    return rank;
  }

  std::string name_;
};

/// The section of incline_block whose base has relief: its nodes, one cell apart, are up to 7 mm above or below the
/// mean plane, so that neighbouring facets differ by up to 12 degrees.
constexpr double rough_size = 0.125, roughness = 0.007;  // [m]
std::string rough_section() {
  const auto base = [](const char *part) {
    std::ostringstream out;
    unsigned seed = 1;
    for (int i = 0; i <= 64; ++i) {
      seed = seed * 1664525u + 1013904223u;
      const bool level = i == 0 || i == 4 || i == 12 || i == 64;  // the ends, and those of the block
      out << part << "," << i * rough_size << "," << (level ? 0 : roughness * ((seed >> 8) / double(1 << 23) - 1))
          << "\n";
    }
    return out.str();
  };
  return base("outline") +
         "outline,8,1\noutline,0,1\ninterface0,0.5,0\ninterface0,0.5,0.5\ninterface0,1.5,0.5\ninterface0,1.5,0\n"
         "region_block,1,0.25\nregion_air,4,0.5\n" +
         base("b_base");
}

/// Friction angle that the base has mobilised in the mean since a time [degrees].
double mobilised_friction(const AnySimulation &simulation, double since) {
  const auto time = simulation.history().column("time_s"), x = simulation.history().column("base_force_x_N"),
             y = simulation.history().column("base_force_y_N");
  double along = 0, across = 0;
  for (size_t i = 1; i < time.size(); ++i)
    if (time[i - 1] > since) along -= x[i] * (time[i] - time[i - 1]), across += y[i] * (time[i] - time[i - 1]);
  return std::atan2(along, across) * 180 / M_PI;
}

struct Slid {
  double rise, lowest, friction_angle;  ///< of the middle, height of the lowest particle [m]; effective [degrees]
};
/// The block slides by 2 m.
Slid slide_on_relief(const std::vector<std::string> &more) {
  const SectionFile section(rough_section());
  std::vector<std::string> overrides{"mesh.section=" + section.name(), "mesh.size=" + std::to_string(rough_size),
                                     "output.interval=0"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  Scene scene = read_scene(block, overrides);
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  const auto heights = [&] {  // mean and least of the particles
    const Snapshot now = simulation->snapshot();
    const Column &position = now.columns.front();
    double sums[] = {0, static_cast<double>(now.id.size())}, least = 1e9;
    for (size_t i = 0; i < now.id.size(); ++i) {
      const double y = position.values[i * position.components + 1];
      sums[0] += y, least = std::min(least, y);
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
    return std::pair(sums[0] / sums[1], least);
  };
  const double before = heights().first;
  simulation->run();  // ends with an error if a particle leaves the mesh
  const auto [after, lowest] = heights();
  return {after - before, lowest, mobilised_friction(*simulation, 0.2)};
}

/// A base with relief is a plane in the mean: the block neither climbs from facet to facet, 84 mm where each facet was
/// a constraint of its own, nor is it slowed down.
TEST(FrictionalBase, elastic_block_slides_along_relief) {
  const Slid slid = slide_on_relief({});
  EXPECT_NEAR(slid.rise, 0, roughness);
  EXPECT_NEAR(slid.friction_angle, 20, 0.5);
}
/// The lowest particle stays within a quarter of a cell.
TEST(FrictionalBase, soil_that_yields_stays_on_relief) {
  const Slid slid = slide_on_relief({"body.block.law=mohr_coulomb", "body.block.friction_angle=35",
                                     "body.block.cohesion=20e3", "body.block.poisson_ratio=0.3"});
  EXPECT_LT(slid.lowest, 0.25 * rough_size);
  EXPECT_NEAR(slid.friction_angle, 20, 0.5);
}

/// An elastic block of 8 m by 2 m keeps its friction in cells of an eighth of a metre over 7 m of way. Where friction
/// adapts within ten times the way of a wave through such a cell, it vibrates as a whole in the end, the more the
/// faster it slides, and has 18.3 degrees over the last 0.4 s (Adams 1995; docs/theory (6.2)). A shorter way does not
/// show it.
TEST(FrictionalBase, elastic_block_keeps_its_friction_in_fine_cells) {
  const SectionFile section(
      "outline,0,0\noutline,20,0\noutline,20,3\noutline,0,3\ninterface0,1,0\ninterface0,1,2\ninterface0,9,2\n"
      "interface0,9,0\nregion_block,5,1\nregion_air,15,2\nb_base,0,0\nb_base,20,0\n");
  Scene scene =
      read_scene(block, {"mesh.section=" + section.name(), "mesh.size=0.125", "output.interval=0",
                         "stage.0.duration=2.8", "body.block.young_modulus=50e6", "body.block.poisson_ratio=0.3",
                         "body.block.stress=[\"0\", \"-2000 * 8.495709211125343 * (2 - y)\", \"0\", \"0\"]"});
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->run();
  EXPECT_NEAR(mobilised_friction(*simulation, 2.4), 20, 0.5);
}

/// Elastic rock that rests on two planes with a kink between them, as finite elements have found it, stays at rest when
/// motion takes over. At the kink both planes bear it. Where each took what it met alone, 46 MN were missing there at
/// once, and the rock crept: 2e-2 m/s after these 20 ms, in which a wave comes 50 m far. What is left is round-off: the
/// weight alone would give 0.2 m/s.
void expect_rest_on_two_planes(std::vector<std::string> overrides) {
  for (const char *more : {"body.rock.cohesion=1e9", "output.interval=0",
                           "stage=[{name='gravity', kind='quasi_static', duration=1, hold_loads=true}, "
                           "{name='settle', duration=0.02, hold_loads=true}]"})
    overrides.emplace_back(more);
  const Ended simulation(std::string(TALUS_GALLERY) + "/vaiont/scene.toml", overrides);
  const Snapshot end = simulation->snapshot();
  double fastest = 0;
  for (const Column &column : end.columns)
    if (column.name == "velocity")
      for (const double value : column.values) fastest = std::max(fastest, std::abs(value));
  MPI_Allreduce(MPI_IN_PLACE, &fastest, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_LT(fastest, 1e-12);
  const std::string said = "unbalanced force ratio of the particles that take it over ";
  double unbalanced = -1;
  for (const Event &event : simulation->events())
    if (const size_t place = event.text.find(said); place != std::string::npos)
      unbalanced = std::stod(event.text.substr(place + said.size()));
  EXPECT_GE(unbalanced, 0) << "not said";
  EXPECT_LT(unbalanced, 1e-9);
}
TEST(FrictionalBase, rock_stays_at_rest_on_two_planes) { expect_rest_on_two_planes({"mesh.size=20"}); }
/// The mirror image too, where the planes come in the other order. There the forces on the kink were reported as out of
/// balance, and damped, because a plane that sticks without pressing left them to the plane before it.
TEST(FrictionalBase, rock_stays_at_rest_on_two_planes_that_are_mirrored) {
  constexpr double length = 1605;  // from end to end, so that the water of the scene spans both
  std::ifstream drawn(std::string(TALUS_GALLERY) + "/../../meshes/vaiont.csv");
  std::string mirrored, line;
  while (std::getline(drawn, line)) {
    std::istringstream parts(line);
    std::string part, x, y;
    if (line.empty() || line[0] == '#' || !std::getline(parts, part, ',') || part == "part") continue;
    std::getline(parts, x, ','), std::getline(parts, y, ',');
    mirrored += part + "," + std::to_string(length - std::stod(x)) + "," + y + "\n";
  }
  const SectionFile section(mirrored);
  expect_rest_on_two_planes({"mesh.size=20", "mesh.section=" + section.name(), "output.point={}", "output.line={}"});
}
/// In a slice all nodes of the base are on rollers too, which bear the thrust of the rock between them: friction is not
/// spent on it. Where the rollers acted after the base, the rock moved by 4 m in 40 s.
TEST(FrictionalBase, rock_stays_at_rest_on_two_planes_in_a_slice) {
  expect_rest_on_two_planes({"mesh.size=30", "dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller"});
}

/// Speeds of a soil of the block's scene at the end of its stage: root mean square of the velocities that results show,
/// and that of the kinetic energy [m/s].
std::array<double, 2> speeds_at_end(std::vector<std::string> overrides, int dim, bool wet, double duration) {
  const auto add = [&](std::initializer_list<std::string> more) { overrides.insert(overrides.end(), more); };
  add({"body.block.young_modulus=1e6", "body.block.poisson_ratio=0.25", "output.interval=0"});
  if (dim == 3) {
    add({"dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller"});
    add({"body.block.stress=['0', '0', '0', '0', '0', '0']"});
  } else {
    add({"body.block.stress=['0', '0', '0', '0']"});
  }
  if (wet)
    add({"phases=saturated", "water.bulk_modulus=2e6", "water.excess=0", "body.block.porosity=0.4",
         "body.block.grain_density=2650", "body.block.permeability=1e-9"});
  overrides.push_back("stage.0.duration=" + std::to_string(duration));
  const Ended simulation(
      std::string(TALUS_VERIFICATION) + (wet ? "/wet_incline/scene.toml" : "/incline_block/scene.toml"), overrides);
  const Snapshot end = simulation->snapshot();
  double sums[] = {0, static_cast<double>(end.id.size())};
  for (const Column &column : end.columns)
    if (column.name == "velocity")
      for (const double v : column.values) sums[0] += v * v;
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  const double kinetic = simulation->history().column("kinetic_J").back();
  return {std::sqrt(sums[0] / sums[1]), std::sqrt(2 * kinetic / simulation->mass())};
}

/// A block on an incline that is rough enough to hold it swings and comes to rest: round-off in dry soil, the last of
/// its consolidation in saturated soil.
TEST(FrictionalBase, block_on_rough_incline_is_at_rest) {
  for (const int dim : {2, 3})
    for (const bool wet : {false, true}) {
      const std::string gravity = dim == 2 ? "gravity=[4.905, -8.4957]" : "gravity=[4.905, -8.4957, 0]";
      for (const double speed :
           speeds_at_end({gravity, "boundary.base.friction_angle=40", "mesh.size=0.25", "stage.0.damping=0.1"}, dim,
                         wet, dim == 3 && wet ? 30 : 100))
        EXPECT_LT(speed, wet ? 1e-5 : 1e-12) << dim << "D" << (wet ? ", saturated" : "");
    }
}

/// A layer of sand slides over bends of its bed at up to 3 m/s and comes to rest: the velocities that results show, and
/// those of the energy. Single grains may still roll.
TEST(FrictionalBase, thin_soil_comes_to_rest_on_relief) {
  const char *bed[] = {"0,1.4", "2,0.3", "2.6,0.4", "3.4,0.1", "4,0.2", "7,0.1"};
  std::string text;
  for (const char *place : bed) text += std::string("outline,") + place + "\n";
  text +=
      "outline,7,1.8\noutline,0,1.8\ninterface0,0.5,1.125\ninterface0,0.6,1.33\ninterface0,1.6,0.78\n"
      "interface0,1.6,0.52\nregion_block,1,0.95\nregion_air,4,1.5\n";
  for (const char *place : bed) text += std::string("b_base,") + place + "\n";
  const SectionFile section(text);
  for (const auto &[dim, wet] : {std::pair{2, false}, std::pair{2, true}, std::pair{3, false}})
    for (const double speed :
         speeds_at_end({"mesh.section=" + section.name(), "mesh.size=0.2", "gravity=9.81",
                        "body.block.law=mohr_coulomb", "body.block.friction_angle=33", "body.block.cohesion=0",
                        "boundary.base.friction_angle=22", "stage.0.damping=0"},
                       dim, wet, wet ? 40 : 20))
      EXPECT_LT(speed, 5e-3) << dim << "D" << (wet ? ", saturated" : "");
}

/// An elastic block of 1 m by 0.2 m with 3.5 m/s slides on a base that weakens over 0.3 m of slip, and stops
/// after 2.061 m (elastic_block.py). Its front comes to fresh ground, and goes 1.2 % too far in cells of 0.1 m, 0.8 %
/// in cells of 0.06 m: friction follows the normal force with its delay, in which the block goes up to 4 % of its
/// length (docs/theory, section 7).
double way_on_weakening_base(std::vector<std::string> overrides) {
  const SectionFile section(
      "outline,0,0\noutline,6,0\noutline,6,0.6\noutline,0,0.6\ninterface0,0.5,0\ninterface0,0.5,0.2\n"
      "interface0,1.5,0.2\ninterface0,1.5,0\nregion_block,1,0.1\nregion_air,4,0.3\n");
  overrides.push_back("mesh.section=" + section.name());
  for (const char *more :
       {"boundary.base.friction_angle='8 + 22 * exp(-slip / 0.3)'", "stage.0.duration=1.8", "output.interval=0"})
    overrides.emplace_back(more);
  const Ended simulation(block, overrides);
  const Snapshot end = simulation->snapshot();
  double sums[] = {0, static_cast<double>(end.id.size())};
  for (const Column &column : end.columns)
    if (column.name == "displacement")
      for (size_t i = 0; i < end.id.size(); ++i) sums[0] += column.values[i * column.components];
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return sums[0] / sums[1];
}
TEST(FrictionalBase, weakens_with_the_slip_of_the_place) {
  constexpr double exact = 2.061;
  for (const char *size : {"0.1", "0.06"})
    EXPECT_NEAR(way_on_weakening_base({std::string("mesh.size=") + size, "gravity=[0, -9.81]",
                                       "body.block.velocity=['3.5 + 0 * x', '0 * x']",
                                       "body.block.stress=['0', '-2000 * 9.81 * (0.2 - y)', '0', '0']"}),
                exact, 0.015 * exact)
        << size;
  EXPECT_NEAR(
      way_on_weakening_base({"mesh.size=0.1", "dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller",
                             "gravity=[0, -9.81, 0]", "body.block.velocity=['3.5 + 0 * x', '0 * x', '0 * x']",
                             "body.block.stress=['0', '-2000 * 9.81 * (0.2 - y)', '0', '0', '0', '0']"}),
      exact, 0.015 * exact);
}

}  // namespace
}  // namespace talus
