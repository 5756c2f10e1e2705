// Checkpoints of a run: what the recorder writes, and whether a run may go on from what it finds.
#include <filesystem>

#include "base/version.h"
#include "output/together.h"
#include "scene/changes.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/words.h"
#include "simulation/recorder.h"

namespace talus {
namespace {

/// Why a key of the scene must be what it was: what the saved state has from it.
std::string tie_of(const std::string &table) {
  if (table == "mesh") return "particles, stresses and contacts in the checkpoint belong to the cells of the mesh";
  if (table == "rigid") return "the checkpoint holds places, velocities and contacts of rigid bodies";
  if (table == "contact") return "the checkpoint holds what contacts between groups remember";
  if (table == "grids") return "functions of place take their values from it";
  if (table == "boundary") return "the checkpoint holds reactions, contacts and work of the boundaries as they were";
  return "the saved state has come about with it";
}

}  // namespace

template <int dim>
CheckpointHeader Recorder<dim>::checkpoint_header(int stage) const {
  CheckpointHeader header;
  header.program = program, header.scene = scene_.root ? scene_.root->values() : "", header.stage = stage;
  header.time = of_.clock.time, header.step = of_.clock.steps, header.number = checkpoints_ + 1;
  MPI_Comm_size(of_.world.comm, &header.ranks);
  const BackgroundMesh<dim> &mesh = of_.world.mesh;
  header.mesh = mesh.fingerprint();
  header.partition.resize(header.ranks);
  const unsigned long long mine = mesh.partition_fingerprint();
  MPI_Allgather(&mine, 1, MPI_UNSIGNED_LONG_LONG, header.partition.data(), 1, MPI_UNSIGNED_LONG_LONG, of_.world.comm);
  for (const Cut &cut : mesh.cuts())
    header.cuts.insert(header.cuts.end(), {cut.place, static_cast<double>(cut.axis), static_cast<double>(cut.patch)});
  return header;
}

template <int dim>
void Recorder<dim>::write_checkpoint(int stage, const Archive &state) {
  talus::write_checkpoint(of_.world.comm, options_.directory, checkpoint_header(stage), state);
  ++checkpoints_, checkpoint_time_ = of_.clock.time;
}

/// Only what the saved state does not depend on may differ: results, what becomes of particles that leave the mesh (up
/// to the checkpoint either none has left, or they have been taken out), the search for factors of safety, how long
/// stages last that have not ended, and the length of the steps to come.
template <int dim>
Checkpoint Recorder<dim>::find_checkpoint() {
  const std::string refusal = "the run in " + options_.directory + " cannot be resumed: ";
  Checkpoint checkpoint;
  const CheckpointHeader &found = checkpoint.header, mine = checkpoint_header(-1);
  try {
    checkpoint = read_checkpoint(of_.world.comm, options_.directory);
  } catch (const std::invalid_argument &error) {
    throw SceneError(refusal + error.what() + "; run the scene without --resume" +
                     (std::filesystem::exists(options_.directory + "/history.csv")
                          ? ", with --force to replace what is there"
                          : ""));
  }
  if (found.program != mine.program)
    throw SceneError(refusal + "it is one of " + found.program + ", this is " + mine.program);
  changed_ = changed_keys(found.scene, mine.scene);
  for (const std::string &path : changed_) {
    const std::vector<std::string> words = split(path);
    const bool listed = words.size() > 1 && words[0] == "stage";
    const int stage = listed ? std::stoi(words[1]) : 0;
    const bool result = words[0] == "title" || words[0] == "acknowledge" || words[0] == "factor_of_safety" ||
                        path == "mesh.leaving_particles" || path == "mesh.balance_ranks" ||
                        path == "integrator.fraction" ||
                        (words[0] == "output" && words.size() > 1 && words[1] != "point");
    const bool to_come =
        listed &&
        (stage > found.stage || (stage == found.stage && (words.back() == "duration" || words.back() == "rest_speed")));
    if (!result && !to_come)
      scene_.complain(
          path,
          "is not what it was when the run in " + options_.directory + " began, and " + tie_of(words[0]) +
              "; with --resume only title, acknowledge, [output] without its points, [factor_of_safety], "
              "mesh.leaving_particles, mesh.balance_ranks, integrator.fraction, duration and rest_speed of the present "
              "stage and the stages after it "
              "may change (repeat the --set of that run)");
  }
  if (found.ranks != mine.ranks) written_ranks_ = found.ranks;
  return checkpoint;
}

template <int dim>
void Recorder<dim>::take_checkpoint(const Checkpoint &found) {
  checkpoints_ = found.last_number, checkpoint_time_ = found.header.time, passed_over_ = found.passed_over;
}

template <int dim>
void Recorder<dim>::serialize(Archive &archive) {
  archive.serialize("results", last_row_step_, last_row_time_, snapshots_, impulse_time_, told_escaped_);
  fluids_.serialize(archive);
  point_rows_.serialize(archive);
  ends_.serialize(archive);
  of_.lines.serialize(archive);
  std::string lines = archive.reading() ? "" : from_first_rank(of_.world.comm, to_lines(events_));
  archive.serialize("events", lines);
  if (archive.reading()) events_ = events_in(lines);
}

template CheckpointHeader Recorder<2>::checkpoint_header(int) const;
template CheckpointHeader Recorder<3>::checkpoint_header(int) const;
template void Recorder<2>::write_checkpoint(int, const Archive &);
template void Recorder<3>::write_checkpoint(int, const Archive &);
template Checkpoint Recorder<2>::find_checkpoint();
template Checkpoint Recorder<3>::find_checkpoint();
template void Recorder<2>::take_checkpoint(const Checkpoint &);
template void Recorder<3>::take_checkpoint(const Checkpoint &);
template void Recorder<2>::serialize(Archive &);
template void Recorder<3>::serialize(Archive &);

}  // namespace talus
