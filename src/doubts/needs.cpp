#include "doubts/needs.h"

#include <petsctime.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/rounded.h"
#include "doubts/doubts.h"
#include "physics/boundary/boundary.h"
#include "scene/boundary_source.h"
#include "scene/output_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/transfer_source.h"
#include "scene/water_source.h"

namespace talus {
namespace {

constexpr int burst_length = 40;
constexpr double longest_burst = 5;  // [s]

BodyNeeds needs_of(const BodyReport &report, const Law &law) {
  BodyNeeds b{report, law};
  b.density = report.mass / report.volume;
  b.wave_speed = std::sqrt(constrained_modulus(b.law) / b.density);
  b.shear_speed = std::sqrt(shear_modulus(b.law) / b.density);
  return b;
}

LayerNeeds layer_of(const Start &start, const std::vector<BodyNeeds> &bodies) {
  const Scene &scene = start.scene;
  LayerNeeds layer;
  double volume = 0, softness = 0, slowness = 0;
  for (const BodyNeeds &b : bodies) {
    if (!b.there()) continue;
    volume += b.body.volume;
    softness += b.body.volume / constrained_modulus(b.law), slowness += b.body.volume / b.wave_speed;
  }
  const double gravity = scene.gravity_size();
  for (int d = 0; d < scene.dimension; ++d)
    layer.height = gravity > 0 ? layer.height + start.extent(d) * std::abs(scene.gravity[d]) / gravity
                               : std::max(layer.height, start.extent(d));
  if (gravity > 0 && std::abs(scene.gravity[start.up]) == gravity && start.depth > 0) layer.height = start.depth;
  layer.modulus = volume / softness, layer.transit = layer.height * slowness / volume;
  return layer;
}

/// Takes some steps and times them, after a few that touch the memory first.
void burst(AnySimulation &simulation, Scene &scene, Needs &needs) {
  PetscLogDouble start, now;
  double mine[2] = {0, 0}, all[2];
  const double interval = scene.transfer->remap_interval;
  double time = 0, end = 0;  // of the motion with which the run begins; steps beyond its end are timed and no more [s]
  for (const Stage &stage : scene.stage) {
    if (stage.is_static()) break;
    end += stage.duration;
  }
  try {
    for (int i = 0; i < 3; ++i) time += simulation.single_step();
    for (const Column &column : simulation.snapshot().columns)  // of a state that has not broken off
      mine[1] += 8. * static_cast<double>(column.values.size());
    const auto timed = [&](int most, double longest, int &steps, double &seconds) {
      PetscTime(&start);
      for (int over = 0; steps < most && !over;) {
        time += simulation.single_step();
        PetscTime(&now);
        ++steps, seconds = (now - start) / steps;
        over = now - start > longest;
        MPI_Allreduce(MPI_IN_PLACE, &over, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
      }
    };
    timed(burst_length, longest_burst, needs.burst_steps, needs.seconds_per_step);
    scene.transfer->remap_interval = 0;
    int remaps = 0;
    timed(burst_length / 2, longest_burst / 2, remaps, needs.seconds_per_remap);
    needs.seconds_per_remap = std::max(needs.seconds_per_remap, needs.seconds_per_step);
  } catch (const RunError &error) {
    if (time < end)
      needs.burst_failure = error.what();
    else
      scene.forget_function_faults();
  }
  scene.transfer->remap_interval = interval;
  (void)PetscMemoryGetCurrentUsage(&mine[0]);
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  needs.memory = all[0], needs.results = all[1];
}

Drainage drainage_of(const Scene &scene, const Needs &needs) {
  Drainage d;
  for (std::size_t i = 0; i < needs.stages.size() && needs.gravity > 0; ++i)
    if (!scene.stage[i].is_static()) d.time += needs.stages[i].duration;
  if (d.time == 0) return d;
  const double unit = scene.water->density * needs.gravity * needs.layer.height * needs.layer.height /
                      (needs.layer.modulus * d.time);  // at which T = 1
  d.drained_above = drained_factor * unit, d.undrained_below = undrained_factor * unit;
  return d;
}

/// Tries each function of time over the stages, and over a box around the soil if it knows the place too. Those whose
/// value their key does not admit remember it. Functions of the place alone have been used where they are needed.
void sample_functions(const Start &start) {
  constexpr int times = 100, places = 4;  // intervals
  const double end = end_of_loads(start.scene);
  if (start.height() < 0) return;  // later stages add all soil
  start.scene.root->each_expression([&](const Function &function) {
    const auto points = [&](const char *variable, int most) { return function.uses(variable) ? most + 1 : 1; };
    const int n[] = {points("x", places), points("y", places), points("z", places), points("slip", places),
                     points("t", times)};
    if (n[3] * n[4] == 1) return;
    for (int k = 0; k < n[0] * n[1] * n[2] * n[3] * n[4]; ++k) {
      double share[5];  // of the way along each
      for (int d = 0, rest = k; d < 5; rest /= n[d++]) share[d] = rest % n[d] / std::max(1., n[d] - 1.);
      const auto at = [&](int d) { return start.low[d] + start.extent(d) * share[d]; };
      // slips up to the width of the soil, most of them small
      const double slip = share[3] > 0 ? start.extent(0) * std::pow(0.1, places * (1 - share[3])) : 0;
      (void)function(at(0), at(1), at(2), end * share[4], start.high[1], slip);
    }
  });
}

/// Asks the friction of each base, and the water table that drained soil meets there, for their values where soil lies
/// and downhill of it. Values that a key does not admit, as beyond a grid, are remembered by the scene. Collective.
void try_ground_downhill(const Scene &scene, const AnySimulation &simulation) {
  const bool drained = scene.phases == PhaseModel::drained && scene.water->table.given();
  for (const BoundarySource &source : scene.boundary) {
    const Boundary kind = read_boundary(source.kind);
    for (const auto &[x, y, z] : simulation.downhill(source.group.empty() ? std::vector{source.name} : source.group)) {
      for (const auto &value : {kind.friction_coefficient, kind.adhesion})
        if (value) (void)value(x, y, z, 0, 0);
      if (kind.friction_coefficient && drained) (void)scene.water->table.at(x, y, z);
    }
  }
}

/// The most important first. Functions are tried before a run breaks off by them.
void advise(const Start &start, const AnySimulation &simulation, Needs &needs) {
  const Scene &scene = start.scene;
  std::vector<std::string> &all = needs.advice;
  if (!needs.burst_failure.empty())
    all.push_back("The run breaks off in its first steps: " + needs.burst_failure + ".");
  const auto add = [&all](const std::vector<std::string> &more) { all.insert(all.end(), more.begin(), more.end()); };
  add(needs.mesh.remarks);
  const char *where =
      ". A run ends where it needs such a value; the function was tried all over the soil and the stages.";
  if (!scene.function_fault().empty()) where = "";  // the burst has broken off by it
  if (*where) sample_functions(start);
  if (scene.function_fault().empty()) {
    where = ". That place lies downhill of the soil: the run ends if a slide comes so far.";
    try_ground_downhill(scene, simulation);
  }
  if (const std::string fault = scene.function_fault(); *where && !fault.empty()) all.push_back(fault + where);
  add(doubts_about(start));
  Doubts doubts(scene);
  doubt_before_run(start, needs.drainage, doubts);
  add(doubts.sentences());
}

}  // namespace

double Needs::longest_run_time() const {
  return seconds_per_step > 0 ? run_time() * seconds_per_remap / seconds_per_step : 0;
}

double Needs::run_time() const {
  return std::accumulate(stages.begin(), stages.end(), 0.,
                         [](double sum, const auto &stage) { return sum + stage.run_time; });
}

long long Needs::particles() const {
  return std::accumulate(bodies.begin(), bodies.end(), 0LL,
                         [](long long sum, const auto &b) { return sum + b.body.particles; });
}

Needs find_needs(Scene &scene, bool with_model) {
  RunOptions options;
  options.pictures = options.screen = false;
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  Needs needs{};
  if (with_model) needs.model = simulation->model();
  needs.mesh = simulation->mesh_report();
  needs.gravity = scene.gravity_size();
  double fastest = 0;
  const Start start(scene, *simulation);
  const std::vector<BodyReport> &reports = start.bodies;
  const std::vector<Softening> softening = softening_of(scene, start.laws, reports);
  for (std::size_t b = 0; b < reports.size(); ++b) {
    needs.bodies.push_back(needs_of(reports[b], start.laws[b]));
    needs.bodies[b].softening = softening[b];
    fastest = std::max(fastest, needs.bodies[b].wave_speed);
    if (reports[b].critical_step < reports[needs.slowest].critical_step) needs.slowest = static_cast<int>(b);
  }
  needs.layer = layer_of(start, needs.bodies);
  const StepRule rule = step_rule(read_integrator(scene.integrator, fluids_move(scene.phases)));
  needs.critical_step = simulation->critical_step();
  std::vector<double> critical_steps;
  for (const Stage &stage : scene.stage)
    critical_steps.push_back(stage.damping_frequencies()[1] > 0 ? simulation->critical_step(stage.damping_frequencies())
                                                                : needs.critical_step);
  needs.step_bound = simulation->step_bound();
  needs.altitude_rule = needs.mesh.smallest_altitude / fastest;
  needs.fixed_step = rule.fixed > 0;
  needs.step = needs.fixed_step ? rule.fixed : rule.share * needs.critical_step;
  MPI_Comm_size(PETSC_COMM_WORLD, &needs.ranks);
  burst(*simulation, scene, needs);
  needs.snapshots = 1;
  for (const Stage &stage : scene.stage) {
    if (stage.is_static()) {  // by finite elements: no waves, no steps of the motion
      needs.stages.push_back({stage.name, stage.duration,
                              stage.finite_elements() ? static_cast<double>(stage.finite_elements()->load_steps) : 0, 0,
                              0, 0});
      continue;
    }
    const double critical = critical_steps[needs.stages.size()];
    const double steps = std::ceil(stage.duration / (needs.fixed_step ? needs.step : rule.share * critical));
    needs.stages.push_back({stage.name, stage.duration, steps, steps * needs.seconds_per_step,
                            stage.duration / needs.layer.transit, stage.damping_frequencies()[1] > 0 ? critical : 0});
    needs.snapshots +=
        scene.output->interval > 0 ? static_cast<long long>(std::ceil(stage.duration / scene.output->interval)) : 1;
  }
  needs.results *= static_cast<double>(needs.snapshots);
  needs.drainage = drainage_of(scene, needs);
  advise(start, *simulation, needs);
  return needs;
}

std::string spoken(double seconds) {
  const std::pair<double, const char *> units[] = {{86400, "d"}, {3600, "h"},  {60, "min"},
                                                   {1, "s"},     {1e-3, "ms"}, {1e-6, "us"}};
  for (const auto &[size, name] : units)
    if (seconds >= size) return rounded(seconds / size, 3) + " " + name;
  return rounded(seconds, 3) + " s";
}

}  // namespace talus
