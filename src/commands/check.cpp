#include <unistd.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "commands/foreign_code.h"
#include "commands/gallery.h"
#include "commands/slice.h"
#include "doubts/needs.h"
#include "output/pictures.h"
#include "scene/mesh_source.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  std::string scene;
  std::vector<std::string> set;
  bool slice = false, json = false, no_umat = false;
  bool draws = false;   ///< a picture
  std::string picture;  ///< file; empty: named after the scene
};

constexpr int label_width = 10, page_width = 110;

/// A line of the page with its label in the margin.
[[gnu::format(printf, 2, 3)]] void line(const char *label, const char *format, ...) {
  std::printf("%-*s", label_width, label);
  va_list arguments;
  va_start(arguments, format);
  std::vprintf(format, arguments);
  va_end(arguments);
  std::printf("\n");
}

/// A paragraph, broken between words, behind a dash.
void paragraph(const char *label, const std::string &text) {
  std::string rest = text, margin = std::string("- ");
  while (!rest.empty()) {
    const std::size_t room = page_width - label_width - 2;
    std::size_t end = rest.size() <= room ? rest.size() : rest.rfind(' ', room);
    if (end == std::string::npos) end = rest.size();
    line(label, "%s%s", margin.c_str(), rest.substr(0, end).c_str());
    rest.erase(0, std::min(rest.size(), end + 1));
    label = "", margin = "  ";
  }
}

std::string spoken_bytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, bytes < 1e9 ? "%.3g MB" : "%.3g GB", bytes / (bytes < 1e9 ? 1e6 : 1e9));
  return text;
}

std::string place(const std::array<double, 3> &x, int dimension) {
  char text[96];
  dimension == 2 ? std::snprintf(text, sizeof text, "(%.3g, %.3g) m", x[0], x[1])
                 : std::snprintf(text, sizeof text, "(%.3g, %.3g, %.3g) m", x[0], x[1], x[2]);
  return text;
}

/// What ends a stage, in words.
const char *ending_of(const Stage &stage) {
  if (const DynamicKeys *motion = stage.motion())
    return std::visit([](const auto &kind) { return kind.name; }, motion->until);
  return stage.traits().end;
}

std::string source_of(const MeshSource &mesh) {
  char size[32];
  std::snprintf(size, sizeof size, " in cells of %.3g m", mesh.size);
  const auto name = [](const std::string &path) { return std::filesystem::path(path).filename().string(); };
  std::string text =
      mesh.file.empty() ? name(mesh.section.empty() ? mesh.terrain.file : mesh.section) + size : name(mesh.file);
  if (mesh.halvings > 0)
    text += ", edges halved " + (mesh.halvings == 1 ? "once" : std::to_string(mesh.halvings) + " times");
  return text;
}

void print_costs(const Scene &scene, const Needs &n) {
  const char *per = scene.dimension == 2 ? "kg/m" : "kg";
  line("mesh", "%lld cells, %lld nodes: %s", n.mesh.cells, n.mesh.nodes, source_of(*scene.mesh).c_str());
  line("", "quality %.2f at least, %.2f on average; smallest altitude %.3g m", n.mesh.smallest_quality,
       n.mesh.mean_quality, n.mesh.smallest_altitude);
  line("bodies", "%-16s %-14s %10s %8s %5s %10s %8s %8s %12s", "", "law", "particles", "cells", "each", per, "c_p m/s",
       "c_s m/s", "critical s");
  for (const BodyNeeds &b : n.bodies)
    if (b.there())
      line("", "%-16s %-14s %10lld %8lld %5d %10.4g %8.3g %8.3g %12.3g", b.body.name.c_str(), law_name(b.law),
           b.body.particles, b.body.cells, b.body.fewest_per_cell, b.body.mass, b.wave_speed, b.shear_speed,
           b.body.critical_step);
    else
      line("", "%-16s %-14s added by a stage, not there at the start", b.body.name.c_str(), law_name(b.law));
  const char *label = "volume";
  for (const BodyNeeds &b : n.bodies) {
    if (!b.there()) continue;
    line(label, "%-16s %.4g %s in cells of %.3g m on average", b.body.name.c_str(), b.body.volume,
         scene.dimension == 2 ? "m3/m" : "m3", b.body.cell_size);
    label = "";
  }
  line("memory", "%s resident; snapshots take about %s (%lld)", spoken_bytes(n.memory).c_str(),
       spoken_bytes(n.results).c_str(), n.snapshots);
  if (n.particles() == 0) {
    line("", "stages add all soil, and none is there at the start: steps, times and scales are not known before a run");
    return;
  }
  const BodyReport &slowest = n.slowest_body().body;
  if (n.critical_step > slowest.critical_step)
    line("step", "critical %.4g s (2 / omega_max) of the filled mesh, %.2f times that of its fastest cell",
         n.critical_step, n.critical_step / slowest.critical_step);
  line(n.critical_step > slowest.critical_step ? "" : "step",
       "critical %.4g s (2 / omega_max), set by %s at %s; altitude over wave speed: %.3g s", slowest.critical_step,
       slowest.name.c_str(), place(slowest.slowest_cell, scene.dimension).c_str(), n.altitude_rule);
  if (n.critical_step < slowest.critical_step)
    line("", "critical %.4g s with explicit drag, %.2g of that", n.critical_step,
         n.critical_step / slowest.critical_step);
  line("", "%s", n.step_bound.c_str());
  line("", "%s %.4g s, %.2f of it", n.fixed_step ? "fixed at" : "taken", n.step, n.step / n.critical_step);
  for (std::size_t i = 0; i < n.stages.size(); ++i)
    if (const double damped = n.stages[i].damped_critical_step; damped > 0) {
      const auto [lower, upper] = scene.stage[i].damping_frequencies();
      line("", "critical %.4g s in stage %s, %.2g of that, by Rayleigh damping at %.3g and %.3g Hz", damped,
           n.stages[i].name.c_str(), damped / n.critical_step, lower, upper);
    }
  bool moves = false;  // in some stage
  line("stages", "%-16s %-12s %10s %10s %14s %12s", "", "until", "longest s", "steps", "wave transits", "run time");
  for (std::size_t i = 0; i < n.stages.size(); ++i) {
    const StageNeeds &s = n.stages[i];
    if (scene.stage[i].is_static()) {
      line("", "%-16s %s", s.name.c_str(), ending_of(scene.stage[i]));
      continue;
    }
    line("", "%-16s %-12s %10.4g %10.0f %14.4g %12s", s.name.c_str(), ending_of(scene.stage[i]), s.duration, s.steps,
         s.transits, n.burst_steps ? spoken(s.run_time).c_str() : "-");
    moves = true;
  }
  if (moves && !n.fixed_step)
    line("",
         "steps: the fewest in that time, all as long as the first one; soil that comes into smaller cells, or deforms "
         "them, takes shorter ones%s",
         scene.dimension == 3 ? ", slides over terrain a fifth to a third more of them" : "");
  if (n.burst_steps)
    line("run time",
         "about %s to %s on %d rank%s for these steps: an estimate from %d steps of %s each with soil at rest, and of "
         "%s with a remap, which fast soil has in each step; the mesh, files and pictures come on top%s",
         spoken(n.run_time()).c_str(), spoken(n.longest_run_time()).c_str(), n.ranks, n.ranks > 1 ? "s" : "",
         n.burst_steps, spoken(n.seconds_per_step).c_str(), spoken(n.seconds_per_remap).c_str(),
         std::ranges::any_of(scene.stage, [](const Stage &s) { return s.is_static(); })
             ? ", and stages by finite elements, which may take longer than the motion"
             : "");
}

void print_scales(const Needs &n) {
  if (n.particles() == 0) return;
  const LayerNeeds &layer = n.layer;
  line("scales", "%.3g m deep at most, crossed by a wave in %s", layer.height, spoken(layer.transit).c_str());
  for (const BodyNeeds &b : n.bodies)
    if (b.softening.slope > 0)
      line("",
           "softening of %s: strength falls with plastic strain at %.2g of 2 G; a slip surface longer than %.3g m "
           "spreads "
           "without more load",
           b.body.name.c_str(), b.softening.slope, b.softening.critical_length);
  const Drainage &d = n.drainage;
  if (d.time == 0) return;
  line("drainage", "in %s: drained (T = c_v t / L2 > %g) for k above %.1g m/s, undrained (T < %g) for k below %.1g m/s",
       spoken(d.time).c_str(), drained_factor, d.drained_above, undrained_factor, d.undrained_below);
}

void print_page(const Scene &scene, const Needs &needs) {
  std::printf("%s\n%s, %s\n\n", scene.title.empty() ? scene.file.c_str() : scene.title.c_str(), name_of(scene.phases),
              scene.dimension == 2           ? "plane strain on triangles"
              : needs.mesh.one_element_slice ? "a slice of one layer of tetrahedra"
                                             : "tetrahedra");
  print_costs(scene, needs);
  print_scales(needs);
  const char *label = "advice";
  for (const std::string &sentence : needs.advice) paragraph(label, sentence), label = "";
}

void print_json(const Scene &scene, const Needs &n) {
  Json bodies = Json::array(), stages = Json::array();
  for (const BodyNeeds &b : n.bodies)
    bodies.push_back({{"name", b.body.name},
                      {"law", law_name(b.law)},
                      {"particles", b.body.particles},
                      {"cells", b.body.cells},
                      {"fewest_particles_per_cell", b.body.fewest_per_cell},
                      {"mass_kg", b.body.mass},
                      {"volume_m3", b.body.volume},
                      {"density_kg_m3", b.density},
                      {"wave_speed_m_s", b.wave_speed},
                      {"shear_wave_speed_m_s", b.shear_speed},
                      {"cell_size_m", b.body.cell_size},
                      {"critical_step_s", b.body.critical_step},
                      {"softening_slope_over_2G", b.softening.slope},
                      {"critical_slip_length_m", b.softening.critical_length}});
  for (const StageNeeds &s : n.stages)
    stages.push_back({{"name", s.name},
                      {"duration_s", s.duration},
                      {"steps", s.steps},
                      {"transits", s.transits},
                      {"damped_critical_step_s", s.damped_critical_step},
                      {"run_time_s", s.run_time}});
  const Json page{
      {"title", scene.title},
      {"dimension", scene.dimension},
      {"phases", name_of(scene.phases)},
      {"ranks", n.ranks},
      {"mesh",
       {{"cells", n.mesh.cells},
        {"nodes", n.mesh.nodes},
        {"smallest_altitude_m", n.mesh.smallest_altitude},
        {"smallest_quality", n.mesh.smallest_quality},
        {"mean_quality", n.mesh.mean_quality},
        {"one_element_slice", n.mesh.one_element_slice}}},
      {"particles", n.particles()},
      {"bodies", bodies},
      {"layer", {{"height_m", n.layer.height}, {"modulus_Pa", n.layer.modulus}, {"transit_s", n.layer.transit}}},
      {"critical_step_s", n.critical_step},
      {"step_bound", n.step_bound},
      {"altitude_rule_s", n.altitude_rule},
      {"step_s", n.step},
      {"stages", stages},
      {"burst_steps", n.burst_steps},
      {"seconds_per_step", n.seconds_per_step},
      {"run_time_s", n.run_time()},
      {"longest_run_time_s", n.longest_run_time()},
      {"memory_B", n.memory},
      {"snapshots", n.snapshots},
      {"snapshots_B", n.results},
      {"drainage",
       {{"time_s", n.drainage.time},
        {"drained_above_m_s", n.drainage.drained_above},
        {"undrained_below_m_s", n.drainage.undrained_below}}},
      {"advice", n.advice}};
  std::printf("%s\n", page.dump(1).c_str());
}

/// The file of the picture. A wrong name is refused before the work.
std::string picture_of(const CheckArguments &arguments, const std::string &scene_file) {
  const std::string usual = short_name(scene_file) + "_model.png";
  const std::string picture = arguments.picture.empty() ? usual : arguments.picture;
  if (!arguments.draws) return picture;
  if (std::filesystem::is_directory(picture))
    throw SceneError("--picture " + picture + " is a folder: name a PNG file in it, such as " +
                     (std::filesystem::path(picture) / usual).string());
  if (std::filesystem::path(picture).extension() != ".png")
    throw SceneError("--picture " + picture + " must be the name of a PNG file, such as " + usual);
  const std::filesystem::path folder = std::filesystem::absolute(picture).parent_path();
  if (!std::filesystem::is_directory(folder))
    throw SceneError("--picture " + picture + " cannot be written: there is no folder " + folder.string());
  const bool exists = std::filesystem::exists(picture);
  if (access(exists ? picture.c_str() : folder.c_str(), W_OK))
    throw SceneError("--picture " + picture + " cannot be written: " +
                     (exists ? "it may not be changed" : "nothing may be written into " + folder.string()));
  return picture;
}

int check(const CheckArguments &arguments) {
  const std::string file = find_scene(arguments.scene), picture = picture_of(arguments, file);
  Scene scene = read_scene(file, with_slice(arguments.slice, arguments.set));
  if (arguments.no_umat) refuse_umat(scene);
  const Needs needs = find_needs(scene, arguments.draws);
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const int status = needs.burst_failure.empty() ? 0 : 1;  // as the run will end
  if (rank) return status;
  arguments.json ? print_json(scene, needs) : print_page(scene, needs);
  std::fflush(stdout);
  if (!arguments.draws) return status;
  if (!draw_model(needs.model, picture)) return 1;
  std::fprintf(stderr, "the picture of the model is %s\n", picture.c_str());
  return status;
}

}  // namespace

Action add_check(CLI::App &app) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App *command =
      app.add_subcommand("check", "estimate cost and memory of a scene without running it, and give advice");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command->add_option("--set", arguments->set, "override a key of the scene: key.path=value")->take_all();
  command->add_flag("--slice", arguments->slice, slice_meaning);
  command->add_flag("--no-umat", arguments->no_umat, "refuse laws that load a library: for scenes of strangers");
  CLI::Option *picture =
      command
          ->add_option(
              "--picture", arguments->picture,
              "draw what is modelled: soils, mesh, boundaries, loads, water, points, dimensions and stages; PNG "
              "file (default NAME_model.png)")
          ->expected(0, 1);
  command->add_flag("--json", arguments->json, "one JSON document on standard output");
  return [arguments, picture] {
    arguments->draws = picture->count() > 0;
    return check(*arguments);
  };
}

}  // namespace talus
