#include <csignal>
#include <filesystem>

#include "commands/commands.h"
#include "commands/gallery.h"
#include "output/pictures.h"
#include "scene/reader.h"
#include "simulation.h"

namespace talus {
namespace {

struct SolveArguments {
  std::string scene, directory;
  std::vector<std::string> set;
  bool no_pictures = false, factor_of_safety = false;
};

void on_signal(int) { interrupted = 1; }

int solve(const SolveArguments &arguments) {
  const std::string file = find_scene(arguments.scene);
  Scene scene = read_scene(file, arguments.set);
  const auto dynamic = [](const Stage &stage) { return stage.kind == StageKind::dynamic; };
  std::erase_if(scene.stage, dynamic);
  if (scene.stage.empty())
    scene.complain("stage", "has no quasi-static stage to solve; set its kind = \"quasi_static\"");
  RunOptions options;
  options.directory = arguments.directory.empty()
                          ? "results/" + std::filesystem::path(file).parent_path().filename().string()
                          : arguments.directory;
  options.pictures = false, options.gauss_points = true;
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes is an error of writing, not the end
  const auto simulation = make_simulation(PETSC_COMM_WORLD, scene, options);
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (arguments.factor_of_safety) {
    const FactorOfSafety factor = simulation->factor_of_safety();
    if (rank == 0)
      std::printf("factor of safety %.3f: equilibrium with strength divided by %.4g, none by %.4g\n", factor.value(),
                  factor.lower, factor.upper);
  } else {
    simulation->run();
  }
  if (rank == 0 && !arguments.no_pictures) {
    PictureChoice choice;
    choice.fields = {"displacement", "shear_strain"};
    if (scene.phases != PhaseModel::dry) choice.fields.push_back("pore_pressure");
    draw_pictures(options.directory, choice);
  }
  if (rank == 0)
    std::fprintf(stderr, "results are in %s: %srun.xdmf for ParaView\n", options.directory.c_str(),
                 arguments.no_pictures ? "" : "report.html to read, ");
  return 0;
}

}  // namespace

Action add_solve(CLI::App &app) {
  auto arguments = std::make_shared<SolveArguments>();
  CLI::App *command =
      app.add_subcommand("solve", "solve the quasi-static stages of a scene by finite elements; factor of safety");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command->add_option("-o,--output", arguments->directory, "folder of the results (default results/NAME)");
  command->add_option("--set", arguments->set, "override a key of the scene: key.path=value")->take_all();
  command->add_flag("--factor-of-safety", arguments->factor_of_safety,
                    "reduce strength after the stages until equilibrium is lost");
  command->add_flag("--no-pictures", arguments->no_pictures, "do not draw pictures at the end");
  return [arguments] { return solve(*arguments); };
}

}  // namespace talus
