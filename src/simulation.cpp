#include "simulation.h"

#include <optional>

#include "mesh_source.h"
#include "scene/scene.h"
#include "simulation/simulation_impl.h"

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

namespace {

std::unique_ptr<AnySimulation> make(MPI_Comm comm, const Scene &scene, const RunOptions &options,
                                    const std::string &mesh) {
  if (scene.dimension == 2) return std::make_unique<Simulation<2>>(comm, scene, options, mesh);
  return std::make_unique<Simulation<3>>(comm, scene, options, mesh);
}

}  // namespace

std::unique_ptr<AnySimulation> make_simulation(MPI_Comm comm, const Scene &scene, const RunOptions &options) {
  RunOptions with = options;
  std::optional<MeshFile> mesh;
  if (!options.plex) with.mesh = mesh.emplace(comm, scene).made(), with.mesh.corner = mesh->origin();
  for (const std::string &remark : read_grids(comm, scene, with.mesh.corner, with.mesh.origin))
    with.mesh.remarks.push_back(remark);
  return make(comm, scene, with, mesh ? mesh->path() : "");
}

}  // namespace talus
