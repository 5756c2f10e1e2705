#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>
#include <thread>

#include "base/child_environment.h"
#include "commands/commands.h"
#include "commands/comparison.h"
#include "commands/gallery.h"
#include "output/pictures.h"
#include "scene/reader.h"
#include "simulation.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

struct CompareArguments {
  std::string scene, directory, measure, exact, reference;
  std::vector<std::string> series, set;
  int jobs = 0;
  bool no_plot = false;
};

/// One run of the matrix and what came of it.
struct Trial {
  std::string series;
  std::vector<std::string> overrides;
  double parameter = NAN;  ///< what is refined in the series: the value of its last list
  std::string folder;
  bool is_reference = false;  ///< its value is the one that the others are compared with
  bool done = false, failed = false;
  std::string cause;
  double value = NAN, error = NAN, cpu = NAN, wall = NAN;
  long long steps = 0, evaluations = 0, rejections = 0;
};

std::string joined(const std::vector<std::string> &words) {
  std::string text;
  for (const std::string &word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::vector<Trial> matrix(const CompareArguments &arguments) {
  std::vector<Trial> trials;
  for (const std::string &text : arguments.series) {
    const Series series = parse_series(text);
    for (const auto &overrides : products(series)) {
      Trial trial;
      trial.series = series.name, trial.overrides = overrides;
      if (!series.lists.empty()) trial.parameter = number_of(overrides.back().substr(overrides.back().find('=') + 1));
      trials.push_back(trial);
    }
  }
  if (!arguments.reference.empty()) {
    const Series series = parse_series(arguments.reference);
    const auto overrides = products(series);
    if (overrides.size() != 1)
      throw SceneError("--reference \"" + arguments.reference + "\" must be one run: one value for each key");
    Trial trial;
    trial.series = series.name, trial.overrides = overrides.front(), trial.is_reference = true;
    trials.push_back(trial);
  }
  for (size_t i = 0; i < trials.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "run%03zu", i);
    trials[i].folder = (fs::path(arguments.directory) / name).string();
  }
  return trials;
}

/// What a run of the same scene with the same overrides left behind: DIR/runNNN/trial holds them and its cost.
std::string description(const CompareArguments &arguments, const Trial &trial) {
  return arguments.scene + "\n" + joined(arguments.set) + "\n" + joined(trial.overrides) + "\n";
}

bool resume(const CompareArguments &arguments, Trial &trial) {
  std::ifstream file(trial.folder + "/trial");
  std::string text, line;
  for (int i = 0; i < 3 && std::getline(file, line); ++i) text += line + "\n";
  if (text != description(arguments, trial) || !(file >> trial.failed >> trial.cpu >> trial.wall)) return false;
  std::getline(file, line), std::getline(file, trial.cause);
  return trial.done = true;
}

void remember(const CompareArguments &arguments, const Trial &trial) {
  std::ofstream(trial.folder + "/trial") << description(arguments, trial) << trial.failed << " " << trial.cpu << " "
                                         << trial.wall << "\n"
                                         << trial.cause << "\n";
}

pid_t start(const CompareArguments &arguments, const Trial &trial) {
  fs::create_directories(trial.folder);
  std::vector<std::string> words{"talus", "run", arguments.scene, "-o", trial.folder, "--no-pictures"};
  std::vector<std::string> overrides = arguments.set;
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

/// Runs what is not done yet, `jobs` at a time. Wall and processor time are of the whole process, meshing included.
void run_all(const CompareArguments &arguments, std::vector<Trial> &trials) {
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  std::map<pid_t, std::pair<Trial *, Clock::time_point>> running;
  size_t next = 0, done = std::count_if(trials.begin(), trials.end(), [](const Trial &t) { return t.done; });
  const size_t before = done;
  const Clock::time_point begin = Clock::now();
  if (before) std::fprintf(stderr, "%zu of %zu runs were completed before\n", before, trials.size());
  while (done < trials.size() || !running.empty()) {
    for (; next < trials.size() && static_cast<int>(running.size()) < arguments.jobs && !interrupted; ++next)
      if (!trials[next].done) running[start(arguments, trials[next])] = {&trials[next], Clock::now()};
    if (running.empty()) break;
    int status = 0;
    rusage usage{};
    const pid_t child = wait4(-1, &status, 0, &usage);
    if (child < 0 && errno == EINTR) continue;
    const auto found = running.find(child);
    if (found == running.end()) continue;
    Trial &trial = *found->second.first;
    trial.wall = seconds_since(found->second.second);
    trial.cpu =
        usage.ru_utime.tv_sec + usage.ru_stime.tv_sec + 1e-6 * (usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    running.erase(found);
    trial.done = true, ++done;
    trial.failed = !WIFEXITED(status) || WEXITSTATUS(status) != 0;
    if (trial.failed) trial.cause = last_line(trial.folder + "/screen");
    if (WIFEXITED(status) && WEXITSTATUS(status) == 2)
      throw SceneError(trial.cause.substr(trial.cause.rfind("talus: ", 0) == 0 ? 7 : 0));
    if (!interrupted) remember(arguments, trial);
    const double left =
        seconds_since(begin) / static_cast<double>(done - before) * static_cast<double>(trials.size() - done);
    std::fprintf(stderr, "%zu of %zu: %s %s %s in %.3g s; about %.0f s left\n", done, trials.size(),
                 trial.series.c_str(), joined(trial.overrides).c_str(), trial.failed ? "FAILED" : "done", trial.wall,
                 left);
  }
  if (interrupted) throw std::runtime_error("interrupted; the same command continues with the missing runs");
}

/// Steps, evaluations and rejections out of the last note of run.log; they stay 0 if the run did not come so far.
void read_counts(Trial &trial) {
  std::ifstream file(trial.folder + "/run.log");
  for (std::string line; std::getline(file, line);) {
    const size_t steps = line.find(" steps from "), evaluations = line.find(" evaluations of"),
                 rejections = line.find(" attempts rejected");
    if (steps == std::string::npos || evaluations == std::string::npos || rejections == std::string::npos) continue;
    const auto before = [&](size_t at) { return std::atoll(line.c_str() + line.rfind(' ', at - 1) + 1); };
    trial.steps = before(steps), trial.evaluations = before(evaluations), trial.rejections = before(rejections);
  }
}

Reference reference_of(const CompareArguments &arguments, const std::vector<Trial> &trials) {
  if (!arguments.exact.empty()) return {number_of(arguments.exact), 0, "given as exact"};
  if (trials.back().is_reference) return {trials.back().value, 0, trials.back().series};
  std::vector<std::string> names;
  for (const Trial &t : trials)
    if (std::find(names.begin(), names.end(), t.series) == names.end()) names.push_back(t.series);
  Reference best{NAN, INFINITY, "none"};
  for (const std::string &name : names) {
    std::vector<std::pair<double, double>> refined;
    for (const Trial &t : trials)
      if (t.series == name && !t.failed) refined.emplace_back(t.parameter, t.value);
    const Reference own = extrapolate(refined);
    if (own.uncertainty < best.uncertainty) best = {own.value, own.uncertainty, name + ": " + own.origin};
  }
  if (std::isinf(best.uncertainty))
    std::fprintf(stderr,
                 "no series has two runs that differ by their last key: without --exact or --reference there is "
                 "nothing to measure errors against\n");
  return best;
}

void write_csv(const std::string &path, const std::vector<Trial> &trials) {
  std::ofstream file(path);
  file.precision(10);
  file << "series,overrides,parameter,value,error,processor_s,wall_s,steps,evaluations,rejections,pareto,failure\n";
  for (const Trial &t : trials) {
    const bool beaten = std::any_of(trials.begin(), trials.end(),
                                    [&](const Trial &o) { return !o.failed && o.cpu < t.cpu && o.error < t.error; });
    file << t.series << ",\"" << joined(t.overrides) << "\"," << t.parameter << "," << t.value << "," << t.error << ","
         << t.cpu << "," << t.wall << "," << t.steps << "," << t.evaluations << "," << t.rejections << ","
         << (!t.failed && std::isfinite(t.error) && !beaten) << ",\"" << t.cause << "\"\n";
  }
}

void print(const std::vector<Trial> &trials, const std::string &measure, const Reference &reference) {
  std::printf("%s; reference %.8g +- %.2g (%s)\n\n", measure.c_str(), reference.value, reference.uncertainty,
              reference.origin.c_str());
  std::printf("%-20s %-50s %14s %10s %10s %10s %10s %8s\n", "series", "overrides", "value", "error", "cpu s", "steps",
              "evals", "rejected");
  for (const Trial &t : trials) {
    if (t.failed)
      std::printf("%-20s %-50s FAILED: %s\n", t.series.c_str(), joined(t.overrides).c_str(), t.cause.c_str());
    else
      std::printf("%-20s %-50s %14.8g %10.2e %10.3g %10lld %10lld %8lld\n", t.series.c_str(),
                  joined(t.overrides).c_str(), t.value, t.error, t.cpu, t.steps, t.evaluations, t.rejections);
  }
}

void on_signal(int) { interrupted = 1; }

int compare(CompareArguments arguments) {
  int ranks;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (ranks > 1) throw SceneError("`talus compare` starts its runs itself: call it on one rank, and give --jobs");
  arguments.scene = find_scene(arguments.scene);
  read_scene(arguments.scene, arguments.set);
  if (arguments.directory.empty())
    arguments.directory = "results/compare_" + fs::path(arguments.scene).parent_path().filename().string();
  if (arguments.jobs == 0) arguments.jobs = std::max(1u, std::thread::hardware_concurrency());
  const Measure measure = parse_measure(arguments.measure);
  if (!arguments.exact.empty() && !arguments.reference.empty())
    throw SceneError("--exact and --reference both define the true value: give one of them");
  if (!arguments.exact.empty() && !std::isfinite(number_of(arguments.exact)))
    throw SceneError("--exact " + arguments.exact + " must be a number");
  std::vector<Trial> trials = matrix(arguments);
  for (Trial &trial : trials) {
    std::vector<std::string> all = arguments.set;
    all.insert(all.end(), trial.overrides.begin(), trial.overrides.end());
    read_scene(arguments.scene, all);  // refuses a bad matrix before anything runs
    resume(arguments, trial);
  }
  std::signal(SIGINT, on_signal);
  run_all(arguments, trials);
  for (Trial &trial : trials)
    if (!trial.failed) trial.value = value_of(trial.folder + "/history.csv", measure), read_counts(trial);
  const Reference reference = reference_of(arguments, trials);
  if (trials.back().is_reference) {
    if (trials.back().failed) throw std::runtime_error("the run of --reference failed: " + trials.back().cause);
    trials.pop_back();
  }
  for (Trial &trial : trials) trial.error = std::abs(trial.value - reference.value);
  print(trials, arguments.measure, reference);
  write_csv(arguments.directory + "/compare.csv", trials);
  std::ofstream(arguments.directory + "/reference.csv")
      << std::setprecision(12) << "measure,value,uncertainty,origin\n\"" << arguments.measure << "\","
      << reference.value << "," << reference.uncertainty << ",\"" << reference.origin << "\"\n";
  if (!arguments.no_plot) draw_comparison(arguments.directory);
  std::fprintf(stderr, "table and chart are in %s\n", arguments.directory.c_str());
  return std::any_of(trials.begin(), trials.end(), [](const Trial &t) { return t.failed; }) ? 1 : 0;
}

}  // namespace

Action add_compare(CLI::App &app) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App *command =
      app.add_subcommand("compare", "run a scene in many variants: table and chart of error against processor time");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command
      ->add_option("--series", arguments->series,
                   "a line of the chart: \"NAME: key=a,b,c; key=d\"; every combination is run, and the values of the "
                   "last key count as its refinement")
      ->required()
      ->take_all();
  command
      ->add_option("--measure", arguments->measure,
                   "compared quantity: a column of history.csv at the end, COLUMN@TIME, or max:COLUMN")
      ->required();
  command->add_option("--exact", arguments->exact,
                      "the true value; without it the series that converges best is extrapolated");
  command->add_option("--reference", arguments->reference,
                      "the run whose value counts as true: \"NAME: key=a; key=b\", such as \"finite elements: "
                      "stage.0.kind=quasi_static\"");
  command->add_option("--set", arguments->set, "override a key in all runs: key.path=value")->take_all();
  command->add_option("-o,--output", arguments->directory,
                      "folder of runs, compare.csv and compare.png (default results/compare_NAME)");
  command->add_option("-j,--jobs", arguments->jobs, "runs at the same time (default: one per core)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--no-plot", arguments->no_plot, "do not draw the chart");
  return [arguments] { return compare(*arguments); };
}

}  // namespace talus
