#include <algorithm>
#include <cmath>
#include <csignal>

#include "commands/commands.h"
#include "commands/foreign_code.h"
#include "commands/gallery.h"
#include "commands/starter.h"
#include "doubts/doubts.h"
#include "output/pictures.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "scene/stage.h"
#include "simulation.h"
#include "simulation/factor_document.h"

namespace talus {
namespace {

struct SolveArguments {
  std::string scene, directory;
  std::vector<std::string> set;
  bool no_pictures = false, no_umat = false, factor_of_safety = false, json = false, force = false;
};

void on_signal(int) {
  interrupted = 1;
  end_soon_without_starter();
}

/// The critical mechanism, then the others.
std::vector<Mechanism> mechanisms_of(const FactorOfSafety &factor) {
  std::vector<Mechanism> all{factor};
  all.insert(all.end(), factor.further.begin(), factor.further.end());
  return all;
}

std::string in_words(const FactorBracket &b) {
  char text[300];
  if (b.decided)
    std::snprintf(text, sizeof text, "%.3f: equilibrium with strength divided by %.4g, a mechanism by %.4g", b.value(),
                  b.lower, b.upper);
  else
    std::snprintf(text, sizeof text,
                  "%s %.4g and %.4g: equilibrium with strength divided by %.4g, a mechanism by %.4g, and every "
                  "trial between these two found neither%s",
                  b.failed() ? "was not found. It is somewhere between" : "between", b.lower, b.upper, b.lower, b.upper,
                  b.failed() ? ": the search has failed. Another mesh may help, or other [[stage]] load_steps" : "");
  return text;
}

/// The factor with the other assumption on the pore water, and what psi < phi leaves open.
void print_bounds(const Mechanism &m, TrialFlow flow) {
  if (m.by_flow.contains(TrialFlow::undrained)) {
    const TrialFlow other = other_flow(m, flow);
    const FactorBracket &b = m.by_flow.at(other);
    std::printf("factor of safety%s: %s\n", about_water(m, other).c_str(),
                b.lower == 0   ? "none, the soil does not stand"
                : b.upper == 0 ? "none, the soil does not fail"
                               : in_words(b).c_str());
  }
  if (!m.by_flow.contains(TrialFlow::own)) return;
  std::printf("  with psi = phi, an upper bound, which limit equilibrium assumes: %s\n",
              in_words(m.by_flow.at(TrialFlow::associated)).c_str());
  std::printf("  with the strength of Davis (1968), a lower estimate: %s\n",
              in_words(m.by_flow.at(TrialFlow::davis)).c_str());
}

void print(const FactorOfSafety &factor) {
  const std::string water = about_water(factor, factor.flow);
  std::printf("factor of safety%s %s\n", (water + (water.empty() ? "" : ":")).c_str(), in_words(factor).c_str());
  print_bounds(factor, factor.flow);
  if (factor.weakened.upper > 0)
    std::printf("  of soil that weakens from great strength, in place of the stress of the stages: %s\n",
                in_words(factor.weakened).c_str());
  for (size_t k = 0; k < factor.further.size(); ++k) {
    const Mechanism &m = factor.further[k];
    std::printf("mechanism %zu, from x = %.4g to %.4g m, which moves %.3g %% of the soil of mechanism 1: %s\n", k + 2,
                m.low[0], m.high[0], 100 * m.of_critical, in_words(m).c_str());
    print_bounds(m, factor.flow);
  }
}

int solve(const SolveArguments &arguments) {
  if (arguments.json && !arguments.factor_of_safety)
    throw std::invalid_argument("--json writes the factor of safety: give --factor-of-safety too");
  const std::string file = find_scene(arguments.scene);
  Scene scene = read_scene(file, arguments.set);
  if (arguments.no_umat) refuse_umat(scene);
  std::erase_if(scene.stage, [](const Stage &stage) { return !stage.is_static(); });
  if (scene.stage.empty())
    throw std::invalid_argument(
        file +
        " has no quasi-static stage to solve: all of its stages are of kind = \"dynamic\". Put one before them:\n"
        "[[stage]]\nname = \"gravity\"\nkind = \"quasi_static\"\nduration = 1\nsoftening = false");
  if (arguments.factor_of_safety) scene.add_factor_stage();
  RunOptions options;
  options.directory =
      arguments.directory.empty() ? default_results(file, arguments.set, "_solve") : arguments.directory;
  options.replace = arguments.force;
  options.pictures = options.checkpoints = false, options.gauss_points = true;
  say_doubts(options, scene);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGUSR1, on_signal);  // mpirun hands it on, and does not kill ranks after it
  std::signal(SIGXFSZ, SIG_IGN);    // a limit on file sizes is an error of writing, not the end
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  int status = 0;
  simulation->run();
  if (scene.finds_factor()) {
    const FactorOfSafety factor = simulation->factor_of_safety();
    for (const Mechanism &m : mechanisms_of(factor))
      if (!m.decided || std::ranges::any_of(m.by_flow, [](const auto &f) { return !f.second.decided; }))
        status = undecided_status;
    if (rank == 0) arguments.json ? static_cast<void>(std::fputs(document_of(factor).c_str(), stdout)) : print(factor);
  }
  if (rank == 0 && !arguments.no_pictures) {
    PictureChoice choice;
    choice.fields = {"displacement", "shear_strain"};
    if (scene.phases != PhaseModel::dry) choice.fields.push_back("pore_pressure");
    if (!draw_pictures(options.directory, choice)) throw std::runtime_error(without_pictures(options.directory));
  }
  if (rank == 0)
    std::fprintf(stderr, "results are in %s: %srun.xdmf for ParaView\n", options.directory.c_str(),
                 arguments.no_pictures ? "" : "report.html to read, ");
  return status;
}

}  // namespace

Action add_solve(CLI::App &app) {
  auto arguments = std::make_shared<SolveArguments>();
  CLI::App *command =
      app.add_subcommand("solve", "solve the quasi-static stages of a scene by finite elements; factor of safety");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command->add_option("-o,--output", arguments->directory,
                      "folder of the results (default results/NAME_solve, with what --set changes)");
  command->add_option("--set", arguments->set, "override a key of the scene: key.path=value")->take_all();
  command->add_flag("--no-umat", arguments->no_umat, "refuse laws that load a library: for scenes of strangers");
  command->add_flag("--factor-of-safety", arguments->factor_of_safety,
                    "reduce strength after the stages until the soil fails; status 3 if a trial between the ends of "
                    "its bracket found neither equilibrium nor mechanism, so that it stays wider than 0.5 %");
  command->add_flag("--json", arguments->json, "print the factor of safety as one JSON document");
  command->add_flag("--force", arguments->force, "replace the results of another run in that folder");
  command->add_flag("--no-pictures", arguments->no_pictures, "do not draw pictures at the end");
  return [arguments] { return solve(*arguments); };
}

}  // namespace talus
