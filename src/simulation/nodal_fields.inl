// Fields at the nodes for host programs.
#include "simulation/simulation_impl.h"

namespace talus {

template <int dim>
std::vector<Vec<dim>> Simulation<dim>::nodal_displacement() {
  // up to the last remap the mean of the particles around a node, weighted as their velocity is; since then the node's
  // own way
  std::vector<Vec<dim>> u(mesh_.node_count(), Vec<dim>{});
  for (const auto &body : bodies_) {
    const ParticleArrays<dim> &p = body->particles();
    for (int i = 0; i < p.count; ++i) {
      const Cell<dim> &cell = mesh_.cells[p.cell[i]];
      const auto n = barycentric(cell, p.position[i]);
      for (int k = 0; k <= dim; ++k)
        for (int d = 0; d < dim; ++d) u[cell.node[k]][d] += n[k] * p.mass[i] * (p.position[i][d] - p.reference[i][d]);
    }
  }
  require(mesh_.halo.sum(u.empty() ? nullptr : u[0].data(), dim));
  const FilledGrid<dim> &grid = motion_->grid();
  for (int i = 0; i < grid.node_count(); ++i)
    for (int d = 0; d < dim; ++d) {
      double &value = u[grid.mesh_node[i]][d];
      value = value / grid.mass[i] + grid.position[i][d] - mesh_.position[grid.mesh_node[i]][d];
    }
  return u;
}

template <int dim>
void Simulation<dim>::nodal_field(const std::string &name, const std::function<void(PetscInt, const double *)> &put) {
  const bool displacement = name == "displacement";
  if (!displacement && name != "velocity")
    throw std::invalid_argument("no nodal field " + name + "; there are velocity and displacement");
  require(motion_->begin(time_));
  std::vector<Vec<dim>> u;
  if (displacement) u = nodal_displacement();
  const FilledGrid<dim> &grid = motion_->grid();
  for (int i = 0; i < grid.node_count(); ++i)
    put(mesh_.plex_vertex[grid.mesh_node[i]],
        displacement ? u[grid.mesh_node[i]].data() : motion_->velocity() + i * dim);
}

}  // namespace talus
