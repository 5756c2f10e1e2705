#include <petscsys.h>

#include <iostream>

#include "commands/commands.h"
#include "commands/study_file.h"
#include "physics/laws/element_test.h"
#include "scene/materials.h"
#include "simulation/scene_keys.h"

namespace talus {

Action add_describe(CLI::App &app) {
  auto key = std::make_shared<std::string>();
  CLI::App *command = app.add_subcommand("describe", "describe every key of a scene: meaning, unit, default, range");
  command->add_option("KEY", *key, "a key, a table or a kind, such as body.density, stage or mohr_coulomb");
  return [key] {
    Describer describer = scene_keys();
    describer.add({"File of `talus soil`", "", "A material and its tests.", "", {}}, SoilFile{});
    describer.add({"File of `talus study`", "", "A scene, the keys that vary, and what counts as failure.", "", {}},
                  StudyFile{});
    describe_one_of<Variation>(describer, "variable.NAME", "kind");
    describe_materials(describer);
    int rank;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    std::ostringstream nowhere;
    describer.print(rank == 0 ? std::cout : static_cast<std::ostream &>(nowhere), *key);
    return 0;
  };
}

}  // namespace talus
