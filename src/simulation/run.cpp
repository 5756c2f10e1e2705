// The parts of a run, and its checkpoints: all that the answer depends on, wherever between two steps it is saved, so
// that neither a checkpoint nor an interruption changes the answer.
#include "simulation/run.h"

#include <petsctime.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "scene/start_from.h"
#include "simulation/moved_before.h"
#include "simulation/start_from.h"

namespace talus {
namespace {

/// How the mesh was divided when the checkpoint was written with which a run goes on; nothing where that cannot be
/// known.
Cuts cuts_to_resume(MPI_Comm comm, const RunOptions &options) {
  Cuts cuts;
  if (!options.resume) return cuts;
  try {
    const CheckpointHeader header = read_checkpoint(comm, options.directory).header;
    for (std::size_t k = 0; k + 2 < header.cuts.size(); k += 3)
      cuts.push_back(
          {header.cuts[k], static_cast<long long>(header.cuts[k + 1]), static_cast<long long>(header.cuts[k + 2])});
  } catch (const std::invalid_argument &) {  // of which `resume` complains
  }
  return cuts;
}

}  // namespace

template <int dim>
Run<dim>::Run(MPI_Comm comm, const Scene &of, const RunOptions &with, const std::string &mesh_file)
    : scene(of),
      options(with),
      integrator(choose_integrator(of)),
      world(comm, of, with.plex, mesh_file, cuts_to_resume(comm, with)),
      points(world, options.mesh.corner),
      lines(world),
      dynamics((world.take_out_later_bodies(), world), clock, integrator),
      statics(world, clock),
      energies(world, clock, statics),
      recorder({world, clock, dynamics, statics, points, lines, energies}, options) {
  if (!scene.start_from->folder.empty() && !options.resume) start_from_other_run();
}

template <int dim>
void Run<dim>::begin_next_stage() {
  progress = StageProgress{progress.number + 1, clock.time};
  progress.resets = stage().reset_displacement;
  stop = make_stop_criterion<dim>(stage());
  dynamics.begin_stage();
}

template <int dim>
Balance Run<dim>::balance() {
  Balance sums;
  require(world.motion->begin(clock.time));
  require(world.motion->balance(clock.time, &sums));
  return sums;
}

template <int dim>
void Run<dim>::hand_to_particles() {
  if (!world.phases.liquid) return statics.to_particles();
  const std::vector<FluidLedger> had = fluids();
  statics.to_particles();
  recorder.fluids().hand_over(had, fluids(), statics.flow().take_entered());
}

template <int dim>
std::vector<FluidLedger> Run<dim>::fluids() {
  std::vector<FluidLedger> sums(world.phases.fluids());
  require(world.motion->fluid_ledger(sums.data()));
  return sums;
}

template <int dim>
void Run<dim>::reset_displacement() {
  statics.reset_displacement();
  world.reset_displacement(clock.time);
}

template <int dim>
void Run<dim>::end_by_reset() {
  double mass[2] = {0, 0};  // that has yielded, and all
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const ParticleArrays<dim> &p = world.bodies[b]->particles();
    for (int i = 0; i < p.count; ++i) {
      mass[1] += p.mass[i];
      if (world.motion->softened_by(static_cast<int>(b), i).plastic_strain > yielded) mass[0] += p.mass[i];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, mass, 2, MPI_DOUBLE, MPI_SUM, world.comm);
  const double elastic = elastic_settlement(world.report(), world.laws, scene.gravity_size(), dim, scene.vertical());
  const double largest = world.largest_displacement();
  const std::string sentence = moved_before_reset(stage().name, largest, elastic, mass[1] > 0 ? mass[0] / mass[1] : 0);
  if (!sentence.empty())
    recorder.warn(moved_before = sentence, event::moved_before_reset, {{"largest_displacement_m", largest}});
  reset_displacement();
}

/// What does not depend on stages, integrator and output of the scene, and so may be read by a run with others.
template <int dim>
PetscErrorCode Run<dim>::serialize_state(Archive &archive) {
  PetscFunctionBeginUser;
  clock.serialize(archive);
  archive.serialize("stage", progress.number, progress.begin, progress.met, progress.told, progress.resets);
  PetscCall(world.serialize(archive));
  statics.serialize(archive);
  PetscFunctionReturn(0);
}

/// The state of this rank; the scene gives the rest. Collective.
template <int dim>
PetscErrorCode Run<dim>::serialize(Archive &archive) {
  PetscFunctionBeginUser;
  PetscCall(serialize_state(archive));
  const bool staged = progress.number >= 0;  // a host program steps without stages
  if (archive.reading() && staged) stop = make_stop_criterion<dim>(stage());
  if (stop) stop->serialize(archive);
  archive.serialize("moved before", moved_before);
  energies.serialize(archive);
  recorder.serialize(archive);
  dynamics.serialize(archive);
  PetscFunctionReturn(0);
}

template <int dim>
void Run<dim>::write_checkpoint() {
  if (!recorder.writes() || !options.checkpoints) return;
  Archive archive;
  require(serialize(archive));
  recorder.write_checkpoint(progress.number, archive);
}

template <int dim>
Holdings Run<dim>::holdings() const {
  Holdings mine{world.mesh.global_cell, world.mesh.global_node};
  // edges have nodes of finite elements, if not in a stage of this scene then in one of the run that it starts from
  if (!scene.start_from->folder.empty() ||
      std::ranges::any_of(scene.stage, [](const Stage &s) { return s.is_static(); })) {
    const std::vector<long long> edges = world.mesh.global_edges();
    mine.points.insert(mine.points.end(), edges.begin(), edges.end());
  }
  return mine;
}

template <int dim>
Archive Run<dim>::state_of(Checkpoint found) const {
  if (found.header.mesh != world.mesh.fingerprint())
    throw std::invalid_argument(
        "its mesh was another one: the section, terrain or mesh file has changed since, or another build of the "
        "program meshed it");
  int rank, ranks;
  MPI_Comm_rank(world.comm, &rank), MPI_Comm_size(world.comm, &ranks);
  int same = found.header.ranks == ranks && found.header.partition[rank] == world.mesh.partition_fingerprint();
  MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_MIN, world.comm);
  if (same) return std::move(found.parts.front());
  return deal(world.comm, found.parts, holdings());
}

template <int dim>
void Run<dim>::balance_ranks(double end) {
  Balancing &balancing = dynamics.balancing();
  if (!dynamics.just_remapped() || !balancing.due()) return;
  PetscLogDouble start, now;
  require(PetscTime(&start));
  PartitionForecast forecast;
  const Cuts cuts = world.mesh.balanced_cuts(world.work_of_cells(clock.last_step, balancing.steps_before()),
                                             balancing.cost(), &forecast);
  if (!balancing.worth(forecast, (end - clock.time) / clock.last_step)) return;
  Archive state;
  require(serialize(state));
  world.divide(cuts);
  std::vector<Archive> part;
  part.emplace_back(std::move(state).bytes());
  state = deal(world.comm, part, holdings());
  part.clear();
  require(serialize(state));
  require(PetscTime(&now));
  const double before = balancing.smoothed();
  balancing.done(now - start);
  recorder.note_balancing(before, forecast.imbalance);
}

template <int dim>
void Run<dim>::resume() {
  Checkpoint found = recorder.find_checkpoint();
  auto folder = std::make_unique<ResultsFolder>(world.comm, options.directory, FolderUse::resume);
  recorder.take_checkpoint(found);
  try {
    Archive archive = state_of(std::move(found));
    require(serialize(archive));
  } catch (const std::invalid_argument &error) {
    throw SceneError("the run in " + options.directory + " cannot be resumed: " + error.what());
  }
  const auto changed = [this](const char *key) {
    return recorder.has_changed("stage." + std::to_string(progress.number) + "." + key);
  };
  if (changed("rest_speed") || (changed("duration") && stage().stop().waits_for_loads)) {
    progress.met = false;  // it has to stay below the new speed, and more loads may come within a longer duration
    stop = make_stop_criterion<dim>(stage());
  }
  recorder.append(std::move(folder));
}

/// A remap makes that what nodes and cells hold comes about anew, at time 0 and with the keys of this scene.
template <int dim>
void Run<dim>::start_from_other_run() {
  const std::string folder = scene.start_from->folder;
  std::error_code missing;
  if (!options.directory.empty() && std::filesystem::equivalent(folder, options.directory, missing))
    scene.complain("start_from.folder", "must not be the folder of this run's own results; choose another one with -o");
  try {
    Checkpoint found = read_checkpoint(world.comm, folder);
    const std::vector<std::string> changed = check_start(scene, found.header, recorder.checkpoint_header(-1));
    const std::vector<char> varies = world.strength_varies();
    for (std::size_t b = 0; b < varies.size(); ++b)
      if (varies[b]) check_strength_by_place(scene, world.bodies[b]->name(), changed);
    if (!found.passed_over.empty()) start_warning = found.passed_over + "; the checkpoint before it is taken";
    Archive archive = state_of(std::move(found));
    try {
      require(serialize_state(archive));
    } catch (const std::runtime_error &error) {
      throw std::invalid_argument(std::string("its particles bring other fields (") + error.what() +
                                  "); strength that varies with place there must do so here");
    }
    std::ostringstream from;
    from << "starts at the state of the run in " << folder << ", t = " << clock.time << " s, step " << clock.steps;
    if (world.motion->gathered()) require(world.release(clock.time));
    if (scene.start_from->reset_displacement || (progress.resets && (progress.met || progress.told)))
      reset_displacement(), from << ", with displacements set to zero";
    start_notes.push_back(from.str());
    for (const std::string &key : changed) start_notes.push_back("since then the scene has another " + key);
  } catch (const SceneError &) {
    throw;
  } catch (const std::invalid_argument &error) {
    scene.complain("start_from.folder",
                   std::string("must name the results of a run at whose state this one can start: ") + error.what());
  }
  world.escaped = {};
  clock = {}, progress = {};
}

/// The checkpoint comes first: what a run writes because it is interrupted must not be in the way when it goes on.
template <int dim>
void Run<dim>::heed(const Verdict &verdict) {
  if (!verdict.interrupted) return;
  write_checkpoint();
  recorder.write_history();
  recorder.write_snapshot();
  throw RunFailure("interrupted");
}

template <int dim>
const Stage &Run<dim>::stage() const {
  return scene.stage[progress.number];
}

template <int dim>
bool Run<dim>::last_stage() const {
  return progress.number + 1 == static_cast<int>(scene.stage.size());
}

template <int dim>
bool Run<dim>::leads_to_factor() const {
  return scene.stage.back().finds_factor() &&
         std::all_of(scene.stage.begin() + progress.number, scene.stage.end(), std::mem_fn(&Stage::is_static));
}

template <int dim>
bool Run<dim>::is_past_stage() const {
  return clock.time > (progress.begin + stage().duration) * (1 + 1e-9);
}

template struct Run<2>;
template struct Run<3>;

}  // namespace talus
