#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>

#include "base/rounded.h"
#include "commands/commands.h"
#include "commands/comparison.h"
#include "commands/gallery.h"
#include "commands/trials.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

struct CompareArguments : TrialOptions {
  std::string scene, measure, exact, reference;
  std::vector<std::string> series;
};

/// One run of the matrix; its label is the name of its series.
struct Variant : Trial {
  std::string key;            ///< that the series refines, its last one; empty where it sets none
  KeyValue setting;           ///< its value
  double parameter = NAN;     ///< the number of that, if there is one
  bool is_reference = false;  ///< its value is the one that the others are compared with
  double value = NAN, error = NAN;
  long long steps = 0, evaluations = 0, rejections = 0;
};

std::vector<Variant> matrix(const CompareArguments &arguments, const Scene &scene) {
  std::vector<Variant> trials;
  const auto parsed = [&](const char *option, const std::string &text) {
    const Series series = parse_series(text);
    std::vector<std::string> keys;
    for (const auto &[key, values] : series.lists) keys.push_back(key);
    if (const std::string wrong = same_keys(scene, keys); !wrong.empty())
      throw SceneError(std::string(option) + " \"" + text + "\" " + wrong);
    return series;
  };
  for (const std::string &text : arguments.series) {
    const Series series = parsed("--series", text);
    for (const auto &overrides : products(series)) {
      Variant trial;
      trial.label = series.name, trial.overrides = overrides;
      if (!overrides.empty()) {
        const size_t at = overrides.back().find('=');
        trial.key = overrides.back().substr(0, at),
        trial.setting = value_at(trial.key, overrides.back().substr(at + 1));
      }
      trials.push_back(trial);
    }
  }
  std::map<std::string, std::vector<KeyValue *>> settings;
  for (Variant &trial : trials) settings[trial.key].push_back(&trial.setting);
  for (const auto &[key, values] : settings) share_unit(key, values);
  for (Variant &trial : trials) trial.parameter = number_of(trial.setting.text);
  if (!arguments.reference.empty()) {
    const Series series = parsed("--reference", arguments.reference);
    const auto overrides = products(series);
    if (overrides.size() != 1)
      throw SceneError("--reference \"" + arguments.reference + "\" must be one run: one value for each key");
    Variant trial;
    trial.label = series.name, trial.overrides = overrides.front(), trial.is_reference = true;
    trials.push_back(trial);
  }
  for (size_t i = 0; i < trials.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "run%03zu", i);
    trials[i].folder = (fs::path(arguments.directory) / name).string();
  }
  return trials;
}

/// Steps, evaluations and rejections at the end of a run; they stay 0 if it did not come so far.
void read_counts(Variant &trial) {
  for (const Event &one : read_events(trial.folder)) {
    if (one.kind != event::steps) continue;
    const std::map<std::string, double> counts(one.values.begin(), one.values.end());
    trial.steps = std::llround(counts.at("steps")), trial.evaluations = std::llround(counts.at("evaluations")),
    trial.rejections = std::llround(counts.at("rejections"));
  }
}

Reference reference_of(const CompareArguments &arguments, const std::vector<Variant> &trials) {
  if (!arguments.exact.empty()) return {number_of(arguments.exact), 0, "given as exact"};
  if (trials.back().is_reference) return {trials.back().value, 0, trials.back().label};
  std::vector<std::string> names;
  for (const Variant &t : trials)
    if (std::find(names.begin(), names.end(), t.label) == names.end()) names.push_back(t.label);
  Reference best{NAN, INFINITY, "none"};
  for (const std::string &name : names) {
    std::vector<std::pair<double, double>> refined;
    for (const Variant &t : trials)
      if (t.label == name && !t.failed) refined.emplace_back(t.parameter, t.value);
    const Reference own = extrapolate(refined);
    if (own.uncertainty < best.uncertainty) best = {own.value, own.uncertainty, name + ": " + own.origin};
  }
  if (std::isinf(best.uncertainty))
    std::fprintf(stderr,
                 "no series has two runs that differ by their last key: without --exact or --reference there is "
                 "nothing to measure errors against\n");
  return best;
}

/// Does no other run take less time and have a smaller error?
bool on_front(const Variant &t, const std::vector<Variant> &trials) {
  return !t.failed && std::isfinite(t.error) && std::none_of(trials.begin(), trials.end(), [&](const Variant &o) {
    return !o.is_reference && !o.failed && o.cpu < t.cpu && o.error < t.error;
  });
}

/// Outcomes of each run against the last key of its series: whether and when it fails, how far and how fast it moves.
int sweep(const CompareArguments &arguments, const std::vector<Variant> &trials, const Trials &runs) {
  runs.write("runs.csv", {"series", "overrides", "key", "value", "unit"},
             [&](std::size_t i) -> std::vector<std::string> {
               const Variant &t = trials[i];
               return {t.label, joined(t.overrides), t.key, t.setting.text, t.setting.unit};
             });
  const int status = runs.tell("talus_sweep.py");
  std::fprintf(stderr, "sweep.csv%s in %s\n", arguments.no_plot ? " is" : " and sweep.png are",
               arguments.directory.c_str());
  return status;
}

int compare(CompareArguments arguments) {
  require_one_rank("compare");
  arguments.scene = find_scene(arguments.scene);
  const Scene scene = read_scene(arguments.scene, arguments.set);
  if (arguments.directory.empty())
    arguments.directory =
        (arguments.measure.empty() ? "results/sweep_" : "results/compare_") + short_name(arguments.scene);
  if (arguments.measure.empty() && !(arguments.exact.empty() && arguments.reference.empty()))
    throw SceneError("--exact and --reference belong to a --measure: name the column of history.csv that is compared");
  const Measure measure = arguments.measure.empty() ? Measure{} : parse_measure(arguments.measure);
  if (!arguments.exact.empty() && !arguments.reference.empty())
    throw SceneError("--exact and --reference both define the true value: give one of them");
  if (!arguments.exact.empty() && !std::isfinite(number_of(arguments.exact)))
    throw SceneError("--exact " + arguments.exact + " must be a number");
  std::vector<Variant> trials = matrix(arguments, scene);
  std::vector<Trial *> pointers;
  for (Variant &trial : trials) pointers.push_back(&trial);
  TrialPlan plan{arguments.scene, arguments.set, arguments};
  if (!arguments.measure.empty()) plan.measures = {measure};
  Trials runs(plan, pointers);
  runs.run();
  if (arguments.measure.empty()) return sweep(arguments, trials, runs);
  for (Variant &trial : trials)
    if (!trial.failed) trial.value = value_of(trial.folder + "/history.csv", measure), read_counts(trial);
  const Reference reference = reference_of(arguments, trials);
  if (trials.back().is_reference && trials.back().failed)
    throw std::runtime_error("the run of --reference failed: " + trials.back().cause);
  for (Variant &trial : trials) trial.error = std::abs(trial.value - reference.value);
  runs.write("compare.csv",
             {"series", "overrides", "key", "unit", "parameter", "value", "error", "steps", "evaluations", "rejections",
              "pareto"},
             [&](std::size_t i) -> std::vector<std::string> {
               const Variant &t = trials[i];
               if (t.is_reference) return {};
               return {t.label,
                       joined(t.overrides),
                       t.key,
                       t.setting.unit,
                       rounded(t.parameter, 10),
                       rounded(t.value, 10),
                       rounded(t.error, 10),
                       std::to_string(t.steps),
                       std::to_string(t.evaluations),
                       std::to_string(t.rejections),
                       std::to_string(on_front(t, trials))};
             });
  std::ofstream(arguments.directory + "/reference.csv")
      << std::setprecision(12) << "measure,value,uncertainty,origin\n\"" << arguments.measure << "\","
      << reference.value << "," << reference.uncertainty << ",\"" << reference.origin << "\"\n";
  runs.tell("talus_compare.py");
  std::fprintf(stderr, "table%s in %s\n", arguments.no_plot ? " is" : " and chart are", arguments.directory.c_str());
  return std::any_of(trials.begin(), trials.end(), [](const Variant &t) { return t.failed; }) ? 1 : 0;
}

}  // namespace

Action add_compare(CLI::App &app) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App *command = app.add_subcommand(
      "compare", "run a scene in many variants: outcomes against a key, or error against processor time");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command
      ->add_option("--series", arguments->series,
                   "a line of the chart: \"NAME: key=a,b,c; key=d\"; every combination is run, and the values of the "
                   "last key count as its refinement")
      ->required()
      ->take_all();
  command->add_option(
      "--measure", arguments->measure,
      "quantity whose error is charted against processor time: a column of history.csv at the end, "
      "COLUMN@TIME, or max:COLUMN; without it the outcomes of all runs are charted against the last key");
  command->add_option("--exact", arguments->exact,
                      "the true value; without it the series that converges best is extrapolated");
  command->add_option("--reference", arguments->reference,
                      "the run whose value counts as true: \"NAME: key=a; key=b\", such as \"finite elements: "
                      "stage.0.kind=quasi_static\"");
  add_trial_options(
      *command, *arguments, "override a key in all runs: key.path=value",
      "folder of runs, tables and charts (default results/compare_NAME, without --measure results/sweep_NAME)");
  return [arguments] { return compare(*arguments); };
}

}  // namespace talus
