#pragma once
/// What a run tells: rows of history.csv, snapshots, notes, checkpoints, and why it ended. It reads the world and the
/// clock and changes nothing that the answer depends on.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "earthquake/ground_path.h"
#include "output/checkpoint.h"
#include "output/events.h"
#include "output/history.h"
#include "output/output_field.h"
#include "output/progress.h"
#include "output/results_folder.h"
#include "output/snapshots.h"
#include "simulation/dynamics.h"
#include "simulation/energy_ledger.h"
#include "simulation/fluid_books.h"
#include "simulation/followed_lines.h"
#include "simulation/mesh_ends.h"
#include "simulation/statics.h"
#include "simulation/structure_tables.h"
#include "simulation/tracked_points.h"

namespace talus {

template <int dim>
struct RunRow;
struct GroundRow;

/// What results are made from.
template <int dim>
struct Sources {
  World<dim> &world;
  const Clock &clock;
  const Dynamics<dim> &dynamics;
  Statics<dim> &statics;
  TrackedPoints<dim> &points;
  FollowedLines<dim> &lines;
  EnergyLedger<dim> &energies;
};

template <int dim>
class Recorder {
 public:
  /// Throws SceneError where the scene asks for pictures that nobody can draw, or for results at times that lie closer
  /// than steps. Collective.
  Recorder(const Sources<dim> &of, const RunOptions &options);

  /// Opens the files of a new run, or those of the run that was read from a checkpoint.
  void open();
  void append(std::unique_ptr<ResultsFolder> folder);
  /// Ends the files, with `last_words` in the log unless they are empty, and draws the pictures. Throws RunError if
  /// these cannot be drawn.
  void close(const std::string &last_words = "");
  bool writes() const { return results_ != nullptr; }  ///< files, not only the table in memory

  void begin_stage(const Stage &stage);  ///< one of the scene
  void progress();                       ///< after each step
  /// During a search for equilibrium: number of an iteration, and force out of balance over the forces that act.
  void seeking(int iteration, double out_of_balance);
  /// A row of the history, or a snapshot, of the present state; none twice for the same step. Collective.
  void write_history();
  void write_snapshot();
  /// The state as it would be written. Collective.
  Snapshot snapshot();
  /// Writes down what happens in the present stage, now if the event has no time.
  void record(Event event);
  /// The same, and says so on the screen and in the log.
  void tell(const Event &event);
  void note(const std::string &text, const char *kind = event::remark, const EventValues &values = {}) {
    tell({kind, text, values});
  }
  void warn(const std::string &text, const char *kind = event::warning, const EventValues &values = {}) {
    tell({kind, text, values, true});
  }
  /// Has an event of this kind happened since that time [s]?
  bool happened(const char *kind, double since) const;
  /// At the end: how much energy was created in all, where it was told that some is.
  void note_created_energy() {
    if (of_.energies.watch().told()) warn("in all, " + of_.energies.watch().verdict(), event::created_energy);
  }
  /// Warns of ends of the mesh that cut a slide off, at the end of a run. Collective.
  void note_cut_off() {
    for (const std::string &sentence : ends_.cut_off()) warn(sentence, event::cut_off);
  }
  /// The same of the mechanism of a factor of safety. Collective.
  void note_cut_off(const typename MeshEnds<dim>::Soil &mechanism) {
    for (const std::string &sentence : ends_.cut_off(mechanism)) warn(sentence, event::cut_off);
  }
  /// Warns of soil that has left the mesh, at the end of a run. Collective.
  void note_lost_soil();
  /// Says that the mesh was divided in another way, which is expected to bring this imbalance.
  void note_balancing(double before, double expected);
  /// Ends the run: throws RunError with the cause, where the run stood and what is left of it; BrokenOff if pictures of
  /// that are wanted.
  [[noreturn]] void fail(const std::string &cause);

  FluidBooks &fluids() { return fluids_; }

  CheckpointHeader checkpoint_header(int stage) const;
  void write_checkpoint(int stage, const Archive &state);
  /// Reads the checkpoint of the run in the directory and refuses a run that this one cannot go on with; notes which
  /// keys have changed. Collective.
  Checkpoint find_checkpoint();
  /// Did `find_checkpoint` find another value of this key?
  bool has_changed(const std::string &key) const { return std::ranges::find(changed_, key) != changed_.end(); }
  /// Goes on with it.
  void take_checkpoint(const Checkpoint &found);
  void serialize(Archive &archive);

  const HistoryTable &history() const { return history_; }
  const std::vector<Event> &events() const { return events_; }

 private:
  struct Files {
    std::unique_ptr<ResultsFolder> folder;  ///< locked while the run lasts
    RunFile file;
    History history;
    Progress progress;
    EventFile events;
  };
  void check_pictures();
  void check_intervals();
  RunHeader header() const;
  MeshPicture mesh_picture() const;
  void write_model() const;
  void name_columns();
  void write_columns() const;
  RunRow<dim> run_row() const;
  GroundRow ground_row() const;
  void note_imbalance();
  void note_sharing();
  void note_steps();
  void note_pressure_solves();
  void note_escaped();
  std::string ways_in_words();
  void write_escaped();
  double longest_duration() const;
  Snapshot particles();

  const Sources<dim> of_;
  const Scene &scene_;
  const PhaseTraits phases_;
  const RunOptions &options_;
  HistoryTable history_;
  std::vector<HistoryColumn> columns_;  ///< of history.csv, after time, step and stage
  std::vector<Event> events_;
  std::unique_ptr<Files> results_;
  FluidBooks fluids_;
  double impulse_time_ = 0;  ///< since when forces are means [s]
  PointRows<dim> point_rows_;
  StructureTables<dim> structures_;
  MeshEnds<dim> ends_;
  GroundPath ground_path_;
  long long shaken_before_ = 0;       ///< stages before the present one through which the motion has gone
  std::vector<std::string> changed_;  ///< keys of the scene that are others than before the run was resumed
  double told_escaped_ = 0;           ///< particles that had left when the log last said so
  double written_escaped_ = -1;       ///< particles in escaped.csv; -1: not known
  std::string passed_over_;           ///< what was wrong with a later checkpoint than the one that the run goes on from
  int written_ranks_ = 0;             ///< on which it ran before, if these are others
  double imbalance_at_start_ = 0;     ///< of particles; 0: not looked at yet
  long long last_row_step_ = -1, checkpoints_ = 0;
  long long snapshots_ = 0;                           ///< that the run has written
  double last_row_time_ = -1, checkpoint_time_ = -1;  ///< [s]
};

}  // namespace talus
