#pragma once
/// Runs of one scene with different overrides, each a process of its own, several at a time; for commands that compare
/// runs. A run that was completed before is not repeated.
#include <stdexcept>
#include <string>
#include <vector>

#include "commands/comparison.h"
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

/// What all runs have in common.
struct TrialPlan {
  std::string scene;                        ///< file
  std::vector<std::string> set;             ///< overrides
  int jobs = 0;                             ///< runs at the same time; 0: one per core
  std::vector<std::string> command{"run"};  ///< of each run, with its options
  bool replace = false;                     ///< runs of another plan in the same folders; else they are refused
  /// What is read off history.csv: the stages must last so long, and a column that no history of the scene has is
  /// refused before anything runs; the first run under way that lacks one ends all.
  std::vector<Measure> measures{};
  bool refusal_ends = true;  ///< a run that is refused as bad input ends all; else it is one that failed
};

/// The user ended the runs before all were done.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The scene with all that other rooms read of it later: laws, boundaries and the integrator. Throws SceneError where a
/// key or a value of any of them is refused.
Scene read_wholly(const std::string &file, const std::vector<std::string> &set);

/// Words with a space between them.
std::string joined(const std::vector<std::string> &words);

/// Reads the scene of every run, which refuses bad keys before anything runs (SceneError), marks the runs whose folder
/// has the results of the same scene, mesh and overrides as done, and runs the others, `jobs` at a time. A progress
/// line per run goes to standard error. Throws SceneError where a run is refused or lacks a column, and Interrupted
/// after SIGINT or SIGTERM, which end the runs under way too; called again, it continues with the missing runs.
void run_trials(const TrialPlan &plan, const std::vector<Trial *> &trials);

/// What the runs that are done warned of in their logs, one sentence for all that differ in their numbers alone; each
/// with the number of runs and the first of them.
struct SharedWarning {
  std::string sentence;  ///< as the first run has it
  int runs = 0;
  std::string first;  ///< folder of the first run, without the path
};
std::vector<SharedWarning> warnings_of(const std::vector<Trial *> &trials);
/// Writes them to FOLDER/warnings.csv, for the scripts.
void write_warnings(const std::string &folder, const std::vector<SharedWarning> &warnings);
/// Prints them, each once.
void print_warnings(const std::vector<SharedWarning> &warnings, std::size_t runs);
/// All warnings of one run as one text.
std::string warnings_of(const Trial &trial);

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

/// To be called first by every program: a run that run_trials has started ends by SIGTERM when the program that started
/// it is gone, even killed. Programs that the run starts itself are not concerned.
void end_with_starter();
/// To be called by what handles SIGTERM: a run whose starter is gone has some seconds to end in order, also in the
/// midst of a mesh or an equilibrium, and is ended then. Safe in a signal handler.
void end_soon_without_starter();

/// Refuses to start on several ranks (SceneError): the runs are processes of their own.
void require_one_rank(const std::string &command);

}  // namespace talus
