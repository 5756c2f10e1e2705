// The parts of a run, and its checkpoints: all that the answer depends on, wherever between two steps it is saved, so
// that neither a checkpoint nor an interruption changes the answer.
#include "simulation/run.h"

#include <filesystem>

#include "scene/reader.h"

namespace talus {

template <int dim>
Run<dim>::Run(MPI_Comm comm, const Scene &of, const RunOptions &with, const std::string &mesh_file)
    : scene(of),
      options(with),
      integrator(choose_integrator(of)),
      world(comm, of, with.plex, mesh_file),
      points(world),
      lines(world),
      dynamics((world.take_out_later_bodies(), world), clock, integrator),
      statics(world, clock),
      recorder({world, clock, dynamics, statics, points, lines}, options) {}

template <int dim>
void Run<dim>::begin_next_stage() {
  progress = StageProgress{progress.number + 1, clock.time};
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
  statics.to_particles();
  if (world.phases.liquid) recorder.recount_fluids();
}

/// The state of this rank; the scene gives the rest. Collective.
template <int dim>
PetscErrorCode Run<dim>::serialize(Archive &archive) {
  PetscFunctionBeginUser;
  clock.serialize(archive);
  archive.serialize("stage", progress);
  if (archive.reading()) stop = make_stop_criterion<dim>(stage());
  stop->serialize(archive);
  recorder.serialize(archive);
  PetscCall(world.serialize(archive));
  statics.serialize(archive);
  dynamics.serialize(archive);
  PetscFunctionReturn(0);
}

template <int dim>
void Run<dim>::write_checkpoint() {
  if (!recorder.writes() || !options.checkpoints) return;
  Archive archive;
  unsigned long long mesh = world.mesh_fingerprint();
  archive.serialize("mesh", mesh);
  require(serialize(archive));
  recorder.write_checkpoint(progress.number, archive);
}

template <int dim>
void Run<dim>::resume() {
  const CheckpointHeader found = recorder.check_checkpoint();
  auto folder = std::make_unique<ResultsFolder>(world.comm, options.directory, FolderUse::resume);
  Archive archive = read_checkpoint(world.comm, options.directory, found);
  unsigned long long mesh = 0;
  archive.serialize("mesh", mesh);
  int differs = mesh != world.mesh_fingerprint();
  MPI_Allreduce(MPI_IN_PLACE, &differs, 1, MPI_INT, MPI_MAX, world.comm);
  if (differs)
    throw SceneError("the run in " + options.directory +
                     " cannot be resumed: its mesh was another one; has the section or mesh file changed?");
  require(serialize(archive));
  recorder.take_checkpoint(found);
  recorder.append(std::move(folder));
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

template struct Run<2>;
template struct Run<3>;

}  // namespace talus
