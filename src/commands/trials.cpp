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
#include "commands/commands.h"
#include "commands/comparison.h"
#include "commands/history_columns.h"
#include "mesh_source.h"
#include "output/csv.h"
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

std::string contents(const std::string &path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// Throws SceneError where the stages end before the time of a measure.
void require_within_stages(const Scene &scene, const Measure &measure) {
  double end = 0;
  for (const Stage &stage : scene.stage) end += stage.duration;
  if (measure.time > end * (1 + 1e-9))
    throw SceneError("the measure " + measure.column + "@" + shortest(measure.time) +
                     " asks for t = " + shortest(measure.time) +
                     " s, and the stages of the scene end at t = " + shortest(end) + " s at the latest");
}

/// What a run depends on: DIR/trial begins with it. The number stands for the texts of scene and mesh, and for the
/// state at which the run starts.
std::string description(const TrialPlan &plan, const Trial &trial) {
  std::vector<std::string> all = plan.set;
  all.insert(all.end(), trial.overrides.begin(), trial.overrides.end());
  const Scene scene = read_wholly(plan.scene, all);
  for (const Measure &measure : plan.measures) {
    require_column(possible_columns(scene), measure.column);
    require_within_stages(scene, measure);
  }
  const std::string mesh = scene.mesh.file.empty() ? scene.mesh.section : scene.mesh.file,
                    start = scene.start_from.folder.empty() ? "" : scene.start_from.folder + "/checkpoint/header";
  return joined(plan.command) + " " + plan.scene + "\n" + joined(all) + "\n" +
         std::to_string(std::hash<std::string>{}(scene.source + contents(beside_scene(scene, mesh)) +
                                                 contents(beside_scene(scene, start)))) +
         "\n";
}

bool resume(const TrialPlan &plan, const std::string &described, Trial &trial) {
  std::ifstream file(trial.folder + "/trial");
  std::string text, line;
  for (int i = 0; i < 3 && std::getline(file, line); ++i) text += line + "\n";
  if (!plan.replace && !text.empty() && text != described)
    throw SceneError(trial.folder + " holds a run with another scene or other values (" + joined(trial.overrides) +
                     " is to run there); choose another folder with -o, or give --force to replace it");
  if (text != described || !(file >> trial.failed >> trial.cpu >> trial.wall)) return false;
  std::getline(file, line), std::getline(file, trial.cause);
  return trial.done = true;
}

void remember(const std::string &described, const Trial &trial) {
  std::ofstream(trial.folder + "/trial") << described << trial.failed << " " << trial.cpu << " " << trial.wall << "\n"
                                         << trial.cause << "\n";
}

pid_t start(const TrialPlan &plan, const Trial &trial) {
  fs::create_directories(trial.folder);
  fs::remove(trial.folder + "/history.csv");  // of a run before
  std::vector<std::string> words{"talus"};
  words.insert(words.end(), plan.command.begin(), plan.command.end());
  words.insert(words.end(), {plan.scene, "-o", trial.folder, "--no-pictures", "--force"});
  std::vector<std::string> overrides = plan.set;
  overrides.insert(overrides.end(), trial.overrides.begin(), trial.overrides.end());
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

/// The sentences behind "warning:" in the log of a run, each once.
std::vector<std::string> sentences_of(const Trial &trial) {
  static const std::string mark = "  warning: ";
  std::vector<std::string> found;
  std::ifstream file(trial.folder + "/run.log");
  for (std::string line; std::getline(file, line);)
    if (const std::size_t at = line.find(mark); at != std::string::npos) {
      const std::string sentence = line.substr(at + mark.size());
      if (std::find(found.begin(), found.end(), sentence) == found.end()) found.push_back(sentence);
    }
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

/// Runs what is not done yet.
void run_missing(const TrialPlan &plan, const std::vector<Trial *> &trials, const std::vector<std::string> &described) {
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  const int jobs = plan.jobs ? plan.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::map<pid_t, std::pair<size_t, Clock::time_point>> running;
  size_t next = 0, done = std::count_if(trials.begin(), trials.end(), [](const Trial *t) { return t->done; });
  const size_t before = done;
  const Clock::time_point begin = Clock::now();
  if (before) std::fprintf(stderr, "%zu of %zu runs were completed before\n", before, trials.size());
  const auto end_others = [&] {
    for (const auto &[child, run] : running) kill(child, SIGTERM);
    for (const auto &[child, run] : running) waitpid(child, nullptr, 0);
  };
  bool told = false, has_columns = plan.measures.empty();
  while (done < trials.size() || !running.empty()) {
    if (interrupted && !told)
      for (const auto &[child, run] : running) kill(child, SIGTERM);
    told = interrupted;
    for (; next < trials.size() && static_cast<int>(running.size()) < jobs && !interrupted; ++next)
      if (!trials[next]->done) running[start(plan, *trials[next])] = {next, Clock::now()};
    if (running.empty()) break;
    for (auto run = running.begin(); !has_columns && run != running.end(); ++run) {
      const std::vector<std::string> names = columns_of(trials[run->second.first]->folder + "/history.csv");
      try {
        if (!names.empty())
          for (const Measure &measure : plan.measures) require_column(names, measure.column);
      } catch (const SceneError &) {
        end_others();
        throw;
      }
      has_columns = !names.empty();
    }
    int status = 0;
    rusage usage{};
    const pid_t child = wait4(-1, &status, WNOHANG, &usage);  // a signal may arrive at any time
    if (child == 0) usleep(10000);
    const auto found = running.find(child);
    if (found == running.end()) continue;
    const auto [number, began] = found->second;
    Trial &trial = *trials[number];
    trial.wall = seconds_since(began);
    trial.cpu =
        usage.ru_utime.tv_sec + usage.ru_stime.tv_sec + 1e-6 * (usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    running.erase(found);
    trial.failed = !WIFEXITED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != undecided_status);
    if (trial.failed && interrupted) continue;  // it may have been ended by the signal: it is run again
    trial.done = true, ++done;
    if (trial.failed) trial.cause = last_line(trial.folder + "/screen");
    if (plan.refusal_ends && WIFEXITED(status) && WEXITSTATUS(status) == 2) {
      end_others();
      throw SceneError(trial.cause.substr(trial.cause.rfind("talus: ", 0) == 0 ? 7 : 0));
    }
    remember(described[number], trial);
    const double left =
        seconds_since(begin) / static_cast<double>(done - before) * static_cast<double>(trials.size() - done);
    std::fprintf(stderr, "%zu of %zu: %s %s %s in %.3g s", done, trials.size(), trial.label.c_str(),
                 joined(trial.overrides).c_str(), trial.failed ? "FAILED" : "done", trial.wall);
    if (done < trials.size()) std::fprintf(stderr, "; about %.0f s left", left);
    std::fputc('\n', stderr);
  }
  if (done < trials.size()) throw Interrupted("interrupted; the same command continues with the missing runs");
}

}  // namespace

std::string joined(const std::vector<std::string> &words) {
  std::string text;
  for (const std::string &word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::vector<SharedWarning> warnings_of(const std::vector<Trial *> &trials) {
  std::vector<SharedWarning> all;
  std::map<std::string, std::size_t> known;
  for (const Trial *trial : trials) {
    if (!trial->done) continue;
    std::set<std::size_t> mine;  // sentences of this run that differ in their numbers count once
    for (const std::string &sentence : sentences_of(*trial)) {
      const auto [at, added] = known.emplace(without_numbers(sentence), all.size());
      if (added) all.push_back({sentence, 0, fs::path(trial->folder).filename().string()});
      mine.insert(at->second);
    }
    for (const std::size_t i : mine) ++all[i].runs;
  }
  return all;
}

void write_warnings(const std::string &folder, const std::vector<SharedWarning> &warnings) {
  std::ofstream file(folder + "/warnings.csv");
  file << "warning,runs,first_run\n";
  for (const SharedWarning &one : warnings)
    file << csv_field(one.sentence) << "," << one.runs << "," << csv_field(one.first) << "\n";
  if (!file.flush()) throw std::runtime_error("cannot write " + folder + "/warnings.csv");
}

void print_warnings(const std::vector<SharedWarning> &warnings, std::size_t runs) {
  for (const SharedWarning &one : warnings)
    std::printf("warning in %d of %zu runs, first in %s: %s\n", one.runs, runs, one.first.c_str(),
                one.sentence.c_str());
  std::fflush(stdout);
}

std::string warnings_of(const Trial &trial) {
  std::string text;
  for (const std::string &sentence : sentences_of(trial)) text += (text.empty() ? "" : " | ") + sentence;
  return text;
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

Scene read_wholly(const std::string &file, const std::vector<std::string> &set) {
  Scene scene = read_scene(file, set);
  for (const BodySource &body : scene.body) read_law(body.law);
  for (const BoundarySource &boundary : scene.boundary) read_boundary(boundary.kind);
  DeferredTable integrator = scene.integrator;
  read_integrator(integrator, fluids_move(scene.phases));
  return scene;
}

void run_trials(const TrialPlan &plan, const std::vector<Trial *> &trials) {
  for (const Trial *trial : trials)
    if (const fs::path all = fs::path(trial->folder).parent_path(); !plan.replace && fs::exists(all / "run.h5"))
      throw SceneError(
          all.string() +
          " holds the results of a run; choose another folder with -o, or give --force to write beside them");
  std::vector<std::string> described;
  for (Trial *trial : trials) {
    described.push_back(description(plan, *trial));
    resume(plan, described.back(), *trial);
  }
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  run_missing(plan, trials, described);
}

void require_one_rank(const std::string &command) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (ranks > 1)
    throw SceneError("`talus " + command + "` starts its runs itself: call it on one rank, and give --jobs");
}

}  // namespace talus
