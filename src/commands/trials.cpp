#include "commands/trials.h"

#include <fcntl.h>
#include <petscsys.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include "base/child_environment.h"
#include "base/rounded.h"
#include "commands/comparison.h"
#include "commands/files_read.h"
#include "commands/foreign_code.h"
#include "commands/history_columns.h"
#include "output/csv.h"
#include "output/replace_file.h"
#include "output/script.h"
#include "physics/boundary/boundary.h"
#include "physics/laws/laws.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "simulation.h"
#include "simulation/scene_keys.h"
#include "solvers/integrators.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

constexpr const char *starter_variable = "TALUS_STARTER";  // process that has started this one as a trial
pid_t starter_process = 0;                                 // 0: this is no trial
constexpr int stopped_status = 4;                          // of a trial that a signal has ended

/// Throws SceneError where the stages end before the time of a measure.
void require_within_stages(const Scene &scene, const Measure &measure) {
  double end = 0;
  for (const Stage &stage : scene.stage) end += stage.duration;
  if (measure.time > end * (1 + 1e-9))
    throw SceneError("the measure " + measure.column + "@" + shortest(measure.time) +
                     " asks for t = " + shortest(measure.time) +
                     " s, and the stages of the scene end at t = " + shortest(end) + " s at the latest");
}

/// What a run is, the first lines of FOLDER/trial. The number stands for the values of the scene, whose files are
/// listed below.
std::string description(const TrialPlan &plan, const Scene &scene, const std::vector<std::string> &overrides) {
  return joined(plan.command) + " " + plan.scene + "\n" + joined(overrides) + "\n" +
         std::to_string(std::hash<std::string>{}(scene.root->values())) + "\n";
}

std::vector<std::string> all_overrides(const TrialPlan &plan, const Trial &trial) {
  std::vector<std::string> all = plan.set;
  all.insert(all.end(), trial.overrides.begin(), trial.overrides.end());
  return all;
}

/// What FOLDER/trial says of a run that was completed.
struct Remembered {
  std::string described;
  std::vector<std::string> files;
  bool ended = false;
};

const std::string file_mark = "file ";

Remembered remembered(Trial &trial) {
  Remembered before;
  std::ifstream file(trial.folder + "/trial");
  std::string line;
  for (int i = 0; i < 3 && std::getline(file, line); ++i) before.described += line + "\n";
  while (std::getline(file, line) && line.starts_with(file_mark)) before.files.push_back(line.substr(file_mark.size()));
  std::istringstream cost(line);
  before.ended = static_cast<bool>(cost >> trial.failed >> trial.cpu >> trial.wall);
  std::getline(file, trial.cause);
  return before;
}

void remember(const std::string &described, const std::vector<std::string> &files, const Trial &trial) {
  std::ofstream file(trial.folder + "/trial");
  file << described;
  for (const std::string &line : files) file << file_mark << line << "\n";
  file << trial.failed << " " << trial.cpu << " " << trial.wall << "\n" << trial.cause << "\n";
}

pid_t start(const TrialPlan &plan, const Trial &trial) {
  for (const char *of_a_run_before : {"/trial", "/history.csv", "/events.jsonl"})
    fs::remove(trial.folder + of_a_run_before);
  std::vector<std::string> words{"talus"};
  words.insert(words.end(), plan.command.begin(), plan.command.end());
  words.insert(words.end(), {plan.scene, "-o", trial.folder, "--no-pictures", "--force"});
  if (plan.options.no_umat) words.push_back("--no-umat");
  const std::vector<std::string> overrides = all_overrides(plan, trial);
  if (!overrides.empty()) words.push_back("--set"), words.insert(words.end(), overrides.begin(), overrides.end());
  std::vector<char *> argv;
  for (auto &word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, (trial.folder + "/screen").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  auto environment = environment_without_mpi();
  std::string starter = std::string(starter_variable) + "=" + std::to_string(getpid());
  environment.insert(environment.begin(), starter.data());
  pid_t child = -1;
  const int error = posix_spawn(&child, "/proc/self/exe", &actions, nullptr, argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error) throw std::runtime_error(std::string("cannot start a run: ") + std::strerror(error));
  return child;
}

std::string last_line(const std::string &path) {
  std::ifstream file(path);
  std::string line, last;
  while (std::getline(file, line))
    if (!line.empty()) last = line;
  return last;
}

void on_signal(int) { interrupted = 1; }

/// What a run has warned of, each sentence once.
std::vector<std::string> sentences_of(const Trial &trial) {
  std::vector<std::string> found;
  for (const Event &one : read_events(trial.folder))
    if (one.warning && std::ranges::find(found, one.text) == found.end()) found.push_back(one.text);
  return found;
}

/// Is it the path of a key, with its pattern: body.clay.cohesion and body.NAME.cohesion?
bool matches(const std::string &key, const std::string &pattern) {
  const std::vector<std::string> words = pieces(key, '.'), wanted = pieces(pattern, '.');
  return words.size() == wanted.size() &&
         std::equal(words.begin(), words.end(), wanted.begin(), [](const std::string &word, const std::string &other) {
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

/// Soil that left the mesh by the last row of the history of a run; not numbers where it has none.
struct Escaped {
  double mass = NAN;   ///< [kg]
  double share = NAN;  ///< of all soil
};
Escaped escaped(const Trial &trial) {
  const std::string path = trial.folder + "/history.csv";
  const std::vector<std::string> names = columns_of(path), cells = pieces(last_line(path), ',');
  const auto last = [&](const char *quantity) {
    const auto at = std::find(names.begin(), names.end(), history_column(quantity, "kg")) - names.begin();
    return cells.size() == names.size() && at < std::ssize(cells) ? number_of(cells[at]) : NAN;
  };
  const double mass = last("escaped_mass");
  return {mass, mass / (mass + last("mass"))};
}

/// A number of a table; empty where it is none.
std::string cell(double number) { return std::isfinite(number) ? shortest(number) : ""; }

/// All warnings of one run as one text.
std::string as_text(const std::vector<std::string> &sentences) {
  std::string text;
  for (const std::string &sentence : sentences) text += (text.empty() ? "" : " | ") + sentence;
  return text;
}

/// What runs warned of, one sentence for all that differ in their numbers alone.
struct SharedWarning {
  std::string sentence;  ///< as the first run has it
  int runs = 0;
  std::string first;  ///< folder of the first run, without the path
};

std::string name_of(const Trial &trial) { return fs::path(trial.folder).filename().string(); }

std::vector<SharedWarning> shared_warnings(const std::vector<Trial *> &trials) {
  std::vector<SharedWarning> all;
  std::map<std::string, std::size_t> known;
  for (const Trial *trial : trials) {
    if (!trial->done) continue;
    std::set<std::size_t> mine;  // sentences of this run that differ in their numbers count once
    for (const std::string &sentence : sentences_of(*trial)) {
      const auto [at, added] = known.emplace(without_numbers(sentence), all.size());
      if (added) all.push_back({sentence, 0, name_of(*trial)});
      mine.insert(at->second);
    }
    for (const std::size_t i : mine) ++all[i].runs;
  }
  return all;
}

/// How many runs lost soil and have warnings.
std::string trouble_in_short(const std::vector<Trial *> &trials) {
  std::size_t done = 0, lost = 0, warned = 0;
  double most = 0;
  std::string where;
  for (const Trial *trial : trials) {
    if (!trial->done) continue;
    const double share = escaped(*trial).share;
    ++done, lost += share > 0, warned += !sentences_of(*trial).empty();
    if (share > most) most = share, where = name_of(*trial);
  }
  return "soil left the mesh in " + std::to_string(lost) + " of " + std::to_string(done) + " runs" +
         (lost ? " (at most " + rounded(100 * most) + " % of it, " + where + ")" : "") + ", and " +
         std::to_string(warned) + " have warnings";
}

}  // namespace

std::string joined(const std::vector<std::string> &words) {
  std::string text;
  for (const std::string &word : words) text += (text.empty() ? "" : " ") + word;
  return text;
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

KeyValue value_at(const std::string &key, const std::string &typed) {
  const std::string text = unquoted(typed);
  try {
    const Quantity quantity = parse_quantity(text);
    return {shortest(quantity.number), quantity.plain ? unit_of_key(key) : unit_behind(text), true};
  } catch (const std::invalid_argument &) {  // an expression, a list or a word
    return {text, unit_of_key(key)};
  }
}

void share_unit(const std::string &key, const std::vector<KeyValue *> &values) {
  for (KeyValue *value : values) {
    const KeyValue &first = *values.front();
    if (value->unit == first.unit) continue;
    if (!value->number || !first.number || value->unit.empty() || first.unit.empty())
      throw SceneError("the series give " + key + " the values " + first.text + " [" + first.unit + "] and " +
                       value->text + " [" + value->unit +
                       "], which cannot share an axis: write both as numbers, or both in the unit of the key");
    const double factor = parse_quantity("1 " + value->unit).si / parse_quantity("1 " + first.unit).si;
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", std::stod(value->text) * factor);  // without the round-off of the factor
    value->text = text, value->unit = first.unit;
  }
}

void end_with_starter() {
  const char *given = std::getenv(starter_variable);
  if (!given) return;
  starter_process = static_cast<pid_t>(std::atol(given));
  unsetenv(starter_variable);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != starter_process) raise(SIGTERM);  // it was gone before that
}

void end_soon_without_starter() {
  constexpr unsigned grace = 5;                                           // [s]
  if (starter_process > 0 && getppid() != starter_process) alarm(grace);  // SIGALRM ends a process
}

int status_for_starter(int status) { return status && interrupted && starter_process > 0 ? stopped_status : status; }

Scene read_wholly(const std::string &file, const std::vector<std::string> &set, bool no_umat) {
  Scene scene = read_scene(file, set);
  if (no_umat) refuse_umat(scene);
  for (const BodySource &body : scene.body) read_law(body.law);
  for (const BoundarySource &boundary : scene.boundary) read_boundary(boundary.kind);
  DeferredTable integrator = scene.integrator;
  read_integrator(integrator, fluids_move(scene.phases));
  return scene;
}

CLI::Option *add_trial_options(CLI::App &command, TrialOptions &options, const std::string &meaning_of_set,
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

Trials::Trials(const TrialPlan &plan, const std::vector<Trial *> &trials) : plan_(plan), trials_(trials) {
  const std::string &folder = plan.options.directory;
  if (!plan.options.force && fs::exists(folder + "/run.h5"))
    throw SceneError(
        folder + " holds the results of a run; choose another folder with -o, or give --force to write beside them");
  FilesRead read;
  for (const Trial *trial : trials_) {
    const std::vector<std::string> overrides = all_overrides(plan, *trial);
    const Scene scene = read_wholly(plan.scene, overrides, plan.options.no_umat);
    for (const Measure &measure : plan.measures) {
      require_column(possible_columns(scene), measure.column);
      require_within_stages(scene, measure);
    }
    described_.push_back(description(plan, scene, overrides));
    files_.push_back(read.of(scene));
  }
  make_folder(folder);
  if (!lock_.emplace(folder).taken())
    throw SceneError("another study, comparison or run is writing into " + folder +
                     "; wait for its end, or choose another folder with -o");
  mark_done();
}

/// Says which files have changed since runs were completed with them.
void Trials::mark_done() {
  std::map<std::string, int> changed;  // path: runs
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    Trial &trial = *trials_[i];
    const Remembered before = remembered(trial);
    const bool same = before.described == described_[i];
    if (!plan_.options.force && !before.described.empty() && !same)
      throw SceneError(trial.folder + " holds a run with another scene or other values (" + joined(trial.overrides) +
                       " is to run there); choose another folder with -o, or give --force to replace it");
    trial.done = same && before.ended && before.files == files_[i] && !(plan_.options.force && trial.failed);
    if (!same || !before.ended) continue;
    const std::vector<std::string> &now = files_[i];
    std::set<std::string> paths;
    for (const auto &[one, other] : {std::pair{&before.files, &now}, {&now, &before.files}})
      for (const std::string &line : *one)
        if (std::find(other->begin(), other->end(), line) == other->end()) paths.insert(path_of(line));
    for (const std::string &path : paths) ++changed[path];
  }
  for (const auto &[path, runs] : changed)
    std::fprintf(stderr, "%s has changed; runs to repeat: %d\n", path.c_str(), runs);
}

void Trials::run() {
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  const int jobs =
      plan_.options.jobs ? plan_.options.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::map<pid_t, std::pair<size_t, Clock::time_point>> running;
  size_t next = 0, done = std::count_if(trials_.begin(), trials_.end(), [](const Trial *t) { return t->done; });
  const size_t before = done;
  const Clock::time_point begin = Clock::now();
  if (before) std::fprintf(stderr, "%zu of %zu runs were completed before\n", before, trials_.size());
  const auto end_others = [&] {
    for (const auto &[child, run] : running) kill(child, SIGTERM);
    for (const auto &[child, run] : running) waitpid(child, nullptr, 0);
  };
  bool told = false, has_columns = plan_.measures.empty();
  std::string ended;                 // a run that something from outside has ended
  const Trial *waits_for = nullptr;  // a run of a program that was killed still writes into its folder
  while (done < trials_.size() || !running.empty()) {
    if (interrupted && !told)
      for (const auto &[child, run] : running) kill(child, SIGTERM);
    told = interrupted;
    bool waits = false;
    for (; next < trials_.size() && static_cast<int>(running.size()) < jobs && !interrupted; ++next) {
      if (trials_[next]->done) continue;
      fs::create_directories(trials_[next]->folder);
      waits = !FolderLock(trials_[next]->folder).taken();
      if (waits && waits_for != trials_[next])
        std::fprintf(stderr, "waiting for the run that still writes into %s\n", trials_[next]->folder.c_str());
      if (waits) waits_for = trials_[next];
      if (waits) break;
      running[start(plan_, *trials_[next])] = {next, Clock::now()};
    }
    if (running.empty() && !waits) break;
    for (auto run = running.begin(); !has_columns && run != running.end(); ++run) {
      const std::vector<std::string> names = columns_of(trials_[run->second.first]->folder + "/history.csv");
      try {
        if (!names.empty())
          for (const Measure &measure : plan_.measures) require_column(names, measure.column);
      } catch (const SceneError &) {
        end_others();
        throw;
      }
      has_columns = !names.empty();
    }
    int status = 0;
    rusage usage{};
    const pid_t child = wait4(-1, &status, WNOHANG, &usage);  // a signal may arrive at any time
    const auto found = running.find(child);
    if (found == running.end()) {
      usleep(10000);
      continue;
    }
    const auto [number, began] = found->second;
    Trial &trial = *trials_[number];
    trial.wall = seconds_since(began);
    trial.cpu =
        usage.ru_utime.tv_sec + usage.ru_stime.tv_sec + 1e-6 * (usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    running.erase(found);
    trial.failed = !WIFEXITED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != undecided_status);
    if (trial.failed && (interrupted || ended_from_outside(status))) {  // it is run again
      if (!interrupted)
        std::fprintf(stderr, "%s %s was ended from outside\n", trial.label.c_str(), joined(trial.overrides).c_str());
      ended = trial.folder;
      continue;
    }
    trial.done = true, ++done;
    trial.cause = trial.failed ? last_line(trial.folder + "/screen") : "";
    if (trial.failed && trial.cause.empty()) trial.cause = "the run ended without a message";
    if (plan_.refusal_ends && WIFEXITED(status) && WEXITSTATUS(status) == 2) {
      end_others();
      throw SceneError(trial.cause.substr(trial.cause.rfind("talus: ", 0) == 0 ? 7 : 0));
    }
    remember(described_[number], files_[number], trial);
    const double left =
        seconds_since(begin) / static_cast<double>(done - before) * static_cast<double>(trials_.size() - done);
    std::fprintf(stderr, "%zu of %zu: %s %s %s in %.3g s", done, trials_.size(), trial.label.c_str(),
                 joined(trial.overrides).c_str(), trial.failed ? "FAILED" : "done", trial.wall);
    if (done < trials_.size()) std::fprintf(stderr, "; about %.0f s left", left);
    std::fputc('\n', stderr);
  }
  if (done == trials_.size()) return;
  throw Interrupted(
      interrupted
          ? "interrupted; the same command continues with the missing runs"
          : std::to_string(trials_.size() - done) + " of " + std::to_string(trials_.size()) +
                " runs were ended from outside, as the system does where memory does not suffice (the last is " +
                ended + "); the same command repeats them, with less memory at a time by --jobs 1");
}

void Trials::write(const std::string &name, const std::vector<std::string> &columns,
                   const std::function<std::vector<std::string>(std::size_t run)> &cells) const {
  const std::string path = plan_.options.directory + "/" + name;
  std::ofstream file(path);
  const auto row = [&](const std::vector<std::string> &texts) {
    for (std::size_t k = 0; k < texts.size(); ++k) file << (k ? "," : "") << csv_field(texts[k]);
    file << "\n";
  };
  const auto both = [](std::vector<std::string> own, const std::vector<std::string> &of_all) {
    own.insert(own.end(), of_all.begin(), of_all.end());
    return own;
  };
  row(both(columns, columns_of_trials));
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    const Trial &trial = *trials_[i];
    const std::vector<std::string> own = trial.done ? cells(i) : std::vector<std::string>();
    if (own.empty()) continue;
    const std::vector<std::string> warnings = sentences_of(trial);
    const Escaped gone = escaped(trial);
    row(both(own, {name_of(trial), cell(trial.cpu), cell(trial.wall), trial.cause, cell(gone.mass), cell(gone.share),
                   std::to_string(warnings.size()), as_text(warnings)}));
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

int Trials::tell(const std::string &script, const std::vector<std::string> &words) const {
  const std::vector<SharedWarning> warnings = shared_warnings(trials_);
  const std::string path = plan_.options.directory + "/warnings.csv";
  std::ofstream file(path);
  file << "warning,runs,first_run\n";
  for (const SharedWarning &one : warnings)
    file << csv_field(one.sentence) << "," << one.runs << "," << csv_field(one.first) << "\n";
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
  std::vector<std::string> all{plan_.options.directory};
  all.insert(all.end(), words.begin(), words.end());
  if (plan_.options.no_plot) all.push_back("--no-plot");
  std::fflush(stdout);
  const int status = run_script(script, all);
  const auto done = std::count_if(trials_.begin(), trials_.end(), [](const Trial *t) { return t->done; });
  std::printf("%s\n", trouble_in_short(trials_).c_str());
  for (const SharedWarning &one : warnings)
    std::printf("warning in %d of %zd runs, first in %s: %s\n", one.runs, done, one.first.c_str(),
                one.sentence.c_str());
  std::fflush(stdout);
  return status;
}

void require_one_rank(const std::string &command) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (ranks > 1)
    throw SceneError("`talus " + command + "` starts its runs itself: call it on one rank, and give --jobs");
}

}  // namespace talus
