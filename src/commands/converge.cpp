#include <algorithm>
#include <cmath>
#include <map>

#include "commands/gallery.h"
#include "commands/sweep.h"
#include "scene/body_source.h"
#include "scene/mesh_source.h"
#include "scene/quantity.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/words.h"
#include "simulation/softening.h"
#include "solvers/integrators.h"

namespace talus {
namespace {

struct ConvergeArguments : SweepOptions {
  std::string scene, by = "cells";
  std::vector<double> values;
  double within = 5;  ///< [%]
};

/// The keys that are refined together, at their values in the scene, and the refinement.
struct Refinement {
  std::map<std::string, double> keys;
  std::vector<double> values;  ///< of the first key, from coarse to fine
  std::string unit;            ///< of the values
};

Refinement cells_of(const Scene &scene) {
  const MeshSource &mesh = *scene.mesh;
  if (mesh.section.empty())
    throw SceneError(
        "converge --by cells needs a scene with mesh.section, whose cells it can make anew; the mesh file " +
        mesh.file + " stays as it is: compare runs with mesh.halvings = 0 and 1, or with meshes of your own");
  Refinement r{{{"mesh.size", mesh.size}}, {mesh.size * std::sqrt(2.), mesh.size, mesh.size / std::sqrt(2.)}, "m"};
  for (std::size_t i = 0; i < mesh.refine.size(); ++i)
    r.keys["mesh.refine." + std::to_string(i) + ".size"] = mesh.refine[i].size;
  return r;
}

/// The scene's own step is the largest, as larger ones may be unstable.
Refinement steps_of(const Scene &scene) {
  const auto refined = [](const char *key, double most, const char *unit) {
    return Refinement{{{key, most}}, {most, most / std::sqrt(2.), most / 2}, unit};
  };
  DeferredTable table = scene.integrator;
  const IntegratorSettings settings = read_integrator(table, fluids_move(scene.phases));
  if (const auto *controlled = std::get_if<ArkodeSettings>(&settings); controlled && controlled->step == 0)
    return refined("integrator.velocity_tolerance", controlled->velocity_tolerance, "m/s");
  const StepRule rule = step_rule(settings);
  return rule.fixed > 0 ? refined("integrator.step", rule.fixed, "s") : refined("integrator.fraction", rule.share, "");
}

Refinement particles_of(const Scene &scene) {
  Refinement r{{}, {3, 6, 12}, ""};
  if (scene.dimension == 3) r.values = {4, 8, 20};
  for (const BodySource &body : scene.body) r.keys["body." + body.name + ".particles_per_cell"] = 1;
  return r;
}

Refinement refinement_of(const Scene &scene, const ConvergeArguments &arguments) {
  Refinement r = arguments.by == "cells"   ? cells_of(scene)
                 : arguments.by == "steps" ? steps_of(scene)
                                           : particles_of(scene);
  if (!arguments.values.empty()) r.values = arguments.values;
  std::sort(r.values.begin(), r.values.end());
  if (arguments.by != "particles") std::reverse(r.values.begin(), r.values.end());
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

int converge(ConvergeArguments arguments) {
  arguments.scene = find_scene(arguments.scene);
  const Scene scene = read_wholly(arguments.scene, arguments.set, arguments.no_umat);
  if (arguments.directory.empty()) arguments.directory = "results/converge_" + short_name(arguments.scene);
  const Refinement r = refinement_of(scene, arguments);
  Sweep sweep{.scene = arguments.scene, .set = arguments.set, .options = arguments};
  const bool softening =
      std::any_of(scene.body.begin(), scene.body.end(), [](const BodySource &b) { return softens(read_law(b.law)); });
  sweep.shown = {
      {"preset", "converge"}, {"by", arguments.by}, {"within", arguments.within / 100}, {"softening", softening}};
  const double own = r.keys.count("mesh.size") ? r.keys.at("mesh.size") : r.keys.begin()->second;
  for (const double value : r.values) {
    Trial trial{.columns = {{"value", four_digits(value)}, {"unit", r.unit}},
                .folder = "run_" + shortest(four_digits(value))};  // more values go on with the same folder
    for (const auto &[key, start] : r.keys)
      trial.overrides.push_back(key + "=" + shortest(four_digits(start * value / own)));
    sweep.trials.push_back(trial);
  }
  return perform(sweep);
}

}  // namespace

Action add_converge(CLI::App &app) {
  auto arguments = std::make_shared<ConvergeArguments>();
  CLI::App *command = app.add_subcommand(
      "converge", "run a scene with several cell sizes: do the cells decide whether, when and how far it slides?");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command->add_option("--by", arguments->by, "what is refined: cells (mesh.size), steps, particles (per cell)")
      ->check(CLI::Validator(
          [](const std::string &word) {
            const std::vector<std::string> known{"cells", "particles", "steps"};
            return std::ranges::count(known, word) ? std::string()
                                                   : "there is no " + word + " to refine; " + suggestion(word, known);
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
  add_sweep_options(*command, *arguments, "override a key in all runs: key.path=value",
                    "folder of runs, table and picture (default results/converge_NAME)")
      ->allow_extra_args(false);
  return [arguments] { return converge(*arguments); };
}

}  // namespace talus
