#pragma once
/// Runs of one scene with different overrides, each a process of its own, several at a time; for commands that compare
/// runs. A run that was completed before is not repeated, unless a file that it has read is another one since.
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands/commands.h"
#include "commands/comparison.h"
#include "output/results_folder.h"
#include "scene/scene.h"

namespace talus {

/// One run and its cost.
struct Trial {
  std::string label;                   ///< for progress lines
  std::vector<std::string> overrides;  ///< key.path=value, in addition to those of all runs
  std::string folder;                  ///< of its results
  bool done = false, failed = false;   ///< failed: it ended with an error
  std::string cause;                   ///< the last message of a run that failed
  double cpu = 0, wall = 0;            ///< of the whole process, meshing included [s]
};

/// Options of all commands that compare runs.
struct TrialOptions {
  std::string directory;  ///< of runs, tables and pictures
  std::vector<std::string> set;
  int jobs = 0;  ///< runs at the same time; 0: one per core
  bool force = false, no_plot = false, no_umat = false;
};
/// Adds them, and returns --set.
CLI::Option *add_trial_options(CLI::App &command, TrialOptions &options, const std::string &meaning_of_set,
                               const std::string &meaning_of_output);

/// What all runs have in common.
struct TrialPlan {
  std::string scene;                        ///< file
  std::vector<std::string> set;             ///< overrides
  const TrialOptions &options;              ///< force: runs of another plan in the same folders, and failed runs, are
                                            ///< replaced; no_umat: no run loads a library
  std::vector<std::string> command{"run"};  ///< of each run, with its options
  /// What is read off history.csv: the stages must last so long, and a column that no history of the scene has is
  /// refused before anything runs; the first run under way that lacks one ends all.
  std::vector<Measure> measures{};
  bool refusal_ends = true;  ///< a run that is refused as bad input ends all; else it is one that failed
};

/// Runs are missing: the user ended the command, or something from outside ended some of them.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The scene with all that other rooms read of it later: laws, boundaries and the integrator. Throws SceneError where a
/// key or a value of any of them is refused, with `no_umat` also a law that loads a library.
Scene read_wholly(const std::string &file, const std::vector<std::string> &set, bool no_umat);

/// Words with a space between them.
std::string joined(const std::vector<std::string> &words);

/// What is wrong with a list of keys of a scene that take values together, as a sentence that goes on from it: two are
/// the same key, or one lies in the table at another. Empty if nothing is.
std::string same_keys(const Scene &scene, const std::vector<std::string> &keys);

/// Columns that the tables of all commands have of each run: `escaped_share` is the share of the soil that left the
/// mesh.
inline const std::vector<std::string> columns_of_trials{
    "folder", "processor_s", "wall_s", "failure", "escaped_mass_kg", "escaped_share", "warning_count", "warnings"};

/// The runs of one command and their tables.
class Trials {
 public:
  /// Reads the scene of every run, which refuses bad keys before anything runs (SceneError). Keeps other programs out
  /// of the folder as long as this object lives, and marks the runs as done that were completed there before with the
  /// same scene, overrides and files.
  Trials(const TrialPlan &plan, const std::vector<Trial *> &trials);

  /// Runs the others, `jobs` at a time. A progress line per run goes to standard error. Throws SceneError where a run
  /// is refused or lacks a column, and Interrupted after SIGINT or SIGTERM, which end the runs under way too, or where
  /// a run was killed; called again, the command continues with the missing runs.
  void run();

  /// A table of the runs that are done, FOLDER/NAME: the cells that a command has for a run, and those of all commands.
  /// A run without cells is left out.
  void write(const std::string &name, const std::vector<std::string> &columns,
             const std::function<std::vector<std::string>(std::size_t run)> &cells) const;
  /// Starts the script that prints tables and draws pictures, and says what the runs warned of, one sentence for all
  /// warnings that differ in their numbers alone. Returns the status of the script.
  int tell(const std::string &script, const std::vector<std::string> &words = {}) const;

 private:
  void mark_done();

  const TrialPlan &plan_;
  std::vector<Trial *> trials_;
  std::vector<std::string> described_;           ///< what each run is: its command, overrides and scene
  std::vector<std::vector<std::string>> files_;  ///< that each run reads, as FilesRead has them
  std::optional<FolderLock> lock_;
};

/// Unit of a number without one at a key of a scene, such as body.clay.cohesion; empty where it has none.
std::string unit_of_key(const std::string &key);

/// A value of a key as tables and charts have it: a number in the unit that was typed, else in that of its key; an
/// expression, a list or a word as it was typed.
struct KeyValue {
  std::string text, unit;
  bool number = false;
};
KeyValue value_at(const std::string &key, const std::string &typed);

/// Brings values of one key to the unit of the first of them, so that they may share an axis: "0.01 MPa" after "4 kPa"
/// becomes 10 kPa. Throws SceneError where one of them is no number and has another unit.
void share_unit(const std::string &key, const std::vector<KeyValue *> &values);

/// To be called first by every program: a run that Trials has started ends by SIGTERM when the program that started
/// it is gone, even killed. Programs that the run starts itself are not concerned.
void end_with_starter();
/// To be called by what handles SIGTERM: a run whose starter is gone has some seconds to end in order, also in the
/// midst of a mesh or an equilibrium, and is ended then. Safe in a signal handler.
void end_soon_without_starter();

/// To be called with the exit status of every program: a run that Trials has started says by another status that a
/// signal has ended it.
int status_for_starter(int status);

/// Refuses to start on several ranks (SceneError): the runs are processes of their own.
void require_one_rank(const std::string &command);

}  // namespace talus
