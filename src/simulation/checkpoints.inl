// Checkpoints and how a run goes on from one: all that the answer depends on, wherever between two steps it is saved,
// so that neither a checkpoint nor an interruption changes the answer.
#include <algorithm>

#include "base/version.h"
#include "output/together.h"
#include "scene/changes.h"
#include "scene/reader.h"
#include "scene/words.h"
#include "simulation/simulation_impl.h"

namespace talus {

/// The state of this rank; the scene gives the rest. Collective.
template <int dim>
PetscErrorCode Simulation<dim>::serialize(Archive &archive) {
  PetscFunctionBeginUser;
  archive.serialize("clock", time_, load_time_, last_step_, steps_, remaps_, since_sort_, critical_step_, shrink_,
                    omega_max_, omega_step_, remap_due_, hold_loads_);
  archive.serialize("stage", stage_);
  archive.serialize("results", last_row_step_, last_row_time_, last_snapshot_time_, impulse_time_, first_ledger_,
                    first_energy_);
  for (const auto &body : bodies_) PetscCall(body->serialize(archive));
  PetscCall(motion_->serialize(archive));
  integrator_->serialize(archive);
  PetscFunctionReturn(0);
}

/// Tells meshes and partitions apart.
template <int dim>
unsigned long long Simulation<dim>::mesh_fingerprint() const {
  unsigned long long sum = fingerprint(mesh_.position.data(), mesh_.position.size() * sizeof(Vec<dim>));
  for (const Cell<dim> &cell : mesh_.cells) sum = fingerprint(cell.node.data(), sizeof cell.node, sum);
  return fingerprint(mesh_.global_cell.data(), mesh_.global_cell.size() * sizeof(long long), sum);
}

template <int dim>
CheckpointHeader Simulation<dim>::header() const {
  CheckpointHeader header{
      program, scene_.root ? scene_.root->values() : "", time_, steps_, checkpoints_ + 1, stage_.number, 0};
  MPI_Comm_size(comm_, &header.ranks);
  return header;
}

template <int dim>
void Simulation<dim>::write_checkpoint() {
  if (!results_) return;
  Archive archive;
  unsigned long long mesh = mesh_fingerprint();
  archive.serialize("mesh", mesh);
  require(serialize(archive));
  talus::write_checkpoint(comm_, options_.directory, header(), archive);
  ++checkpoints_, checkpoint_time_ = time_;
}

/// Only what the state does not depend on may differ: results, and how long stages last that have not ended.
template <int dim>
void Simulation<dim>::check_header(const CheckpointHeader &found) const {
  const CheckpointHeader mine = header();
  const std::string refusal = "the run in " + options_.directory + " cannot be resumed: ";
  if (found.program != mine.program)
    throw SceneError(refusal + "it is one of " + found.program + ", this is " + mine.program);
  for (const std::string &path : changed_keys(found.scene, mine.scene)) {
    const std::vector<std::string> words = split(path);
    const bool listed = words.size() > 1 && words[0] == "stage";
    const int stage = listed ? std::stoi(words[1]) : 0;
    const bool result = words[0] == "title" || (words[0] == "output" && words.size() > 1 && words[1] != "point");
    const bool to_come = listed && (stage > found.stage || (stage == found.stage && words.back() == "duration"));
    if (!result && !to_come)
      scene_.complain(path, "is not what it was when the run in " + options_.directory +
                                " began; with --resume only [output] without its points, the duration of the present "
                                "stage and the stages after it may change");
  }
  if (found.ranks != mine.ranks)
    throw SceneError(refusal + "it ran on " + std::to_string(found.ranks) + " ranks, not " +
                     std::to_string(mine.ranks) + "; give -n " + std::to_string(found.ranks));
}

template <int dim>
void Simulation<dim>::resume_results() {
  name_columns();
  const CheckpointHeader found = read_checkpoint_header(comm_, options_.directory);
  check_header(found);
  Archive archive = read_checkpoint(comm_, options_.directory, found);
  const std::string refusal = "the run in " + options_.directory + " cannot be resumed: ";
  unsigned long long mesh = 0;
  archive.serialize("mesh", mesh);
  int differs = mesh != mesh_fingerprint();
  MPI_Allreduce(MPI_IN_PLACE, &differs, 1, MPI_INT, MPI_MAX, comm_);
  if (differs) throw SceneError(refusal + "its mesh was another one; has the section or mesh file changed?");
  require(serialize(archive));
  checkpoints_ = found.number, checkpoint_time_ = found.time;
  RunFile file = RunFile::append(comm_, options_.directory, last_snapshot_time_);
  History rows = History::append(comm_, options_.directory + "/history.csv",
                                 {history_.names.begin() + 2, history_.names.end()}, last_row_time_);
  results_.reset(new Results{std::move(file), std::move(rows),
                             Progress(comm_, options_.directory + "/run.log", longest_duration(), true)});
  results_->progress.note("resumed at t = " + rounded(time_) + " s, step " + std::to_string(steps_));
}

}  // namespace talus
