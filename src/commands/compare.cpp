#include <algorithm>
#include <cmath>
#include <map>

#include "commands/gallery.h"
#include "commands/sweep.h"
#include "scene/quantity.h"
#include "scene/scene.h"

namespace talus {
namespace {

struct CompareArguments : SweepOptions {
  std::string scene, measure, exact, reference;
  std::vector<std::string> series;
};

/// A value of a key as tables and charts have it: a number in the unit that was typed, else in that of its key; an
/// expression, a list or a word as it was typed.
struct KeyValue {
  Json value = "";
  std::string unit{};
};
KeyValue value_at(const std::string &key, const std::string &typed) {
  const std::string text = unquoted(typed);
  try {
    const Quantity quantity = parse_quantity(text);
    return {quantity.number, quantity.plain ? unit_of_key(key) : unit_behind(text)};
  } catch (const std::invalid_argument &) {  // an expression, a list or a word
    return {text, unit_of_key(key)};
  }
}

/// Brings values of one key to the unit of the first of them, so that they may share an axis: "0.01 MPa" after "4 kPa"
/// becomes 10 kPa. Throws SceneError where one of them is no number and has another unit.
void share_unit(const std::string &key, const KeyValue &first, KeyValue &value) {
  if (value.unit == first.unit) return;
  const auto said = [](const KeyValue &v) {
    return (v.value.is_number() ? shortest(v.value) : v.value.get<std::string>()) + " [" + v.unit + "]";
  };
  if (!value.value.is_number() || !first.value.is_number() || value.unit.empty() || first.unit.empty())
    throw SceneError("the series give " + key + " the values " + said(first) + " and " + said(value) +
                     ", which cannot share an axis: write both as numbers, or both in the unit of the key");
  value.value = value.value.get<double>() * parse_quantity("1 " + value.unit).si / parse_quantity("1 " + first.unit).si;
  value.unit = first.unit;
}

/// The runs of a series: the last key is the one that it refines.
void add_series(Sweep &sweep, const Scene &scene, const char *option, const std::string &text,
                std::map<std::string, KeyValue> &first) {
  const Series series = parse_series(text);
  std::vector<std::string> keys;
  for (const auto &[key, values] : series.lists) keys.push_back(key);
  if (const std::string wrong = same_keys(scene, keys); !wrong.empty())
    throw SceneError(std::string(option) + " \"" + text + "\" " + wrong);
  for (const auto &overrides : products(series)) {
    const std::string key = keys.empty() ? "" : keys.back();
    KeyValue setting;
    if (!keys.empty()) {
      setting = value_at(key, overrides.back().substr(key.size() + 1));
      share_unit(key, first.try_emplace(key, setting).first->second, setting);
    }
    sweep.trials.push_back(
        {.overrides = overrides,
         .columns = {{"series", series.name}, {"key", key}, {"value", setting.value}, {"unit", setting.unit}}});
  }
}

int compare(CompareArguments arguments) {
  arguments.scene = find_scene(arguments.scene);
  const Scene scene = read_scene(arguments.scene, arguments.set);
  const bool measured = !arguments.measure.empty(), exact = !arguments.exact.empty(),
             reference = !arguments.reference.empty();
  if (arguments.directory.empty())
    arguments.directory = (measured ? "results/compare_" : "results/sweep_") + short_name(arguments.scene);
  if (!measured && (exact || reference))
    throw SceneError("--exact and --reference belong to a --measure: name the column of history.csv that is compared");
  if (exact && reference) throw SceneError("--exact and --reference both define the true value: give one of them");
  if (exact && !std::isfinite(number_of(arguments.exact)))
    throw SceneError("--exact " + arguments.exact + " must be a number");
  Sweep sweep{.scene = arguments.scene, .set = arguments.set, .options = arguments};
  sweep.shown["preset"] = measured ? "errors" : "outcomes";
  if (measured) sweep.measures = {arguments.measure};
  if (exact) sweep.shown["exact"] = number_of(arguments.exact);
  std::map<std::string, KeyValue> first;
  for (const std::string &text : arguments.series) add_series(sweep, scene, "--series", text, first);
  const std::size_t compared = sweep.trials.size();
  if (reference) {
    first.clear();  // it stands on no axis
    add_series(sweep, scene, "--reference", arguments.reference, first);
    sweep.shown["reference"] = compared;
    if (sweep.trials.size() != compared + 1)
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
  command->add_option(
      "--measure", arguments->measure,
      "quantity whose error is charted against processor time: a column of history.csv at the end, "
      "COLUMN@TIME, or max:COLUMN; without it the outcomes of all runs are charted against the last key");
  command->add_option("--exact", arguments->exact,
                      "the true value; without it the series that converges best is extrapolated");
  command->add_option("--reference", arguments->reference,
                      "the run whose value counts as true: \"NAME: key=a; key=b\", such as \"finite elements: "
                      "stage.0.kind=quasi_static\"");
  add_sweep_options(
      *command, *arguments, "override a key in all runs: key.path=value",
      "folder of runs, table and charts (default results/compare_NAME, without --measure results/sweep_NAME)");
  return [arguments] { return compare(*arguments); };
}

}  // namespace talus
