#pragma once
/// Particles to nodes and back, docs/theory section 4. Loops run over runs of particles of one cell: moments are
/// accumulated in registers, nodes are touched once per run.
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
  explicit BarycentricMap(const Cell<dim> &cell) : origin(load<dim>(cell.origin.data())) {
    constant = Quad{1, 0, 0, 0};
    for (int d = 0; d < dim; ++d) {
      column[d] = Quad{};
      for (int k = 0; k < dim; ++k) {
        column[d][k + 1] = cell.gradient[k][d];
        column[d][0] -= cell.gradient[k][d];
      }
    }
  }
  Quad operator()(Quad x) const {
    Quad n = constant;
    x -= origin;
    for (int d = 0; d < dim; ++d) n += quad(x[d]) * column[d];
    return n;
  }
  Quad origin, constant, column[dim];
};

/// Pores of one body in the sweeps between particles and nodes, docs/theory/pores.md section 4: arrays of PoreFluid.
/// They are neither read nor written where no fluid moves.
template <int dim>
struct Pores {
  double *grains = nullptr;  ///< [points] volume of the grains, with averaged stress [m3]
  double *mass[2]{};         ///< [points] of liquid and gas [kg]
  std::array<Quad, dim> *
      impulse[2]{};  ///< [compact cells][component][vertex] sum of m_s N v_a over particles, of liquid and gas [kg m/s]
  double over_density = 0;  ///< 1 / density of the grains [m3/kg]
};

/// Adds the particles of one body to the grid: mass matrices, momentum, volumes, the `fluids` in its pores and the
/// stress points; those listed in `only`, or all. `momentum` [compact nodes][dim] has room for
/// every node of the local mesh.
template <int dim, bool averaged, int fluids>
void to_nodes(const Body<dim> &body, FilledGrid<dim> &grid, Vec<dim> *momentum, PointSet &points,
              const Pores<dim> &pores, const std::vector<int> *only);

/// Nodal fields from which particles are updated at a remap, four lanes wide, by compact node.
struct NodalUpdate {
  std::vector<Quad> velocity;      ///< v - a v0, to which a times the particle's velocity is added, docs/theory (4.11)
  std::vector<Quad> displacement;  ///< since the last remap
  std::vector<Quad> fluid[2];      ///< as `velocity`, of liquid and gas
};

/// End of a Lagrangian part: the fields from which particles are updated.
template <int dim>
struct Lagrangian {
  const FilledGrid<dim> &grid;
  const NodalUpdate &nodes;
  double flip;  ///< the share a of their own velocity that particles keep
  const PointSet &points;
  const Pores<dim> &pores;
  double *change;  ///< [points][1 + fluids + history] scratch: changes of the points that particles take over
};

/// Brings the particles of one body to the end of a Lagrangian part. Particles outside their cell are listed in
/// `movers`.
template <int dim, bool averaged, int fluids>
void to_particles(Body<dim> &body, const Lagrangian<dim> &from, std::vector<int> &movers);

/// The same, and adds those that stay in their cell to the next grid in one sweep; the movers are still to be added.
/// With averaged stress a particle that stays keeps its stress and its fluids in the stress point only.
template <int dim, bool averaged, int fluids>
void to_next_nodes(Body<dim> &body, const Lagrangian<dim> &from, FilledGrid<dim> &grid, Vec<dim> *momentum,
                   PointSet &points, const Pores<dim> &pores, std::vector<int> &movers);

/// A particle that left the mesh by a face of a cell. It lies at this face, and has no cell any more.
struct LeftMesh {
  int particle, cell, face;
};

/// Walks the listed particles of a body to their new cells and sends those that leave the rank; collective. Afterwards
/// `movers` lists the walkers that are on this rank and have a cell, and `outside` those that left the mesh, both
/// ascending.
template <int dim>
PetscErrorCode relocate(Body<dim> &body, const BackgroundMesh<dim> &mesh, std::vector<int> &movers,
                        std::vector<LeftMesh> &outside);

}  // namespace talus
