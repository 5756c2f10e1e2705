#pragma once
/// What a remap carries from one Lagrangian part to the next, docs/theory section 4.8: what particles read of the nodes
/// where the old one ends, and the grid into which they are gathered for the new one.
#include <memory>
#include <vector>

#include "physics/soil_motion/nodal_velocities.h"
#include "transfer/transfer.h"

namespace talus {

/// Stress points of all bodies, with room in every cell of the mesh.
template <int dim>
std::vector<PointSet> make_points(const std::vector<std::unique_ptr<Body<dim>>> &bodies, int cells, bool averaged);

template <int dim, int fluids>
struct Remap {
  Remap(const BackgroundMesh<dim> &mesh, const std::vector<std::unique_ptr<Body<dim>>> &bodies, bool averaged)
      : grid(mesh), points(make_points<dim>(bodies, mesh.cell_count(), averaged)) {
    const int nodes = mesh.node_count(), cells = mesh.cell_count();
    make_room(nodal.velocity, nodes), make_room(nodal.displacement, nodes);
    for (int a = 0; a < fluids; ++a) make_room(nodal.fluid[a], nodes);
    make_room(momentum, nodes);
    size_t most = 0;
    for (const auto &body : bodies) most = std::max<size_t>(most, body->history_count());
    if (averaged && !bodies.empty()) make_room(change, static_cast<size_t>(cells) * (1 + fluids + most));
  }

  // where a part ends
  NodalUpdate nodal;           ///< what particles read of the nodes
  double own_share = 0;        ///< of their velocity, that particles keep, theory (4.11)
  std::vector<double> change;  ///< Lagrangian::change

  // where the next one begins
  FilledGrid<dim> grid;            ///< in which particles that stay in their cells are gathered already ...
  std::vector<PointSet> points;    ///< ... with their stress points
  std::vector<Vec<dim>> momentum;  ///< of the solid on this rank, [node], summed while particles are gathered [kg m/s]
  /// The particles of each body that are not in the grid yet; null: none of them is.
  const std::vector<std::vector<int>> *missing = nullptr;
  const std::vector<int> *missing_of(size_t body) const { return missing ? &(*missing)[body] : nullptr; }

  /// Takes the velocities and displacements of the nodes at the end t of a part.
  void read_nodes(double t, const FilledGrid<dim> &old, const NodalVelocities<dim, fluids + 1> &velocities) {
    own_share = velocities.own_share_at(t);
    const std::vector<Vec<dim>> &place = old.mesh().position;
    for (int i = 0; i < old.node_count(); ++i) {
      const Vec<dim> &v = velocities.now[i], &v0 = velocities.start[i], &x = old.position[i],
                     &X = place[old.mesh_node[i]];
      for (int d = 0; d < dim; ++d) {
        nodal.velocity[i][d] = v[d] - own_share * v0[d];
        nodal.displacement[i][d] = x[d] - X[d];
      }
    }
  }
  /// The part that ends, for the particles of a body.
  Lagrangian<dim> end_of(const FilledGrid<dim> &old, const PointSet &of_body, const Pores<dim> &pores) {
    return {.grid = old, .nodes = nodal, .flip = own_share, .points = of_body, .pores = pores, .change = change.data()};
  }
};

}  // namespace talus
