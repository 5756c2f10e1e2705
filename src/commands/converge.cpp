#include <algorithm>
#include <cmath>
#include <map>

#include "commands/gallery.h"
#include "commands/sweep.h"
#include "scene/body_source.h"
#include "scene/mesh_source.h"
#include "scene/scene.h"
#include "solvers/integrators.h"

namespace talus {
namespace {

struct ConvergeArguments : SweepOptions {
  std::string scene, by = "cells";
  std::vector<double> values;
  double within = 5;  ///< [%]
};

/// What is refined: a key and its values from coarse to fine, and other keys in proportion to it.
struct Refinement {
  std::string key, unit;
  std::vector<double> values;
  std::map<std::string, double> shares;  ///< of all keys, over the value of `key`
};

Refinement cells_of(const Scene &scene) {
  const MeshSource &mesh = *scene.mesh;
  if (mesh.section.empty())
    throw SceneError(
        "converge --by cells needs a scene with mesh.section, whose cells it can make anew; the mesh file " +
        mesh.file + " stays as it is: compare runs with mesh.halvings = 0 and 1, or with meshes of your own");
  Refinement r{"mesh.size", "m", {mesh.size * std::sqrt(2.), mesh.size, mesh.size / std::sqrt(2.)}, {{"mesh.size", 1}}};
  for (std::size_t i = 0; i < mesh.refine.size(); ++i)
    r.shares["mesh.refine." + std::to_string(i) + ".size"] = mesh.refine[i].size / mesh.size;
  return r;
}

/// The scene's own step is the largest, as larger ones may be unstable.
Refinement steps_of(const Scene &scene) {
  DeferredTable table = scene.integrator;
  const IntegratorSettings settings = read_integrator(table, fluids_move(scene.phases));
  const auto *controlled = std::get_if<ArkodeSettings>(&settings);
  const StepRule rule = step_rule(settings);
  const auto [key, unit, most] = controlled && controlled->step == 0
                                     ? std::tuple("velocity_tolerance", "m/s", controlled->velocity_tolerance)
                                 : rule.fixed > 0 ? std::tuple("step", "s", rule.fixed)
                                                  : std::tuple("fraction", "", rule.share);
  const std::string path = std::string("integrator.") + key;
  return {path, unit, {most, most / std::sqrt(2.), most / 2}, {{path, 1}}};
}

Refinement particles_of(const Scene &scene) {
  Refinement r{"particles_per_cell", "", {3, 6, 12}, {}};
  if (scene.dimension == 3) r.values = {4, 8, 20};
  for (const BodySource &body : scene.body) r.shares["body." + body.name + ".particles_per_cell"] = 1;
  return r;
}

const std::map<std::string, Refinement (*)(const Scene &)> refinements{
    {"cells", cells_of}, {"steps", steps_of}, {"particles", particles_of}};

int converge(ConvergeArguments arguments) {
  arguments.scene = find_scene(arguments.scene);
  const Scene scene = read_scene(arguments.scene, arguments.set);
  if (arguments.directory.empty()) arguments.directory = "results/converge_" + short_name(arguments.scene);
  const Refinement r = refinements.at(arguments.by)(scene);
  std::vector<double> values = arguments.values.empty() ? r.values : arguments.values;
  std::ranges::sort(values);
  if (arguments.by != "particles") std::ranges::reverse(values);
  if (std::ranges::adjacent_find(values) != values.end() || values.size() < 3)
    throw SceneError(
        "converge --values needs three different values or more: two cannot show whether a result settles");
  Sweep sweep{.scene = arguments.scene, .set = arguments.set, .options = arguments};
  sweep.shown = {{"preset", "converge"}, {"by", arguments.by}, {"within", arguments.within / 100}};
  for (const double value : values) {
    const std::string name = in_digits(value, 4);  // reads well in tables and names
    Trial trial{.columns = {{"series", arguments.by}, {"key", r.key}, {"value", std::stod(name)}, {"unit", r.unit}},
                .folder = "run_" + name};  // more values go on with the same folder
    for (const auto &[key, share] : r.shares) trial.overrides.push_back(key + "=" + in_digits(share * value, 4));
    sweep.trials.push_back(trial);
  }
  return perform(sweep);
}

}  // namespace

Action add_converge(CLI::App &app) {
  auto arguments = std::make_shared<ConvergeArguments>();
  CLI::App *command = app.add_subcommand(
      "converge",
      "run a scene with several cell sizes: do the cells decide whether, when and how far it slides? Exit status 1: "
      "they do, as a result has not settled");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command->add_option("--by", arguments->by, "what is refined: cells (mesh.size), steps, particles (per cell)")
      ->check(CLI::IsMember(refinements))
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
