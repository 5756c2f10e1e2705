#pragma once
/// Tractions on faces that move, docs/theory (6.4), (6.5): pieces of a loaded face travel with the particles behind it,
/// from cell to cell and from rank to rank.
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "particles/body.h"
#include "physics/boundary/boundary.h"
#include "transfer/filled_grid.h"

namespace talus {

template <int dim>
class SurfaceLoads {
 public:
  /// A face that `load` acts on: its facets that have soil behind them at the start.
  void add_face(int source, const Boundary &load, std::vector<Facet<dim>> facets) {
    faces_.push_back({source, load.follows, load.on_soil<dim>().load, std::move(facets)});
  }
  int face_count() const { return static_cast<int>(faces_.size()); }

  /// Finds the share of each facet that the soil on one side carries: all, or half where soil is on both sides.
  /// `filled` [local cells]. Collective.
  void share(const BackgroundMesh<dim> &mesh, const std::vector<char> &filled);
  /// First source whose load is normal to its face and has `soil` [local cells] on both sides of all of it, so that it
  /// cancels; -1: none. Collective.
  int find_cancelled(const BackgroundMesh<dim> &mesh, const std::vector<char> &soil) const;
  /// Gives the pieces in the cells of a freshly seeded body to the nearest of its particles.
  void seed(Body<dim> &body, const BackgroundMesh<dim> &mesh) const;
  /// First source without any soil behind its face, -1: none. Collective.
  int find_idle(MPI_Comm comm, const std::vector<std::unique_ptr<Body<dim>>> &bodies) const;

  /// Finds the pieces of this rank in the filled grid.
  void begin(const std::vector<std::unique_ptr<Body<dim>>> &bodies, const FilledGrid<dim> &grid);
  /// Adds the loads to nodal forces of this rank; `position` of the nodes, accepted or on trial.
  void add(double t, const FilledGrid<dim> &grid, const Vec<dim> *position, Vec<dim> *force);
  /// Adds the work of the loads last added in a step with nodal displacements `u`, by source [J].
  void add_work(const Vec<dim> *u, std::vector<double> &work) const;
  /// Moves and turns the pieces with the soil at the end of a Lagrangian part, before the particles move: with the mean
  /// deformation of the cells around them, weighted by the integration volumes `weight` [cell]. Cells that are filled
  /// in part rotate at random, and a face whose pieces rotate loses load. Collective.
  PetscErrorCode end(FilledGrid<dim> &grid, const std::vector<double> &weight);
  /// Mean displacement of each face since the undeformed state [m], weighted by undeformed area, into `mean[source]`.
  /// Collective.
  PetscErrorCode mean_displacements(const FilledGrid<dim> &grid, std::vector<Vec<dim>> &mean) const;

 private:
  struct Face {
    int source;
    bool follows;  ///< the load is one on the face as it is now
    std::function<Vec<dim>(const Vec<dim> &normal, const Vec<dim> &x, double t)> load;  ///< [Pa]
    std::vector<Facet<dim>> facets;
    std::vector<double> share{};
  };
  struct Active {
    SurfacePiece<dim> *piece;
    int face, mesh_cell;
    std::array<int, dim + 1> node;           // compact
    std::array<double, dim + 1> coordinate;  // barycentric, beyond the cell where the face is
    Vec<dim> force;                          // last added [N]
  };

  std::vector<Face> faces_;
  std::vector<Active> active_;
  std::vector<double> nodal_;  ///< sums over the cells of a node: w F, w
};

}  // namespace talus
