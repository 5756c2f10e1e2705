#include <algorithm>
#include <map>
#include <optional>

#include "commands/gallery.h"
#include "commands/sweep.h"
#include "scene/quantity.h"
#include "scene/scene.h"

namespace talus {
namespace {

struct CompareArguments : SweepOptions {
  std::string scene, measure, reference;
  std::optional<double> exact;
  std::vector<std::string> series;
};

/// The runs of a series: the last key is the one that it refines.
void add_series(Sweep &sweep, const Scene &scene, const std::string &text) {
  const Series series = parse_series(text);
  std::vector<std::string> keys;
  for (const auto &[key, values] : series.lists) keys.push_back(key);
  if (const std::string wrong = same_keys(scene, keys); !wrong.empty()) throw SceneError("\"" + text + "\" " + wrong);
  const std::string key = keys.empty() ? "" : keys.back();
  for (const auto &overrides : products(series)) {
    const std::string value = keys.empty() ? "" : overrides.back().substr(key.size() + 1);
    sweep.trials.push_back(
        {.overrides = overrides, .columns = {{"series", series.name}, {"key", key}, {"value", value}}});
  }
}

/// Values of each key as charts have them: numbers in the one unit that they have, or all of them as they were typed
/// where one is an expression, a list or a word. Throws SceneError where numbers have different units.
void read_values(std::vector<Trial> &trials) {
  std::map<std::string, std::vector<std::string>> of_keys;
  for (const Trial &trial : trials) of_keys[trial.columns["key"]].push_back(trial.columns["value"]);
  for (const auto &[key, values] : of_keys)
    if (const std::string wrong = mixed_units(values); !wrong.empty())
      throw SceneError("--series: " + key + " " + wrong);
  for (Trial &trial : trials) {
    const std::string key = trial.columns["key"], text = trial.columns["value"];
    const bool numbers =
        std::ranges::all_of(of_keys.at(key), [](const auto &value) { return looks_like_quantity(value); });
    const Typed value = typed(text);
    if (numbers) trial.columns["value"] = value.number;
    trial.columns["unit"] = numbers && !value.unit.empty() ? value.unit : unit_of_key(key);
  }
}

int compare(CompareArguments arguments) {
  arguments.scene = find_scene(arguments.scene);
  const Scene scene = read_scene(arguments.scene, arguments.set);
  const bool measured = !arguments.measure.empty();
  if (arguments.directory.empty())
    arguments.directory = (measured ? "results/compare_" : "results/sweep_") + short_name(arguments.scene);
  Sweep sweep{.scene = arguments.scene, .set = arguments.set, .options = arguments};
  sweep.shown["preset"] = measured ? "errors" : "outcomes";
  if (measured) sweep.measures = {arguments.measure};
  if (arguments.exact) sweep.shown["exact"] = *arguments.exact;
  for (const std::string &text : arguments.series) add_series(sweep, scene, text);
  read_values(sweep.trials);
  if (!arguments.reference.empty()) {  // it stands on no axis
    sweep.shown["reference"] = sweep.trials.size();
    add_series(sweep, scene, arguments.reference);
    if (sweep.trials.size() != sweep.shown["reference"].get<std::size_t>() + 1)
      throw SceneError("--reference \"" + arguments.reference + "\" must be one run: one value for each key");
  }
  return perform(sweep);
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
  CLI::Option *measure = command->add_option(
      "--measure", arguments->measure,
      "quantity whose error is charted against processor time: a column of history.csv at the end, "
      "COLUMN@TIME, or max:COLUMN; without it the outcomes of all runs are charted against the last key");
  CLI::Option *exact = command
                           ->add_option("--exact", arguments->exact,
                                        "the true value; without it the series that converges best is extrapolated")
                           ->needs(measure);
  command
      ->add_option("--reference", arguments->reference,
                   "the run whose value counts as true: \"NAME: key=a; key=b\", such as \"finite elements: "
                   "stage.0.kind=quasi_static\"")
      ->needs(measure)
      ->excludes(exact);
  add_sweep_options(
      *command, *arguments, "override a key in all runs: key.path=value",
      "folder of runs, table and charts (default results/compare_NAME, without --measure results/sweep_NAME)");
  return [arguments] { return compare(*arguments); };
}

}  // namespace talus
