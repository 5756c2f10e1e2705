#include <petscsys.h>

#include <filesystem>

#include "commands/commands.h"
#include "output/script.h"
#include "scene/reader.h"

namespace talus {

Action add_maps(CLI::App &app) {
  struct Arguments {
    std::string directory, spacing, limit, moved;
    bool ascii = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App *command = app.add_subcommand(
      "maps", "write maps of a run in 3D: thickness, speed and arrival time as GeoTIFF, the deposit as GeoPackage");
  command->add_option("DIR", arguments->directory, "folder of the results")->required();
  command
      ->add_option("--spacing", arguments->spacing,
                   "width of the cells [m]; by default that of the terrain file or, without terrain, twice the size of "
                   "the particles")
      ->check(above_zero);
  command
      ->add_option("--limit", arguments->limit,
                   "least thickness [m] of soil that counts for outline, arrival time and speed; by default half the "
                   "size of the particles")
      ->check(above_zero);
  command
      ->add_option("--moved", arguments->moved,
                   "displacement [m] beyond which soil counts as sliding; by default a tenth of the largest")
      ->check(above_zero);
  command->add_flag("--ascii", arguments->ascii, "write the grids as ESRI ASCII too");
  return [arguments] {
    if (!std::filesystem::is_regular_file(std::filesystem::path(arguments->directory) / "run.h5"))
      throw SceneError(arguments->directory + " contains no results of a run: there is no run.h5");
    int rank;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    if (rank) return 0;
    std::vector<std::string> options{arguments->directory};
    if (!arguments->spacing.empty()) options.insert(options.end(), {"--spacing", arguments->spacing});
    if (!arguments->limit.empty()) options.insert(options.end(), {"--limit", arguments->limit});
    if (!arguments->moved.empty()) options.insert(options.end(), {"--moved", arguments->moved});
    if (arguments->ascii) options.push_back("--ascii");
    return run_script("talus_maps.py", options);
  };
}

}  // namespace talus
