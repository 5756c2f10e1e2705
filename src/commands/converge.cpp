#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "commands/commands.h"
#include "commands/comparison.h"
#include "commands/gallery.h"
#include "commands/trials.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/words.h"
#include "simulation/softening.h"
#include "solvers/integrators.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

enum class Refined { cells, steps, particles };

struct ConvergeArguments : TrialOptions {
  std::string scene;
  Refined refined = Refined::cells;
  std::vector<double> values;
  double within = 5;  ///< [%]
};

/// The keys that are refined together, at their values in the scene, and the refinement.
struct Refinement {
  std::map<std::string, double> keys;
  std::vector<double> values;  ///< of the first key, from coarse to fine
  std::string unit;            ///< of the values
};

Refinement cells_of(const Scene &scene, const std::vector<double> &values) {
  const MeshSource &mesh = scene.mesh;
  if (mesh.section.empty())
    throw SceneError(
        "converge --by cells needs a scene with mesh.section, whose cells it can make anew; the mesh file " +
        mesh.file + " stays as it is: compare runs with mesh.halvings = 0 and 1, or with meshes of your own");
  Refinement r{{{"mesh.size", mesh.size}}, values, "m"};
  for (std::size_t i = 0; i < mesh.refine.size(); ++i)
    r.keys["mesh.refine." + std::to_string(i) + ".size"] = mesh.refine[i].size;
  if (values.empty()) r.values = {mesh.size * std::sqrt(2.), mesh.size, mesh.size / std::sqrt(2.)};
  return r;
}

Refinement steps_of(const Scene &scene, const std::vector<double> &values) {
  DeferredTable table = scene.integrator;
  const IntegratorSettings settings = read_integrator(table, fluids_move(scene.phases));
  Refinement r{{}, values, ""};
  double at_most = 0;
  if (const auto *controlled = std::get_if<ArkodeSettings>(&settings); controlled && controlled->step == 0)
    r.keys["integrator.velocity_tolerance"] = at_most = controlled->velocity_tolerance, r.unit = "m/s";
  else if (const StepRule rule = step_rule(settings); rule.fixed > 0)
    r.keys["integrator.step"] = at_most = rule.fixed, r.unit = "s";
  else
    r.keys["integrator.fraction"] = at_most = rule.share;
  // the scene's own step is the largest, as larger ones may be unstable
  if (values.empty()) r.values = {at_most, at_most / std::sqrt(2.), at_most / 2};
  return r;
}

Refinement particles_of(const Scene &scene, const std::vector<double> &values) {
  Refinement r{{}, values, ""};
  for (const BodySource &body : scene.body) r.keys["body." + body.name + ".particles_per_cell"] = 1;
  if (values.empty())
    r.values = scene.dimension == 2 ? std::vector<double>{3., 6., 12.} : std::vector<double>{4., 8., 20.};
  return r;
}

Refinement refinement_of(const Scene &scene, const ConvergeArguments &arguments) {
  Refinement r = arguments.refined == Refined::cells   ? cells_of(scene, arguments.values)
                 : arguments.refined == Refined::steps ? steps_of(scene, arguments.values)
                                                       : particles_of(scene, arguments.values);
  std::sort(r.values.begin(), r.values.end());
  if (arguments.refined != Refined::particles) std::reverse(r.values.begin(), r.values.end());
  if (std::adjacent_find(r.values.begin(), r.values.end()) != r.values.end() || r.values.size() < 3)
    throw SceneError(
        "converge --values needs three different values or more: two cannot show whether a result settles");
  return r;
}

/// Four digits, so that sizes read well in tables and names.
double four_digits(double value) {
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 3);
  return unit < 1 ? std::round(value / unit) / std::round(1 / unit) : std::round(value);
}

std::vector<Trial> trials_of(const Refinement &r, const std::string &directory) {
  std::vector<Trial> trials;
  const double own = r.keys.count("mesh.size") ? r.keys.at("mesh.size") : r.keys.begin()->second;
  for (const double value : r.values) {
    Trial trial;
    for (const auto &[key, start] : r.keys)
      trial.overrides.push_back(key + "=" + shortest(four_digits(start * value / own)));
    trial.folder = (fs::path(directory) / ("run_" + shortest(four_digits(value)))).string();
    trials.push_back(trial);
  }
  return trials;
}

int converge(ConvergeArguments arguments) {
  require_one_rank("converge");
  arguments.scene = find_scene(arguments.scene);
  const Scene scene = read_scene(arguments.scene, arguments.set);
  if (arguments.directory.empty()) arguments.directory = "results/converge_" + short_name(arguments.scene);
  const Refinement refinement = refinement_of(scene, arguments);
  std::vector<Trial> trials = trials_of(refinement, arguments.directory);
  std::vector<Trial *> pointers;
  for (Trial &trial : trials) pointers.push_back(&trial);
  const TrialPlan plan{arguments.scene, arguments.set, arguments};
  Trials runs(plan, pointers);
  runs.run();
  runs.write("runs.csv", {"value", "unit", "overrides"}, [&](std::size_t i) -> std::vector<std::string> {
    return {shortest(four_digits(refinement.values[i])), refinement.unit, joined(trials[i].overrides)};
  });
  const char *refined[] = {"cells", "steps", "particles"};
  std::vector<std::string> words{"--by", refined[static_cast<int>(arguments.refined)], "--within",
                                 shortest(arguments.within / 100)};
  if (std::any_of(scene.body.begin(), scene.body.end(), [](const BodySource &b) { return softens(read_law(b.law)); }))
    words.push_back("--softening");
  const int status = runs.tell("talus_converge.py", words);
  std::fprintf(stderr, "tables%s are in %s\n", arguments.no_plot ? "" : " and picture", arguments.directory.c_str());
  return status;
}

}  // namespace

Action add_converge(CLI::App &app) {
  auto arguments = std::make_shared<ConvergeArguments>();
  CLI::App *command = app.add_subcommand(
      "converge", "run a scene with several cell sizes: do the cells decide whether, when and how far it slides?");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  const std::map<std::string, Refined> names{
      {"cells", Refined::cells}, {"steps", Refined::steps}, {"particles", Refined::particles}};
  command->add_option("--by", arguments->refined, "what is refined: cells (mesh.size), steps, particles (per cell)")
      ->transform(CLI::Validator(
          [names](std::string &word) -> std::string {
            std::vector<std::string> known;
            for (const auto &[name, refined] : names) known.push_back(name);
            const auto found = names.find(word);
            if (found == names.end()) return "there is no " + word + " to refine; " + suggestion(word, known);
            word = std::to_string(static_cast<int>(found->second));
            return "";
          },
          "cells|steps|particles"))
      ->default_str("cells");
  command
      ->add_option(
          "--values", arguments->values,
          "three or more sizes [m], shares of the critical step, or numbers per cell, with commas between them "
          "(default: the scene's size times 1.414, 1, 0.707; its step times 1, 0.707, 0.5; 3, 6, 12 particles "
          "per triangle or 4, 8, 20 per tetrahedron)")
      ->delimiter(',')
      ->check(above_zero);
  command
      ->add_option("--within", arguments->within,
                   "results that differ by no more than this share of the finest run's count as equal [%] (default 5)")
      ->check(CLI::Range(0.01, 100.));
  add_trial_options(*command, *arguments, "override a key in all runs: key.path=value",
                    "folder of runs, converge.csv, converge.json and converge.png (default results/converge_NAME)")
      ->allow_extra_args(false);
  return [arguments] { return converge(*arguments); };
}

}  // namespace talus
