#include "simulation.h"

#include <filesystem>

#include "mesh_source.h"
#include "simulation_impl.h"

namespace talus {

volatile int interrupted = 0;

std::vector<double> HistoryTable::column(const std::string &name) const {
  for (size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) {
      std::vector<double> values;
      for (const auto &row : rows) values.push_back(row[k]);
      return values;
    }
  throw std::out_of_range("no column " + name + " in the history");
}

template <int dim>
std::unique_ptr<AnySimulation> make(MPI_Comm comm, Scene &scene, const RunOptions &options, const std::string &mesh) {
  switch (scene.phases) {
    case PhaseModel::dry: return std::make_unique<Simulation<dim, Dry>>(comm, scene, options, mesh);
    case PhaseModel::drained: return std::make_unique<Simulation<dim, Drained>>(comm, scene, options, mesh);
  }
  throw std::logic_error("phase model without a kernel");
}

std::unique_ptr<AnySimulation> make_simulation(MPI_Comm comm, Scene &scene, const RunOptions &options) {
  std::string mesh;
  if (!options.plex) {
    std::string directory = options.directory;
    if (directory.empty()) directory = (std::filesystem::temp_directory_path() / ("talus-" + std::to_string(std::hash<std::string>()(scene.source)))).string();
    mesh = mesh_file(comm, scene, directory);
  }
  return scene.dimension == 2 ? make<2>(comm, scene, options, mesh) : make<3>(comm, scene, options, mesh);
}

}  // namespace talus
