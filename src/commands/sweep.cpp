#include "commands/sweep.h"

#include <petscsys.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
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
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation.h"
#include "simulation/scene_keys.h"
#include "solvers/integrators.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

/// Runs are missing: the user ended the command, or something from outside ended some of them.
struct Interrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Endings of files that are read with a file of the same name: by GDAL, and by the reader of meshes. Statistics that
/// viewers leave in .aux.xml change no result.
constexpr const char *companions[] = {".prj", ".tfw", ".wld", ".shx", ".dbf", ".cpg", ".origin.json"};

/// Size and digest of a file, by FNV-1a over words of 8 bytes, which finds edited files and not forged ones.
std::string state_of(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t digest = 14695981039346656037u;
  std::uintmax_t size = 0;
  for (std::vector<char> block(1 << 20); file;) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    size += count;
    std::memset(block.data() + count, 0, (8 - count % 8) % 8);
    for (std::size_t i = 0; i < count; i += 8) {
      std::uint64_t word;
      std::memcpy(&word, block.data() + i, 8);
      digest = (digest ^ word) * 1099511628211u;
      digest ^= digest >> 32;
    }
  }
  std::ostringstream text;
  text << size << ' ' << std::hex << digest;
  return text.str();
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
  require_column(possible_columns(scene), measure.column);
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

/// Is it the path of a key, with its pattern: body.clay.cohesion and body.NAME.cohesion?
bool matches(const std::string &key, const std::string &pattern) {
  const std::vector<std::string> words = pieces(key, '.'), wanted = pieces(pattern, '.');
  return std::ranges::equal(words, wanted, [](const std::string &word, const std::string &other) {
    return word == other || other == "NAME" || other == "N";
  });
}

/// Did something from outside end a run, which then says nothing about its scene: who ended it, or the system for want
/// of memory? Other signals are faults of the program.
bool ended_from_outside(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status) == stopped_status;
  const int signal = WTERMSIG(status);
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP;
}

std::string joined(const std::vector<std::string> &words) {
  std::string text;
  for (const std::string &word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

void write(const std::string &path, const Json &page) {
  replace_file(path, page.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// The runs of a sweep: begun, waited for, remembered. What a run is, what it reads and how it ended stands in
/// FOLDER/trial.
class Runs {
 public:
  explicit Runs(Sweep &sweep);
  void run();
  int tell() const;
  std::size_t done() const { return static_cast<std::size_t>(std::ranges::count_if(trials_, &Trial::done)); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Running {
    std::size_t number;
    Clock::time_point began;
  };
  static double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

  std::string folder(const Trial &trial) const { return (fs::path(sweep_.options.directory) / trial.folder).string(); }
  std::string in_words(const Trial &trial) const {
    return trial.columns.value("series", "") + " " + joined(trial.overrides);
  }
  std::vector<std::string> overrides(const Trial &trial) const {
    std::vector<std::string> all = sweep_.set;
    all.insert(all.end(), trial.overrides.begin(), trial.overrides.end());
    return all;
  }
  void mark_done();
  bool start_next();
  void start(const Trial &trial, std::size_t number);
  void end_all() const;
  void check_columns();
  void ended(const Running &run, int status, const rusage &usage);

  Sweep &sweep_;
  std::vector<Trial> &trials_;
  std::vector<Measure> measures_;
  std::vector<Json> is_;  ///< what each run is and reads
  std::optional<FolderLock> lock_;
  std::map<pid_t, Running> running_;
  std::size_t next_ = 0, before_ = 0;  ///< to be started; done before
  Clock::time_point begin_ = Clock::now();
  bool has_columns_ = false;
  std::string killed_;            ///< folder of a run that something from outside has ended
  const Trial *waits_ = nullptr;  ///< a run of a program that was killed still writes into its folder
};

Runs::Runs(Sweep &sweep) : sweep_(sweep), trials_(sweep.trials) {
  const std::string &directory = sweep.options.directory;
  if (!sweep.options.force && fs::exists(directory + "/run.h5"))
    throw SceneError(
        directory + " holds the results of a run; choose another folder with -o, or give --force to write beside them");
  for (const std::string &measure : sweep.measures) measures_.push_back(parse_measure(measure));
  std::map<std::string, std::string> known;
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    if (trials_[i].folder.empty()) trials_[i].folder = run_name(i);
    const Scene scene = read_wholly(sweep.scene, overrides(trials_[i]), sweep.options.no_umat);
    for (const Measure &measure : measures_) require_measure(scene, measure);
    is_.push_back({{"run",
                    {{"command", joined(sweep.command) + " " + sweep.scene},
                     {"overrides", overrides(trials_[i])},
                     {"scene", std::hash<std::string>{}(scene.root->values())}}},
                   {"files", files_of(scene, known)}});
  }
  make_folder(directory);
  if (!lock_.emplace(directory).taken())
    throw SceneError("another study, comparison or run is writing into " + directory +
                     "; wait for its end, or choose another folder with -o");
  mark_done();
}

/// Says which files have changed since runs were completed with them.
void Runs::mark_done() {
  const bool force = sweep_.options.force;
  std::map<std::string, int> changed;  // path: runs
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    Trial &trial = trials_[i];
    std::ifstream file(folder(trial) + "/trial");
    Json before = Json::parse(file, nullptr, false);
    if (!before.is_object()) continue;
    if (before["run"] != is_[i]["run"]) {
      if (force) continue;
      throw SceneError(folder(trial) + " holds a run with another scene or other values (" + joined(trial.overrides) +
                       " is to run there); choose another folder with -o, or give --force to replace it");
    }
    Json &then = before["files"], &now = is_[i]["files"];
    Json all = then;
    all.update(now);
    for (const auto &[path, state] : all.items())
      if (then.value(path, "") != now.value(path, "")) ++changed[path];
    trial.failed = before["failed"], trial.cause = before["cause"];
    trial.cpu = before["processor_s"], trial.wall = before["wall_s"];
    trial.done = then == now && !(force && trial.failed);
  }
  for (const auto &[path, runs] : changed)
    std::fprintf(stderr, "%s has changed; runs to repeat: %d\n", path.c_str(), runs);
}

void Runs::start(const Trial &trial, std::size_t number) {
  for (const char *of_a_run_before : {"/trial", "/history.csv", "/events.jsonl"})
    fs::remove(folder(trial) + of_a_run_before);
  std::vector<std::string> words{"talus"};
  words.insert(words.end(), sweep_.command.begin(), sweep_.command.end());
  words.insert(words.end(), {sweep_.scene, "-o", folder(trial), "--no-pictures", "--force"});
  if (sweep_.options.no_umat) words.push_back("--no-umat");
  const std::vector<std::string> set = overrides(trial);
  if (!set.empty()) words.push_back("--set"), words.insert(words.end(), set.begin(), set.end());
  running_[start_program("/proc/self/exe", words, this_starter(), folder(trial) + "/screen")] = {number, Clock::now()};
}

/// Starts the next run that is missing. False where there is none, or somebody still writes into its folder.
bool Runs::start_next() {
  while (next_ < trials_.size() && trials_[next_].done) ++next_;
  if (next_ == trials_.size()) return false;
  const Trial &trial = trials_[next_];
  fs::create_directories(folder(trial));
  if (!FolderLock(folder(trial)).taken()) {
    if (waits_ != &trial)
      std::fprintf(stderr, "waiting for the run that still writes into %s\n", folder(trial).c_str());
    waits_ = &trial;
    return false;
  }
  start(trial, next_++);
  return true;
}

void Runs::end_all() const {
  for (const auto &[child, run] : running_) kill(child, SIGTERM);
}

/// Ends all runs where the first history under way lacks a column.
void Runs::check_columns() {
  for (auto run = running_.begin(); !has_columns_ && !measures_.empty() && run != running_.end(); ++run) {
    const std::vector<std::string> names = columns_of(folder(trials_[run->second.number]) + "/history.csv");
    has_columns_ = !names.empty();
    for (std::size_t k = 0; has_columns_ && k < measures_.size(); ++k) require_column(names, measures_[k].column);
  }
}

void Runs::ended(const Running &run, int status, const rusage &usage) {
  Trial &trial = trials_[run.number];
  trial.wall = seconds_since(run.began);
  trial.cpu = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
              1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  trial.failed = !WIFEXITED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != undecided_status);
  if (trial.failed && (interrupted || ended_from_outside(status))) {  // it is run again
    if (!interrupted) std::fprintf(stderr, "%s was ended from outside\n", in_words(trial).c_str());
    killed_ = folder(trial);
    return;
  }
  trial.done = true;
  trial.cause = trial.failed ? last_line(folder(trial) + "/screen") : "";
  if (trial.failed && trial.cause.empty()) trial.cause = "the run ended without a message";
  if (sweep_.refusal_ends && WIFEXITED(status) && WEXITSTATUS(status) == 2)
    throw SceneError(trial.cause.substr(trial.cause.starts_with("talus: ") ? 7 : 0));
  Json page = is_[run.number];
  page["failed"] = trial.failed, page["processor_s"] = trial.cpu, page["wall_s"] = trial.wall;
  page["cause"] = trial.cause;
  write(folder(trial) + "/trial", page);
  std::fprintf(stderr, "%zu of %zu: %s %s in %.3g s", done(), trials_.size(), in_words(trial).c_str(),
               trial.failed ? "FAILED" : "done", trial.wall);
  if (const std::size_t left = trials_.size() - done(); left > 0)
    std::fprintf(stderr, "; about %.0f s left",
                 seconds_since(begin_) / static_cast<double>(done() - before_) * static_cast<double>(left));
  std::fputc('\n', stderr);
}

void Runs::run() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = 1; });
  const std::size_t jobs = sweep_.options.jobs ? static_cast<std::size_t>(sweep_.options.jobs)
                                               : std::max(1u, std::thread::hardware_concurrency());
  before_ = done();
  if (before_) std::fprintf(stderr, "%zu of %zu runs were completed before\n", before_, trials_.size());
  bool told = false;
  try {
    while (true) {
      if (interrupted && !told) end_all();
      told = interrupted;
      while (running_.size() < jobs && !interrupted && start_next()) {
      }
      if (running_.empty() && (interrupted || next_ == trials_.size())) break;
      check_columns();
      int status = 0;
      rusage usage{};
      const auto found = running_.find(wait4(-1, &status, WNOHANG, &usage));  // a signal may arrive at any time
      if (found == running_.end()) {
        usleep(10000);
        continue;
      }
      const Running run = found->second;
      running_.erase(found);
      ended(run, status, usage);
    }
  } catch (...) {
    end_all();
    for (const auto &[child, run] : running_) waitpid(child, nullptr, 0);
    throw;
  }
  if (done() == trials_.size()) return;
  throw Interrupted(
      interrupted
          ? "interrupted; the same command continues with the missing runs"
          : std::to_string(trials_.size() - done()) + " of " + std::to_string(trials_.size()) +
                " runs were ended from outside, as the system does where memory does not suffice (the last is " +
                killed_ + "); the same command repeats them, with less memory at a time by --jobs 1");
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
    row["overrides"] = trial.overrides, row["processor_s"] = trial.cpu, row["wall_s"] = trial.wall;
    row["failure"] = trial.cause;
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
  try {
    runs.run();
  } catch (const Interrupted &) {
    if (runs.done() > 0) runs.tell();
    throw;
  }
  return runs.tell();
}

std::string same_keys(const Scene &scene, const std::vector<std::string> &keys) {
  for (std::size_t i = 0; i < keys.size(); ++i)
    for (std::size_t k = i + 1; k < keys.size(); ++k) {
      const std::string a = scene.root->one_path(keys[i]), b = scene.root->one_path(keys[k]);
      const std::string ends = ": one value would replace the other";
      if (a == b)
        return "gives a second value to " + keys[i] + (keys[i] == keys[k] ? "" : ", which is " + keys[k] + " too") +
               ends;
      for (const auto &[outer, inner] : {std::pair{a, b}, {b, a}})
        if (inner.starts_with(outer + "."))
          return "gives a value to " + inner + " and one to the table " + outer + " in which it lies" + ends;
    }
  return "";
}

std::string unit_of_key(const std::string &key) {
  const Describer keys = scene_keys();
  for (const Describer::Block &block : keys.blocks())
    for (const Describer::Key &one : block.keys)
      if (!one.unit.empty() && matches(key, one.path)) return one.unit;
  return "";
}

Scene read_wholly(const std::string &file, const std::vector<std::string> &set, bool no_umat) {
  Scene scene = read_scene(file, set);
  if (no_umat) refuse_umat(scene);
  for (const BodySource &body : scene.body) read_law(body.law);
  for (const BoundarySource &boundary : scene.boundary) read_boundary(boundary.kind);
  DeferredTable integrator = scene.integrator;
  read_integrator(integrator, fluids_move(scene.phases));
  return scene;
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
