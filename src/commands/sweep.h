#pragma once
/// One scene run many times with other values, each run a process of its own, several at a time. `talus study` fills in
/// a sweep, and `talus compare` and `talus converge` do so as its presets: the list of runs, and what the tables,
/// pictures and statements of src/output/plots/talus_study.py need to know of it.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands/commands.h"
#include "commands/values.h"
#include "scene/scene.h"

namespace talus {

using Json = nlohmann::ordered_json;

/// One run.
struct Trial {
  std::vector<std::string> overrides{};  ///< key.path=value, in addition to those of all runs
  Json columns = Json::object();         ///< of the table, before those of all runs
  std::string folder{};                  ///< of its results, in that of the sweep; runNNNNN unless given
  Json record{};                         ///< what it is, reads and came to: its file `trial`
  bool done = false;
};

/// Options of all commands that sweep.
struct SweepOptions {
  std::string directory;         ///< of runs, table and pictures
  std::vector<std::string> set;  ///< given by --set
  int jobs = 0;                  ///< runs at the same time; 0: one per core
  bool force = false, no_plot = false, no_umat = false;
};
/// Adds them, and returns --set.
CLI::Option *add_sweep_options(CLI::App &command, SweepOptions &options, const std::string &meaning_of_set,
                               const std::string &meaning_of_output);

struct Sweep {
  std::string scene;             ///< file
  std::vector<std::string> set;  ///< overrides of all runs
  SweepOptions options;  ///< force: runs of another sweep in the same folders, and failed runs, are replaced; no_umat:
                         ///< no run loads a library
  /// Columns of history.csv: the stages must last so long, and one that no history of the scene has is refused before
  /// anything runs.
  std::vector<std::string> measures{};
  Json shown = Json::object();              ///< what the script is told beside the runs, `preset` first of all
  std::vector<std::string> command{"run"};  ///< of each run, with its options
  std::vector<Trial> trials{};
};

/// Folder of a run by its number.
std::string run_name(std::size_t number);

/// Performs a sweep: reads the scene of every run, which refuses bad keys before anything runs; keeps other programs
/// out of the folder; runs what was not completed there before with the same scene, overrides and files, a progress
/// line each; writes DIR/design.json and starts the script that makes DIR/study.csv, DIR/study.json and pictures of it.
/// Returns the status of the script. Throws SceneError where anything is refused, and std::runtime_error after SIGINT
/// or SIGTERM, which end the runs under way too, or where a run was killed: called again, the command continues with
/// the missing runs.
int perform(Sweep sweep);

/// What is wrong with a list of keys of a scene that take values together, as a sentence that goes on from it: two are
/// the same key, or one lies in the table at another. Empty if nothing is.
std::string same_keys(const Scene &scene, const std::vector<std::string> &keys);

/// Unit of a number without one at a key of a scene, such as body.clay.cohesion; empty where it has none.
std::string unit_of_key(const std::string &key);

}  // namespace talus
