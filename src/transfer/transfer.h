#pragma once
/// Particles to nodes and back, docs/theory section 4. Loops run over runs of particles of one cell: moments are accumulated in
/// registers, nodes are touched once per run.
#include <cmath>

#include "base/lanes.h"
#include "meshes/locate.h"
#include "particles/body.h"
#include "transfer/filled_grid.h"
#include "transfer/stress_points.h"

namespace talus {

/// Barycentric coordinates of a cell as an affine map of the position, four lanes wide.
template <int dim>
struct BarycentricMap {
  explicit BarycentricMap(const Cell<dim> &cell) : origin(cell.origin) {
    constant = Quad{1, 0, 0, 0};
    for (int d = 0; d < dim; ++d) {
      column[d] = Quad{};
      for (int k = 0; k < dim; ++k) {
        column[d][k + 1] = cell.gradient[k][d];
        column[d][0] -= cell.gradient[k][d];
      }
    }
  }
  Quad operator()(const Vec<dim> &x) const {
    Quad n = constant;
    for (int d = 0; d < dim; ++d) n += quad(x[d] - origin[d]) * column[d];
    return n;
  }
  Quad constant, column[dim];
  Vec<dim> origin;
};

/// Adds the particles of one body to the grid: mass matrices, momentum, volumes and, with averaged stress, the stress points.
/// `momentum` [compact nodes][dim] has room for every node of the local mesh.
template <int dim, bool averaged, bool apic>
void to_nodes(const Body<dim> &body, FilledGrid<dim> &grid, Vec<dim> *momentum, PointSet &points);

/// Nodal fields that particles read at a remap, four lanes wide, by compact node.
struct NodalUpdate {
  std::vector<Quad> velocity;      ///< a (v - v0) + (1 - a) v: what is added to a times the particle's own velocity
  std::vector<Quad> displacement;  ///< since the last remap
};

/// Gives the particles of one body what the nodes learned since the last remap. `flip` is the share a of their own velocity they
/// keep; `affine` [compact cells][dim * dim] the velocity gradients of APIC (else null). Particles whose cell changed are listed in `movers`.
template <int dim, bool averaged>
void to_particles(Body<dim> &body, const FilledGrid<dim> &grid, const NodalUpdate &nodes, double flip, const double *affine,
                  const PointSet &points, std::vector<int> &movers);

/// Walks the listed particles of a body to their new cells and sends those that leave the rank; collective. `lost` is the position of
/// a particle that left the mesh, if any did.
template <int dim>
PetscErrorCode relocate(Body<dim> &body, const BackgroundMesh<dim> &mesh, std::vector<int> &movers, bool *lost, Vec<dim> *where);

}  // namespace talus
