#include <csignal>

#include "commands/commands.h"
#include "commands/foreign_code.h"
#include "commands/gallery.h"
#include "commands/slice.h"
#include "commands/starter.h"
#include "doubts/doubts.h"
#include "scene/reader.h"
#include "scene/scene.h"
#include "simulation.h"

namespace talus {
namespace {

struct RunArguments {
  std::string scene, directory;
  std::vector<std::string> set;
  bool slice = false, no_pictures = false, no_umat = false, resume = false, force = false;
};

void on_signal(int) {
  interrupted = 1;
  end_soon_without_starter();
}

int run(const RunArguments &arguments) {
  const std::string file = find_scene(arguments.scene);
  const std::vector<std::string> set = with_slice(arguments.slice, arguments.set);
  Scene scene = read_scene(file, set);
  if (arguments.no_umat) refuse_umat(scene);
  RunOptions options;
  options.directory = arguments.directory.empty() ? default_results(file, set) : arguments.directory;
  options.pictures = !arguments.no_pictures;
  options.resume = arguments.resume;
  options.replace = arguments.force;
  say_doubts(options, scene);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGUSR1, on_signal);  // mpirun hands it on, and does not kill ranks after it
  std::signal(SIGXFSZ, SIG_IGN);    // a limit on file sizes is an error of writing, not the end
  make_simulation(PETSC_COMM_WORLD, scene, options)->run();
  int rank;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0)
    std::fprintf(stderr, "results are in %s: %srun.xdmf for ParaView\n", options.directory.c_str(),
                 options.pictures ? "report.html to read, " : "");
  return 0;
}

}  // namespace

Action add_run(CLI::App &app) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App *command = app.add_subcommand("run", "run a scene and draw its pictures");
  command->add_option("SCENE", arguments->scene, "scene file (.toml) or the name of a gallery scene")->required();
  command->add_option("-o,--output", arguments->directory,
                      "folder of the results (default results/NAME, with what --set changes)");
  command->add_option("--set", arguments->set, "override a key of the scene: key.path=value")->take_all();
  command->add_flag("--slice", arguments->slice, slice_meaning);
  command->add_flag("--no-umat", arguments->no_umat, "refuse laws that load a library: for scenes of strangers");
  CLI::Option *resume =
      command->add_flag("--resume", arguments->resume,
                        "continue the run in that folder from its last checkpoint, on any number of ranks");
  command->add_flag("--force", arguments->force, "replace the results of another run in that folder")->excludes(resume);
  command->add_flag("--no-pictures", arguments->no_pictures, "do not draw pictures at the end");
  return [arguments] { return run(*arguments); };
}

}  // namespace talus
