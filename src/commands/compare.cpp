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

/// Values of each key as tables and charts have them: numbers in the unit of the first of them, so that "0.01 MPa"
/// after "4 kPa" becomes 10 kPa, or all of them as they were typed where one is an expression, a list or a word.
void share_units(std::vector<Trial> &trials) {
  std::map<std::string, std::vector<Trial *>> of_keys;
  for (Trial &trial : trials) of_keys[trial.columns["key"]].push_back(&trial);
  for (auto &[key, runs] : of_keys) {
    const std::string own = unit_of_key(key);
    for (Trial *run : runs) run->columns["unit"] = own;
    std::vector<double> numbers;
    std::string unit;
    try {
      for (const Trial *run : runs) {
        const Typed value = typed(run->columns["value"]);
        const std::string behind = value.unit.empty() ? own : value.unit;
        if (numbers.empty()) unit = behind;
        parse_quantity(run->columns["value"].get<std::string>());  // throws unless it is a number
        const auto si = [](const std::string &name) { return name.empty() ? 1 : parse_quantity("1 " + name).si; };
        numbers.push_back(behind == unit ? value.number : value.number * si(behind) / si(unit));
      }
    } catch (const std::invalid_argument &) {
      continue;
    }
    for (std::size_t i = 0; i < runs.size(); ++i)
      runs[i]->columns["value"] = numbers[i], runs[i]->columns["unit"] = unit;
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
  share_units(sweep.trials);
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
