#include "doubts/needs.h"

#include <petsctime.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "doubts/doubts.h"
#include "doubts/scales.h"
#include "physics/boundary/boundary.h"
#include "scene/body_source.h"
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

BodyNeeds needs_of(const BodyReport &report, const Law &law, const BodySource &source) {
  BodyNeeds b{report, law};
  b.averaging_length = source.averaging_length;
  b.density = report.mass / report.volume;
  b.wave_speed = std::sqrt(constrained_modulus(b.law) / b.density);
  b.shear_speed = std::sqrt(shear_modulus(b.law) / b.density);
  return b;
}

LayerNeeds layer_of(const Start &start, const std::vector<BodyNeeds> &bodies, double gravity) {
  const Scene &scene = start.scene;
  LayerNeeds layer;
  double mass = 0, volume = 0, softness = 0, slowness = 0;
  std::array<double, 3> low = bodies[0].body.low, high = bodies[0].body.high;
  const double water = fluids_move(scene.phases) ? scene.water->density : 0;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodyNeeds &b = bodies[k];
    if (!(b.body.volume > 0)) continue;  // a stage adds it
    mass += b.body.mass + scene.body[k].porosity * water * b.body.volume, volume += b.body.volume;
    softness += b.body.volume / constrained_modulus(b.law), slowness += b.body.volume / b.wave_speed;
    for (int d = 0; d < 3; ++d) low[d] = std::min(low[d], b.body.low[d]), high[d] = std::max(high[d], b.body.high[d]);
  }
  for (int d = 0; d < scene.dimension; ++d) {
    const double extent = high[d] - low[d];
    layer.height =
        gravity > 0 ? layer.height + extent * std::abs(scene.gravity[d]) / gravity : std::max(layer.height, extent);
  }
  const bool downwards = gravity > 0 && std::abs(scene.gravity[scene.vertical()]) == gravity;
  if (downwards && start.depth > 0) layer.height = start.depth;
  const double density = mass / volume;
  layer.modulus = volume / softness, layer.wave_speed = volume / slowness;
  layer.transit = scales::transit(layer.height, layer.wave_speed);
  layer.gravity_stress = density * gravity * layer.height;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodyNeeds &b = bodies[k];
    const double above =
        downwards ? start.depth_of(k, std::min(layer.height, high[start.up] - b.body.low[start.up])) : layer.height;
    layer.gravity_strain =
        std::max(layer.gravity_strain, scales::own_weight_strain(density, gravity, above, constrained_modulus(b.law)));
  }
  layer.settlement = scales::settlement(density, gravity, layer.height, layer.modulus);
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
  if (needs.gravity == 0) return d;
  for (std::size_t i = 0; i < needs.stages.size(); ++i)
    if (!scene.stage[i].is_static()) d.time += needs.stages[i].duration;
  if (d.time == 0) return d;
  for (const Stage &stage : scene.stage) d.computed |= stage.water_flows();
  const double water_weight = scene.water->density * needs.gravity;
  const auto bound = [&](double factor) {
    return scales::conductivity_at(factor, needs.layer.modulus, water_weight, d.time, needs.layer.height);
  };
  d.drained_above = bound(scales::drained_factor), d.undrained_below = bound(scales::undrained_factor);
  for (const BodySource &body : scene.body)
    if (body.porosity > 0)
      d.drag_relaxation =
          std::max(d.drag_relaxation, scales::drag_relaxation(d.drained_above, body.porosity, needs.gravity));
  return d;
}

std::vector<HeatedBaseNeeds> heated_bases_of(const Scene &scene, const Needs &needs) {
  double time = 0;
  for (const Stage &stage : scene.stage)
    if (!stage.is_static()) time += stage.duration;
  const BodyReport &soil = needs.bodies.front().body;
  double middle[3];
  for (int d = 0; d < 3; ++d) middle[d] = (soil.low[d] + soil.high[d]) / 2;
  std::vector<HeatedBaseNeeds> bases;
  for (const BoundarySource &source : scene.boundary) {
    const Boundary kind = read_boundary(source.kind);
    if (!kind.shear_zone) continue;
    const auto way = [&](double diffusivity) { return std::sqrt(4 * diffusivity * time); };
    bases.push_back({source.name,
                     kind.shear_zone->weakening_slip(kind.friction_coefficient(middle[0], middle[1], middle[2], 0, 0)),
                     way(kind.shear_zone->thermal_diffusivity()), way(kind.shear_zone->hydraulic_diffusivity()), time});
  }
  return bases;
}

/// Tries each function of time over the stages, and over a box around the soil if it knows the place too. Those whose
/// value their key does not admit remember it. Functions of the place alone have been used where they are needed.
void sample_functions(const Scene &scene, const std::vector<BodyReport> &bodies) {
  constexpr int times = 100, places = 4;  // intervals
  double end = 0;
  for (const Stage &stage : scene.stage)
    if (!stage.hold_loads) end += stage.duration;
  std::array<double, 3> low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const BodyReport &body : bodies)
    for (int d = 0; d < 3; ++d) low[d] = std::min(low[d], body.low[d]), high[d] = std::max(high[d], body.high[d]);
  scene.root->each_expression([&](const Function &function) {
    const auto intervals = [&](const char *variable, int most) { return function.uses(variable) ? most : 0; };
    const int n[3] = {intervals("x", places), intervals("y", places), intervals("z", places)};
    const int last = intervals("t", times), slips = intervals("slip", places);
    if (last == 0 && slips == 0) return;
    const auto at = [&](int d, int i) { return low[d] + (high[d] - low[d]) * i / std::max(1, n[d]); };
    for (int k = 0; k <= last; ++k)
      for (int a = 0; a <= n[0]; ++a)
        for (int b = 0; b <= n[1]; ++b)
          for (int c = 0; c <= n[2]; ++c)
            for (int s = 0; s <= slips; ++s)  // up to the width of the soil, most of them small
              (void)function(at(0, a), at(1, b), at(2, c), end * k / std::max(1, last), high[1],
                             s > 0 ? (high[0] - low[0]) * std::pow(0.1, places - s) : 0);
  });
}

/// Asks the friction of each base, and the water table that drained soil meets there, for their values where soil lies
/// and downhill of it. Values that a key does not admit, as beyond a grid, are remembered by the scene. Collective.
void try_ground_downhill(const Scene &scene, const AnySimulation &simulation) {
  for (const BoundarySource &source : scene.boundary) {
    const Boundary kind = read_boundary(source.kind);
    const std::vector<std::array<double, 3>> places =
        simulation.downhill(source.group.empty() ? std::vector{source.name} : source.group);
    for (const auto &value : {kind.friction_coefficient, kind.adhesion})
      for (const auto &[x, y, z] : places)
        if (value) (void)value(x, y, z, 0, 0);
    const WaterTable &table = scene.water->table;
    for (const auto &[x, y, z] : places)
      if (kind.friction_coefficient && table.given() && scene.phases == PhaseModel::drained) (void)table.at(x, y, z);
  }
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
    needs.bodies.push_back(needs_of(reports[b], start.laws[b], scene.body[b]));
    needs.bodies[b].softening = softening[b];
    fastest = std::max(fastest, needs.bodies[b].wave_speed);
    if (reports[b].critical_step < reports[needs.slowest].critical_step) needs.slowest = static_cast<int>(b);
  }
  needs.layer = layer_of(start, needs.bodies, needs.gravity);
  needs.doubts = doubts_about(start);
  Doubts cells(scene);  // which a run does not repeat
  doubt_cells(start, cells);
  needs.doubts.insert(needs.doubts.end(), cells.sentences().begin(), cells.sentences().end());
  const StepRule rule = step_rule(read_integrator(scene.integrator, fluids_move(scene.phases)));
  needs.critical_step = simulation->critical_step();
  needs.step_bound = simulation->step_bound();
  needs.altitude_rule = needs.mesh.smallest_altitude / fastest;
  needs.fixed_step = rule.fixed > 0;
  needs.usual_step = rule.share * needs.critical_step;
  needs.step = needs.fixed_step ? rule.fixed : needs.usual_step;
  MPI_Comm_size(PETSC_COMM_WORLD, &needs.ranks);
  burst(*simulation, scene, needs);
  if (scene.function_fault().empty()) {  // else the burst has broken off by it
    sample_functions(scene, reports);
    needs.function_fault = scene.function_fault();
  }
  if (scene.function_fault().empty()) {
    try_ground_downhill(scene, *simulation);
    needs.downhill_fault = scene.function_fault();
  }
  needs.snapshots = 1;
  for (const Stage &stage : scene.stage) {
    if (stage.is_static()) {  // by finite elements: no waves, no steps of the motion
      needs.stages.push_back({stage.name, stage.duration,
                              stage.finite_elements() ? static_cast<double>(stage.finite_elements()->load_steps) : 0, 0,
                              0});
      continue;
    }
    const double steps = std::ceil(stage.duration / needs.step);
    needs.stages.push_back(
        {stage.name, stage.duration, steps, steps * needs.seconds_per_step, stage.duration / needs.layer.transit});
    needs.snapshots +=
        scene.output->interval > 0 ? static_cast<long long>(std::ceil(stage.duration / scene.output->interval)) : 1;
  }
  needs.results *= static_cast<double>(needs.snapshots);
  needs.heated_bases = heated_bases_of(scene, needs);
  needs.drainage = drainage_of(scene, needs);
  return needs;
}

}  // namespace talus
