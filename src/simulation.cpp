#include "simulation.h"

#include "mesh_source.h"
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

template <int dim>
std::unique_ptr<AnySimulation> make_in(MPI_Comm comm, Scene &scene, const RunOptions &options, const std::string &mesh) {
  switch (scene.phases) {
    case PhaseModel::dry: return std::make_unique<Simulation<dim, Dry>>(comm, scene, options, mesh);
    case PhaseModel::drained: return std::make_unique<Simulation<dim, Drained>>(comm, scene, options, mesh);
    case PhaseModel::saturated: return std::make_unique<Simulation<dim, Saturated>>(comm, scene, options, mesh);
    case PhaseModel::unsaturated: return std::make_unique<Simulation<dim, Unsaturated>>(comm, scene, options, mesh);
    case PhaseModel::three_phase: return std::make_unique<Simulation<dim, ThreePhase>>(comm, scene, options, mesh);
  }
  throw std::logic_error("phase model without a kernel");
}

std::unique_ptr<AnySimulation> make(MPI_Comm comm, Scene &scene, const RunOptions &options, const std::string &mesh) {
  return scene.dimension == 2 ? make_in<2>(comm, scene, options, mesh) : make_in<3>(comm, scene, options, mesh);
}

}  // namespace

std::unique_ptr<AnySimulation> make_simulation(MPI_Comm comm, Scene &scene, const RunOptions &options) {
  if (options.plex) return make(comm, scene, options, "");
  const MeshFile mesh(comm, scene);
  return make(comm, scene, options, mesh.path());
}

}  // namespace talus
