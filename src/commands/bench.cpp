#include <petsctime.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>

#include "base/version.h"
#include "commands/bench_laws.h"
#include "commands/commands.h"
#include "commands/gallery.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

struct BenchArguments {
  bool json = false;
  int steps = 150;
  std::string only;
};

/// One case: what is measured and what it gave.
struct BenchCase {
  int dimension;
  std::string phases, law, transfer;
  int ranks = 1;
  long long particles = 0, cells = 0;  ///< cells that have particles at the end
  double rate = 0;                     ///< particle-updates per second and core
  double step_time = 0;                ///< wall time of a step [s]
  double simulated_per_wall = 0;       ///< simulated over wall time
  Breakdown breakdown{};               ///< [s] per particle and step
};

const std::vector<std::pair<std::string, std::string>> transfers = {
    {"default", ""},
    {"remap every step", "remap_interval = 0"},
    {"remap every step, stress per particle", "remap_interval = 0\naverage_stress = false"},
};

/// A block of soil that slumps: about 100,000 particles, 8 in a tetrahedron and 6 in a triangle.
std::string scene_text(const BenchCase &c, const std::string &law, const std::string &transfer) {
  const std::string phases = c.phases.substr(0, c.phases.find(','));
  const bool solid = c.dimension == 3, wet = phases != "dry", implicit = phases != c.phases;
  const bool moves = wet && phases != "drained";
  const std::string pores = moves ? "permeability = 1e-11\n" : "";
  const std::string curves =
      moves && phases != "saturated"
          ? "[body.soil.retention]\ncurve = \"van_genuchten\"\nreference_suction = 5e3\nshape = 0.4\n"
            "[body.soil.relative_permeability]\ncurve = \"van_genuchten_mualem\"\nshape = 0.4\n"
          : "";
  return "phases = \"" + phases + "\"\ndimension = " + std::to_string(c.dimension) +
         "\ngravity = 9.81\n[mesh]\nsection = \"" + std::string(TALUS_MESHES) + "/dam.csv\"\n" +
         (solid ? "size = 0.091\nthickness = 1\nlayers = 0\n" : "size = 0.0165\n") +
         "[body.soil]\nregion = \"soil\"\n" +
         (wet ? "porosity = 0.3\ngrain_density = 2650\n" + pores : "density = 2000\n") +
         "particles_per_cell = " + (solid ? "8" : "6") + "\nvelocity = [\"0.3\", \"0\"" + (solid ? ", \"0\"" : "") +
         "]\n" + law + "\n" + (wet ? curves + "[water]\ntable = [[0, 0.5], [4, 0.5]]\n" : "") +
         (implicit ? "pressure = \"implicit\"\n" : "") +
         "[boundary.base]\nkind = \"roller\"\n[boundary.left]\nkind = \"roller\"\n[boundary.right]\nkind = "
         "\"roller\"\n" +
         (solid ? "[boundary.front]\nkind = \"roller\"\n[boundary.back]\nkind = \"roller\"\n" : "") +
         "[[stage]]\nduration = 100\n[transfer]\n" + transfer + "\n";
}

void measure(BenchCase &c, const std::string &law, const std::string &transfer, int steps) {
  Scene scene = parse_scene(scene_text(c, law, transfer), "bench");
  RunOptions options;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  for (int i = 0; i < steps / 5; ++i) simulation->single_step();
  const Breakdown before = simulation->breakdown();
  const double simulated = simulation->time();
  PetscLogDouble start, end;
  PetscTime(&start);
  for (int i = 0; i < steps; ++i) simulation->single_step();
  PetscTime(&end);
  const double wall = end - start, updates = static_cast<double>(simulation->particles()) * steps;
  MPI_Comm_size(PETSC_COMM_WORLD, &c.ranks);
  c.particles = simulation->particles(), c.rate = updates / wall / c.ranks, c.step_time = wall / steps;
  c.simulated_per_wall = (simulation->time() - simulated) / wall;
  const Breakdown &after = simulation->breakdown();
  const double scale = c.ranks / updates;
  c.breakdown = {(after.gather - before.gather) * scale, (after.step - before.step) * scale,
                 (after.release - before.release) * scale, (after.relocate - before.relocate) * scale,
                 (after.sort - before.sort) * scale};
  for (const BodyReport &body : simulation->bodies()) c.cells += body.cells;
}

/// Updates of cells per second and core: between remaps the work is that of cells and not of particles.
double cell_rate(const BenchCase &c) {
  return c.rate * static_cast<double>(c.cells) / static_cast<double>(c.particles);
}

/// A scene of the gallery in motion: wall time per simulated second, between two simulated times of its first stage
/// [s].
struct BenchScene {
  std::string scene, transfer, override;
  double from, to;
  long long particles = 0, steps = 0, remaps = 0;
  int ranks = 1;
  double wall_per_simulated = 0;
};

const std::vector<BenchScene> scenes = {
    {"column", "default", "", 0.1, 0.3},
    {"column", "remap every step", "transfer.remap_interval=0", 0.1, 0.3},
    {"selborne_absolute", "default", "", 1, 3},
    {"selborne_absolute", "remap every step", "transfer.remap_interval=0", 1, 3},
};

void measure(BenchScene &s) {
  Scene scene =
      read_scene(find_scene(s.scene), s.override.empty() ? std::vector<std::string>{} : std::vector{s.override});
  RunOptions options;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  simulation->advance_to(s.from);
  const long long steps = simulation->steps(), remaps = simulation->remaps();
  PetscLogDouble start, end;
  PetscTime(&start);
  simulation->advance_to(s.to);
  PetscTime(&end);
  MPI_Comm_size(PETSC_COMM_WORLD, &s.ranks);
  s.particles = simulation->particles(), s.steps = simulation->steps() - steps,
  s.remaps = simulation->remaps() - remaps;
  s.wall_per_simulated = (end - start) / (s.to - s.from);
}

/// Memory bandwidth of one core, by the triad a = b + s c on arrays beyond the caches [B/s].
double bandwidth() {
  const size_t count = size_t{1} << 23;
  std::vector<double> a(count, 0), b(count, 1), c(count, 2);
  double best = 0;
  for (int round = 0; round < 5; ++round) {
    PetscLogDouble start, end;
    PetscTime(&start);
    for (size_t i = 0; i < count; ++i) a[i] = b[i] + 3 * c[i];
    PetscTime(&end);
    best = std::max(best, 3. * sizeof(double) * static_cast<double>(count) / (end - start));
  }
  return std::accumulate(a.begin(), a.end(), 0.) > 0 ? best : 0;
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

void print_json(const std::vector<BenchCase> &cases, const std::vector<BenchScene> &scenes,
                const std::vector<LawRate> &rates) {
  nlohmann::ordered_json page;
  page["machine"] = {{"processor", processor()},
                     {"cores", std::thread::hardware_concurrency()},
                     {"memory_bandwidth_per_core", bandwidth()},
                     {"program", std::string("Talus ") + version}};
  for (const char *list : {"cases", "scenes", "laws"}) page[list] = nlohmann::ordered_json::array();
  for (const BenchCase &c : cases)
    page["cases"].push_back({{"dimension", c.dimension},
                             {"phases", c.phases},
                             {"law", c.law},
                             {"transfer", c.transfer},
                             {"ranks", c.ranks},
                             {"particles", c.particles},
                             {"cells", c.cells},
                             {"updates_per_second_per_core", c.rate},
                             {"cell_updates_per_second_per_core", cell_rate(c)},
                             {"wall_seconds_per_simulated_second", 1 / c.simulated_per_wall},
                             {"breakdown_ns",
                              {{"step", 1e9 * c.breakdown.step},
                               {"to_particles", 1e9 * c.breakdown.release},
                               {"relocate_and_sort", 1e9 * c.breakdown.relocate},
                               {"to_nodes", 1e9 * c.breakdown.gather}}}});
  for (const BenchScene &s : scenes)
    page["scenes"].push_back({{"scene", s.scene},
                              {"transfer", s.transfer},
                              {"ranks", s.ranks},
                              {"particles", s.particles},
                              {"steps", s.steps},
                              {"remaps", s.remaps},
                              {"wall_seconds_per_simulated_second", s.wall_per_simulated}});
  for (const LawRate &one : rates)
    page["laws"].push_back(
        {{"law", one.law}, {"plane_ns", one.plane}, {"solid_ns", one.solid}, {"solid_with_tangent_ns", one.tangent}});
  std::printf("%s\n", page.dump(1).c_str());
}

void print_line(const BenchCase &c) {
  std::printf("%-3d %-19s %-32s %-38s %9lld %9.1f %9.1f |     %6.1f %7.1f %7.1f %7.1f | %.3g\n", c.dimension,
              c.phases.c_str(), c.law.c_str(), c.transfer.c_str(), c.particles, c.rate / 1e6, cell_rate(c) / 1e6,
              1e9 * c.breakdown.step, 1e9 * c.breakdown.release, 1e9 * c.breakdown.relocate, 1e9 * c.breakdown.gather,
              1 / c.simulated_per_wall);
  std::fflush(stdout);
}

struct Selected {
  BenchCase c;
  std::string keys, options;
};

/// The laws that are measured with each way of transfer; the others with the default one.
bool in_depth(const std::string &law) {
  return law == "linear_elastic" || law == "drucker_prager" || law == "mohr_coulomb" ||
         law == "mohr_coulomb, softening";
}

/// In which phase model a law is measured: dry, unless it reads suction; one law in each of the others.
bool measured_in(const std::string &phases, const std::string &law) {
  if (law.find("suction") != std::string::npos) return phases == "drained";
  return phases == "dry" || law == (phases == "drained" ? "mohr_coulomb, softening" : "drucker_prager");
}

/// All cases, those whose label contains `only`, or the one whose label it is.
std::vector<Selected> select(const std::string &only) {
  std::vector<Selected> chosen;
  for (int dimension : {2, 3})
    for (const std::string phases :
         {"dry", "drained", "saturated", "saturated, implicit", "unsaturated", "unsaturated, implicit", "three-phase"})
      for (const auto &[law, keys] : bench_soils())
        for (const auto &[transfer, options] : transfers) {
          if (!measured_in(phases, law) || (transfer != "default" && !in_depth(law))) continue;
          if (phases.ends_with("implicit") && transfer.ends_with("stress per particle")) continue;  // refused
          const std::string label = std::to_string(dimension) + " " + phases + " " + law + " " + transfer;
          const Selected one{{dimension, phases, law, transfer}, keys, options};
          if (label == only) return {one};
          if (label.find(only) != std::string::npos) chosen.push_back(one);
        }
  return chosen;
}

int bench(const BenchArguments &arguments) {
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  std::vector<BenchCase> cases;
  if (rank == 0 && !arguments.json) {
    std::printf("%s, %.1f GB/s a core\n\n", processor().c_str(), bandwidth() / 1e9);
    std::printf("%-3s %-19s %-32s %-38s %9s %9s %9s | ns: %6s %7s %7s %7s | %s\n", "dim", "phases", "law", "transfer",
                "particles", "M/s/core", "M cells/s", "step", "to_part", "relocate", "to_node", "wall s / simulated s");
  }
  for (const auto &[c, keys, options] : select(arguments.only)) {
    cases.push_back(c);
    BenchCase &done = cases.back();
    measure(done, keys, options, arguments.steps);
    if (rank == 0 && !arguments.json) print_line(done);
  }
  if (rank == 0 && !arguments.json)
    std::printf("\n%-12s %-25s %9s %7s %7s | %s\n", "scene", "transfer", "particles", "steps", "remaps",
                "wall s / simulated s");
  std::vector<BenchScene> measured;
  for (BenchScene s : scenes) {
    if ((s.scene + " " + s.transfer).find(arguments.only) == std::string::npos) continue;
    measure(s), measured.push_back(s);
    if (rank == 0 && !arguments.json)
      std::printf("%-12s %-25s %9lld %7lld %7lld | %.3g\n", s.scene.c_str(), s.transfer.c_str(), s.particles, s.steps,
                  s.remaps, s.wall_per_simulated);
  }
  std::vector<LawRate> rates;
  if (rank == 0 && std::string("laws alone").find(arguments.only) != std::string::npos) rates = measure_laws();
  if (!rates.empty() && !arguments.json) {
    std::printf("\n%-33s | ns per update alone: %7s %7s | %s\n", "law", "plane", "solid", "solid, with tangent");
    for (const LawRate &r : rates)
      std::printf("%-33s | %20s %7.1f %7.1f | %.0f\n", r.law.c_str(), "", r.plane, r.solid, r.tangent);
  }
  if (rank == 0 && arguments.json) print_json(cases, measured, rates);
  return 0;
}

}  // namespace

Action add_bench(CLI::App &app) {
  auto arguments = std::make_shared<BenchArguments>();
  CLI::App *command =
      app.add_subcommand("bench",
                         "measure updates of particles and of cells per second and core by dimension, phase model, law "
                         "and transfer, and the wall time per simulated second of two scenes");
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  command->add_option("--steps", arguments->steps, "steps of each case")->check(CLI::Range(10, 100000));
  command->add_option("--only", arguments->only,
                      "only the cases whose line contains this text, such as \"3 dry mohr\", or \"laws alone\"");
  return [arguments] { return bench(*arguments); };
}

}  // namespace talus
