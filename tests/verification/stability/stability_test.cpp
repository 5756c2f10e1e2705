// Each integrator at and around its own stability limit, on a bar of tetrahedra: the step beyond which energy grows is
// that which omega_max of the filled mesh, by power iteration on the motion itself, foretells. With TALUS_STABILITY_CSV
// = FILE, energies over time are written there (docs/gallery/integrators/stability.py).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>

#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"
#include "soil.h"
#include "solvers/critical_step.h"
#include "solvers/integrators.h"

namespace talus {
namespace {

const std::string bar =
    std::string("phases = \"dry\"\ndimension = 3\ngravity = 0\n[mesh]\nsection = \"") + TALUS_MESHES + R"(/bar.csv"
size = 0.05
thickness = 0.1
layers = 0
[body.soil]
region = "soil"
density = 1000
young_modulus = "100 kPa"
poisson_ratio = 0.3
law = "linear_elastic"
[boundary.left]
kind = "fixed"
[[stage]]
duration = 1
[transfer]
relaxation = 0
remap_interval = 0.3
)";

struct Bar : Soil<3> {
  Bar() : Soil(bar, 0) { EXPECT_EQ(motion->begin(0), 0); }
  double energy() const {
    Balance sums;
    EXPECT_EQ(motion->balance(0, &sums), 0);
    return sums.kinetic + sums.strain;
  }
  /// omega_max [1/s] and its mode as velocities of the nodes; so small that nothing but the linear answer shows.
  double fastest(std::vector<double> &mode) {
    constexpr double small = 1e-7, iterations = 300;
    const int size = motion->size();
    std::vector<double> w(size), a(size), rest(size), unused(size);
    mode.resize(size);
    for (int i = 0; i < size; ++i) mode[i] = std::sin(1. + 13 * i);
    double square = 0;
    const auto norm = [](const std::vector<double> &x) {
      double sum = 0;
      for (double c : x) sum += c * c;
      return std::sqrt(sum);
    };
    EXPECT_EQ(motion->rates(0, nullptr, mode.data(), unused.data(), rest.data()), 0);
    for (int k = 0; k < iterations; ++k) {
      EXPECT_EQ(motion->rates(0, nullptr, mode.data(), w.data(), a.data()), 0);
      const double scale = small / norm(w);
      for (double &x : w) x *= scale;
      EXPECT_EQ(motion->rates(0, w.data(), mode.data(), unused.data(), a.data()), 0);
      for (int i = 0; i < size; ++i) a[i] -= rest[i];
      square = norm(a) / scale / norm(mode);
      const double length = norm(a);
      for (int i = 0; i < size; ++i) mode[i] = -a[i] / length;
    }
    return std::sqrt(square);
  }
};

struct Kind {
  const char *name;
  double limit;                                             ///< omega h
  std::function<std::unique_ptr<Integrator>(double)> make;  ///< with a fixed step [s]
};

template <class Settings>
Kind kind(const char *name, Settings settings) {
  return {name, 2 * settings.rule().limit, [settings](double step) mutable {
            settings.step = step;
            return settings.make();
          }};
}

std::vector<Kind> kinds() {
  std::vector<Kind> all{kind("euler", EulerSettings{})};
  for (int order : {2, 3, 4, 5}) {
    static const char *names[] = {"arkode 2", "arkode 3", "arkode 4", "arkode 5"};
    ArkodeSettings settings;
    settings.order = order;
    all.push_back(kind(names[order - 2], settings));
  }
  return all;
}

/// Energy after each step over the first, of a bar that starts in its fastest mode; ends when it has grown a
/// thousandfold.
std::vector<double> energies(const Kind &kind, double step, int steps, const std::vector<double> &mode) {
  Bar bar;
  double *v = bar.motion->velocity();
  for (int i = 0; i < bar.motion->size(); ++i) v[i] = 1e-5 * mode[i];
  const auto integrator = kind.make(step);
  std::vector<double> all;
  double t = 0, taken = 0;
  for (int i = 0; i < steps && (all.size() < 2 || all.back() < 1e3 * all.front()); ++i, t += taken) {
    EXPECT_EQ(integrator->advance(*bar.motion, t, {1, 1e9}, &taken), 0);
    all.push_back(bar.energy());
  }
  return all;
}

// Patches soften what the iteration of the program, which leaves them out, takes for the stiffness: it may be faster,
// by what that adds to the fastest mode; and power iteration is below what it tends to, by 1 % or 2 after 60 turns.
// Warm starts go on from there.
TEST(Stability, frequency_of_the_mesh_is_found_by_the_iteration_of_the_program) {
  Bar bar;
  std::vector<double> mode;
  const double omega = bar.fastest(mode);
  CriticalStep<3> bound(bar.mesh, bar.bodies[0]->law(), 1000);
  double safe = 1e300, found = 0;
  for (int c : bar.motion->grid().mesh_cell) safe = std::min(safe, bound(c));
  EXPECT_EQ(bar.motion->largest_frequency(60, &found), 0);
  std::printf("after 60 turns %.4f of omega_max\n", found / omega);
  EXPECT_GT(found, 0.97 * omega);
  EXPECT_LT(found, 2 / safe);
  EXPECT_EQ(bar.motion->largest_frequency(300, &found), 0);
  const double end = found;
  EXPECT_EQ(bar.motion->largest_frequency(6, &found), 0);
  EXPECT_NEAR(found, end, 0.01 * end);
}

/// The bar between smooth walls, shaken by its weight: elastic, without damping and relaxation.
struct Shaken {
  Shaken(const std::string &remap_interval, const std::string &bound)
      : scene(parse_scene(
            bar, "bar",
            {"gravity=9.81", "stage.0.duration=3", "output.interval=0", "output.history_interval=0.01",
             "boundary.base.kind=roller", "boundary.front.kind=roller", "boundary.back.kind=roller",
             "transfer.locking=none", "transfer.remap_interval=" + remap_interval, "integrator.omega_max=" + bound})),
        simulation(make_simulation(PETSC_COMM_WORLD, scene, options())) {}
  static RunOptions options() {
    RunOptions none;
    none.pictures = none.screen = false;
    return none;
  }
  Scene scene;
  std::unique_ptr<AnySimulation> simulation;
};

// Without patches, which soften the bar: at half of the frequency steps are 1.2 of the limit, and the energy grows
// until cells turn inside out. A sound run has its swings, which are equal but for the phase at which a row of the
// history finds them, and for what remaps add.
TEST(Stability, default_step_on_free_tetrahedra_is_that_of_the_mesh_and_stable) {
  for (const std::string remap_interval : {"0.1", "0"}) {
    Shaken by_default(remap_interval, "auto"), by_cells(remap_interval, "cells");
    EXPECT_GT(by_default.simulation->critical_step(), 2.5 * by_cells.simulation->critical_step());
    by_default.simulation->run();
    const std::vector<double> kinetic = by_default.simulation->history().column("kinetic_J");
    const auto middle = kinetic.begin() + static_cast<long>(kinetic.size() / 2);
    EXPECT_LT(*std::max_element(middle, kinetic.end()), 1.2 * *std::max_element(kinetic.begin(), middle))
        << remap_interval;
  }
}

TEST(Stability, limits_are_those_of_the_fastest_mode_within_5_percent) {
  std::vector<double> mode;
  Bar bar;
  const double omega = bar.fastest(mode);
  CriticalStep<3> bound(bar.mesh, bar.bodies[0]->law(), 1000);
  double safe = 1e300;
  for (int c : bar.motion->grid().mesh_cell) safe = std::min(safe, bound(c));
  std::printf("omega_max = %.6g / s; 2 / omega_max over the bound of single cells: %.3f\n", omega, 2 / omega / safe);
  EXPECT_GE(2 / omega, safe * (1 - 1e-9)) << "the bound that the program steps by is safe";
  for (const Kind &kind : kinds()) {
    double low = 0.9, high = 1.1;
    const double growth =
        std::string(kind.name) == "euler" ? 4 : 1.0005;  // euler sees velocity half a step late, and its energy swings
    const auto grows = [&](double share) {
      const auto e = energies(kind, share * kind.limit / omega, 400, mode);
      return e.back() > growth * e.front();
    };
    EXPECT_FALSE(grows(low)) << kind.name;
    EXPECT_TRUE(grows(high)) << kind.name;
    for (int k = 0; k < 4; ++k) (grows((low + high) / 2) ? high : low) = (low + high) / 2;
    std::printf("%-10s grows beyond %.3f of its limit\n", kind.name, (low + high) / 2);
    EXPECT_NEAR((low + high) / 2, 1, 0.05) << kind.name;
  }
  if (const char *path = std::getenv("TALUS_STABILITY_CSV")) {
    std::ofstream file(path);
    file << "integrator,share,step,energy\n";
    for (const Kind &kind : kinds())
      for (const double share : {0.5, 0.7, 0.9, 0.97, 1.03, 1.1, 1.2}) {
        const auto e = energies(kind, share * kind.limit / omega, 300, mode);
        for (size_t i = 0; i < e.size(); ++i)
          file << kind.name << "," << share << "," << i + 1 << "," << e[i] / e[0] << "\n";
      }
  }
}

}  // namespace
}  // namespace talus
