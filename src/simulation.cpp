#include "simulation.h"

#include <filesystem>

#include "mesh_source.h"
#include "simulation/simulation_impl.h"
#include "solvers/quasi_static/seeped_pressure.h"

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

std::unique_ptr<AnySimulation> make(MPI_Comm comm, Scene &scene, const RunOptions &options, const std::string &mesh) {
  if (scene.dimension == 2) return std::make_unique<Simulation<2>>(comm, scene, options, mesh);
  return std::make_unique<Simulation<3>>(comm, scene, options, mesh);
}

/// Boundaries of pore water in a drained scene belong to its seepage stages alone: the motion takes the pressure that
/// they find.
void set_seepage_apart(Scene &scene) {
  const auto seeps = [](const BoundarySource &b) {
    DeferredTable table = b.kind;
    const Boundary kind = read_boundary(table);
    return concerns_water(kind) && !concerns_gas(kind);
  };
  const auto water = std::stable_partition(scene.boundary.begin(), scene.boundary.end(),
                                           [&](const BoundarySource &b) { return !seeps(b); });
  scene.seepage_boundary.insert(scene.seepage_boundary.end(), water, scene.boundary.end());
  scene.boundary.erase(water, scene.boundary.end());
}

/// The pressure that a seepage stage left before a run was interrupted; a run that starts anew has none.
void recall_seepage(MPI_Comm comm, Scene &scene, const RunOptions &options) {
  scene.water.seeped = nullptr;
  const std::string file = seeped_file(options.directory);
  if (options.resume && std::filesystem::exists(file)) {
    const auto recall = [&](auto found) { scene.water.seeped = [found](const double *x) { return (*found)(x); }; };
    if (scene.dimension == 2)
      recall(std::make_shared<SeepedPressure<2>>(file));
    else
      recall(std::make_shared<SeepedPressure<3>>(file));
  }
  int rank;
  MPI_Comm_rank(comm, &rank);
  if (!options.resume && rank == 0) std::filesystem::remove(file);
}

}  // namespace

std::unique_ptr<AnySimulation> make_simulation(MPI_Comm comm, Scene &scene, const RunOptions &options) {
  if (scene.phases == PhaseModel::drained &&
      std::any_of(scene.stage.begin(), scene.stage.end(), [](const Stage &s) { return water_flows(s.kind); })) {
    set_seepage_apart(scene);
    if (!options.directory.empty()) recall_seepage(comm, scene, options);
  }
  if (options.plex) return make(comm, scene, options, "");
  const MeshFile mesh(comm, scene);
  return make(comm, scene, options, mesh.path());
}

}  // namespace talus
