#include "commands/sweep.h"

#include <petscsys.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <thread>

#include "base/start_program.h"
#include "commands/foreign_code.h"
#include "commands/history_columns.h"
#include "commands/starter.h"
#include "output/replace_file.h"
#include "output/results_folder.h"
#include "output/script.h"
#include "physics/boundary/boundary.h"
#include "physics/laws/law.h"
#include "scene/body_source.h"
#include "scene/boundary_source.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/stage.h"
#include "scene/words.h"
#include "simulation.h"
#include "simulation/scene_keys.h"
#include "solvers/integrators.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

/// Endings of files that are read with a file of the same name: by GDAL, and by the reader of meshes. Statistics that
/// viewers leave in .aux.xml change no result.
constexpr const char *companions[] = {".prj", ".tfw", ".wld", ".shx", ".dbf", ".cpg", ".origin.json"};

/// Digest of a file, which finds edited files and not forged ones.
std::string state_of(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  std::size_t digest = 0;
  for (std::string block(1 << 20, 0);
       file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount();)
    digest = 31 * digest + std::hash<std::string_view>{}({block.data(), static_cast<std::size_t>(file.gcount())});
  return std::to_string(digest);
}

/// The scene with all that other rooms read of it later: laws, boundaries and the integrator. Throws SceneError where a
/// key or a value of any of them is refused, with `no_umat` also a law that loads a library.
Scene read_wholly(const std::string &file, const std::vector<std::string> &set, bool no_umat) {
  Scene scene = read_scene(file, set);
  if (no_umat) refuse_umat(scene);
  for (const BodySource &body : scene.body) read_law(body.law);
  for (const BoundarySource &boundary : scene.boundary) read_boundary(boundary.kind);
  DeferredTable integrator = scene.integrator;
  read_integrator(integrator, fluids_move(scene.phases));
  return scene;
}

/// State of each file that the scene names, by its path: mesh, section, terrain, grids, libraries and all others of
/// TableReader::files, with the files that belong to them. Of a folder of results that of its checkpoint. `known` are
/// those that other scenes have named, so that each is read once.
Json files_of(const Scene &scene, std::map<std::string, std::string> &known) {
  std::set<std::string> paths;
  for (const std::string &named : scene.root->files()) {
    paths.insert(named);
    for (const char *ending : companions) paths.insert(fs::path(named).replace_extension(ending).string());
    std::error_code none;  // also where it is no folder
    for (const fs::directory_entry &entry : fs::directory_iterator(fs::path(named) / "checkpoint", none))
      paths.insert(entry.path().string());
  }
  Json files = Json::object();
  for (const std::string &path : paths) {
    if (!fs::is_regular_file(path)) continue;
    const auto [at, added] = known.try_emplace(path);
    if (added) at->second = state_of(path);
    files[path] = at->second;
  }
  return files;
}

/// Throws SceneError where the stages end before the time of a measure, or no history of the scene has its column.
void require_measure(const Scene &scene, const Measure &measure) {
  const std::vector<std::string> names = possible_columns(scene);
  if (!std::ranges::count(names, measure.column))
    throw SceneError("history.csv has no column " + measure.column + "; " + suggestion(measure.column, names));
  double end = 0;
  for (const Stage &stage : scene.stage) end += stage.duration;
  if (measure.time > end * (1 + 1e-9))
    throw SceneError("the measure " + measure.column + "@" + shortest(measure.time) +
                     " asks for t = " + shortest(measure.time) +
                     " s, and the stages of the scene end at t = " + shortest(end) + " s at the latest");
}

std::string last_line(const std::string &path) {
  std::ifstream file(path);
  std::string line, last;
  while (std::getline(file, line))
    if (!line.empty()) last = line;
  return last;
}

/// Did something from outside end a run, which then says nothing about its scene: who ended it, or the system for want
/// of memory? Other signals are faults of the program.
bool ended_from_outside(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status) == stopped_status;
  const int signal = WTERMSIG(status);
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP;
}

void write(const std::string &path, const Json &page) {
  replace_file(path, page.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// The runs of a sweep: begun, waited for, remembered.
class Runs {
 public:
  explicit Runs(Sweep &sweep);
  std::string run();
  int tell() const;
  std::size_t done() const { return static_cast<std::size_t>(std::ranges::count_if(trials_, &Trial::done)); }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

  std::string folder(const Trial &trial) const { return (fs::path(sweep_.options.directory) / trial.folder).string(); }
  std::string in_words(const Trial &trial) const {
    return trial.columns.value("series", "") + " " + join(trial.overrides, " ");
  }
  std::vector<std::string> overrides(const Trial &trial) const {
    std::vector<std::string> all = sweep_.set;
    all.insert(all.end(), trial.overrides.begin(), trial.overrides.end());
    return all;
  }
  void read_scenes();
  void find_done();
  bool start_next();
  void ended(Trial &trial, double wall, int status, const rusage &usage);

  Sweep &sweep_;
  std::vector<Trial> &trials_;
  std::optional<FolderLock> lock_;
  std::map<pid_t, std::pair<Trial *, Clock::time_point>> running_;  ///< and when it was started
  std::size_t next_ = 0, before_ = 0;                               ///< to be started; done before
  Clock::time_point begin_ = Clock::now();
};

Runs::Runs(Sweep &sweep) : sweep_(sweep), trials_(sweep.trials) {
  const std::string &directory = sweep.options.directory;
  if (!sweep.options.force && fs::exists(directory + "/run.h5"))
    throw SceneError(
        directory + " holds the results of a run; choose another folder with -o, or give --force to write beside them");
  read_scenes();
  make_folder(directory);
  if (!lock_.emplace(directory).taken())
    throw SceneError("another study, comparison or run is writing into " + directory +
                     "; wait for its end, or choose another folder with -o");
  find_done();
}

void Runs::read_scenes() {
  std::map<std::string, std::string> known;
  for (std::size_t i = 0; i < trials_.size(); ++i) try {
      Trial &trial = trials_[i];
      if (trial.folder.empty()) trial.folder = run_name(i);
      const Scene scene = read_wholly(sweep_.scene, overrides(trial), sweep_.options.no_umat);
      for (const std::string &measure : sweep_.measures) require_measure(scene, parse_measure(measure));
      trial.record = {{"run",
                       {{"command", join(sweep_.command, " ") + " " + sweep_.scene},
                        {"overrides", overrides(trial)},
                        {"scene", std::hash<std::string>{}(scene.root->values())}}},
                      {"files", files_of(scene, known)}};
    } catch (const SceneError &error) {
      throw SceneError("with " + join(trials_[i].overrides, " ") + ": " + error.what());
    }
}

/// Says which files have changed since runs were completed with them.
void Runs::find_done() {
  const bool force = sweep_.options.force;
  std::map<std::string, int> changed;  // path: runs
  for (Trial &trial : trials_) {
    std::ifstream file(folder(trial) + "/trial");
    Json before = Json::parse(file, nullptr, false);
    if (!before.is_object()) continue;
    if (before["run"] != trial.record["run"]) {
      if (force) continue;
      throw SceneError(folder(trial) + " holds a run with another scene or other values (" +
                       join(trial.overrides, " ") +
                       " is to run there); choose another folder with -o, or give --force to replace it");
    }
    const Json &then = before["files"], &now = trial.record["files"];
    Json all = then;
    all.update(now);
    for (const auto &[path, state] : all.items())
      if (then.value(path, "") != now.value(path, "")) ++changed[path];
    trial.done = then == now && !(force && before["failed"]);
    if (trial.done) trial.record = before;
  }
  for (const auto &[path, runs] : changed)
    std::fprintf(stderr, "%s has changed; runs to repeat: %d\n", path.c_str(), runs);
}

/// Starts the next run that is missing, once nobody writes into its folder any more. False where there is none.
bool Runs::start_next() {
  while (next_ < trials_.size() && trials_[next_].done) ++next_;
  if (next_ == trials_.size()) return false;
  Trial &trial = trials_[next_];
  const std::string into = folder(trial);
  fs::create_directories(into);
  while (!FolderLock(into).taken()) {  // a run of a program that was killed has some seconds to end
    if (interrupted) return false;
    usleep(10000);
  }
  for (const char *of_a_run_before : {"/trial", "/history.csv", "/events.jsonl"}) fs::remove(into + of_a_run_before);
  std::vector<std::string> words{"talus"};
  words.insert(words.end(), sweep_.command.begin(), sweep_.command.end());
  words.insert(words.end(), {sweep_.scene, "-o", into, "--no-pictures", "--force"});
  if (sweep_.options.no_umat) words.push_back("--no-umat");
  const std::vector<std::string> set = overrides(trial);
  if (!set.empty()) words.push_back("--set"), words.insert(words.end(), set.begin(), set.end());
  running_[start_program("/proc/self/exe", words, this_starter(), into + "/screen")] = {&trial, Clock::now()};
  ++next_;
  return true;
}

void Runs::ended(Trial &trial, double wall, int status, const rusage &usage) {
  const bool failed = !WIFEXITED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != undecided_status);
  if (failed && (interrupted || ended_from_outside(status))) {  // it is run again
    if (!interrupted) std::fprintf(stderr, "%s was ended from outside\n", folder(trial).c_str());
    return;
  }
  const auto seconds = [](const timeval &t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  std::string cause = failed ? last_line(folder(trial) + "/screen") : "";
  if (failed && cause.empty()) cause = "the run ended without a message";
  trial.record.update({{"failed", failed},
                       {"processor_s", seconds(usage.ru_utime) + seconds(usage.ru_stime)},
                       {"wall_s", wall},
                       {"cause", cause}});
  write(folder(trial) + "/trial", trial.record);
  trial.done = true;
  std::fprintf(stderr, "%zu of %zu: %s %s in %.3g s", done(), trials_.size(), in_words(trial).c_str(),
               failed ? "FAILED" : "done", wall);
  if (const std::size_t left = trials_.size() - done(); left > 0)
    std::fprintf(stderr, "; about %.0f s left",
                 seconds_since(begin_) / static_cast<double>(done() - before_) * static_cast<double>(left));
  std::fputc('\n', stderr);
}

/// Returns why runs are missing: the user ended the command, or something from outside ended some of them.
std::string Runs::run() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = 1; });
  const std::size_t jobs = sweep_.options.jobs ? static_cast<std::size_t>(sweep_.options.jobs)
                                               : std::max(1u, std::thread::hardware_concurrency());
  before_ = done();
  if (before_) std::fprintf(stderr, "%zu of %zu runs were completed before\n", before_, trials_.size());
  bool told = false;
  while (true) {
    if (interrupted && !told)
      for (const auto &[child, run] : running_) kill(child, SIGTERM);
    told = interrupted;
    while (running_.size() < jobs && !interrupted && start_next()) {
    }
    if (running_.empty() && (interrupted || next_ == trials_.size())) break;
    int status = 0;
    rusage usage{};
    const auto found = running_.find(wait4(-1, &status, WNOHANG, &usage));  // a signal may arrive at any time
    if (found == running_.end()) {
      usleep(10000);
      continue;
    }
    const auto [trial, began] = found->second;
    running_.erase(found);
    ended(*trial, seconds_since(began), status, usage);
  }
  if (done() == trials_.size()) return "";
  if (interrupted) return "interrupted; the same command continues with the missing runs";
  return std::to_string(trials_.size() - done()) + " of " + std::to_string(trials_.size()) +
         " runs were ended from outside, as the system does where memory does not suffice; the same command repeats "
         "them, with less memory at a time by --jobs 1";
}

/// Hands the runs that are done over to the script that makes table, pictures and statements of them.
int Runs::tell() const {
  Json page = sweep_.shown;
  page["planned"] = trials_.size(), page["measures"] = sweep_.measures, page["runs"] = Json::array();
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    const Trial &trial = trials_[i];
    if (!trial.done) continue;
    Json row{{"run", i}, {"folder", trial.folder}};
    row.update(trial.columns);
    row["overrides"] = trial.overrides, row["failure"] = trial.record["cause"];
    for (const char *time : {"processor_s", "wall_s"}) row[time] = trial.record[time];
    page["runs"].push_back(row);
  }
  const SweepOptions &options = sweep_.options;
  write(options.directory + "/design.json", page);
  std::fflush(stdout);
  std::vector<std::string> words{options.directory};
  if (options.no_plot) words.push_back("--no-plot");
  const int status = run_script("talus_study.py", words);
  std::fprintf(stderr, "study.csv%s in %s\n", options.no_plot ? " and study.json are" : ", study.json and pictures are",
               options.directory.c_str());
  return status;
}

}  // namespace

std::string run_name(std::size_t number) {
  char name[32];
  std::snprintf(name, sizeof name, "run%05zu", number);
  return name;
}

int perform(Sweep sweep) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (ranks > 1) throw SceneError("this command starts its runs itself: call it on one rank, and give --jobs");
  Runs runs(sweep);
  const std::string missing = runs.run();
  const int status = runs.done() > 0 ? runs.tell() : 1;
  if (!missing.empty()) throw std::runtime_error(missing);
  return status;
}

std::string same_keys(const Scene &scene, const std::vector<std::string> &keys) {
  for (std::size_t i = 0; i < keys.size(); ++i)
    for (std::size_t k = i + 1; k < keys.size(); ++k) {
      const std::string a = scene.root->one_path(keys[i]) + ".", b = scene.root->one_path(keys[k]) + ".";
      if (a.starts_with(b) || b.starts_with(a))
        return "gives values to " + keys[i] + " and to " + keys[k] + ", of which one would replace the other";
    }
  return "";
}

std::string unit_of_key(const std::string &key) {
  const std::vector<std::string> words = pieces(key, '.');
  const auto same = [](const std::string &word, const std::string &of_pattern) {
    return word == of_pattern || of_pattern == "NAME" || of_pattern == "N";
  };
  const Describer keys = scene_keys();
  for (const Describer::Block &block : keys.blocks())
    for (const Describer::Key &one : block.keys)
      if (!one.unit.empty() && std::ranges::equal(words, pieces(one.path, '.'), same)) return one.unit;
  return "";
}

CLI::Option *add_sweep_options(CLI::App &command, SweepOptions &options, const std::string &meaning_of_set,
                               const std::string &meaning_of_output) {
  CLI::Option *set = command.add_option("--set", options.set, meaning_of_set)->take_all();
  command.add_option("-o,--output", options.directory, meaning_of_output);
  command.add_option("-j,--jobs", options.jobs, "runs at the same time (default: one per core)")
      ->check(CLI::Range(1, 1024));
  command.add_flag("--force", options.force,
                   "replace runs of another scene or of other values in that folder, and repeat runs that failed");
  command.add_flag("--no-plot", options.no_plot, "do not draw pictures");
  command.add_flag("--no-umat", options.no_umat, "refuse laws that load a library: for scenes of strangers");
  return set;
}

}  // namespace talus
