#pragma once
/// Plastic strain averaged over a length, so that a band in which soil softens has a width that is not the cell's. The
/// average a of the plastic strain k of one body solves a - l^2 div grad a = k without flux through its surface
/// (Peerlings et al. 1996, Int. J. Numer. Methods Eng. 39; for plasticity Engelen et al. 2003, Int. J. Plast. 19),
/// docs/theory (2.11): across a band it weighs by exp(-|x| / l) / (2 l). Solved on the nodes, so that only sums over
/// shared nodes cross from rank to rank; nothing is allocated in a step.
#include <vector>

#include "base/archive.h"
#include "meshes/background_mesh.h"
#include "transfer/filled_grid.h"
#include "transfer/stress_points.h"

namespace talus {

template <int dim>
class NonlocalStrain {
 public:
  /// `length` is l [m], `field` the place of the plastic strain among the `history_count` numbers of a point.
  /// Collective.
  NonlocalStrain(const BackgroundMesh<dim> &mesh, double length, int field, int history_count);

  /// At a remap: takes volumes and shapes of the cells, and solves to 1e-8. Collective.
  PetscErrorCode begin(FilledGrid<dim> &grid, const PointSet &points);
  /// After an accepted step: what is left of the error, and of the step's change, is halved at least. Collective.
  PetscErrorCode update(FilledGrid<dim> &grid, const PointSet &points);

  /// The average at the points less their own plastic strain, as the next step takes it.
  const double *excess() const { return excess_.data(); }
  int field() const { return field_; }
  /// Writes what the next step depends on, or reads it.
  void serialize(Archive &archive, const FilledGrid<dim> &grid, const typename FilledGrid<dim>::Rows &rows,
                 const Archive::Rows &points);
  /// What the law takes for the width of a band: 2 l in every cell [m].
  const double *size() const { return size_.data(); }

 private:
  /// l^2 V grad N_a . grad N_b of two vertices: 01, 02, (03,) 12, (13, 23) [m3]. Rows of the matrix add up to the mass:
  /// the diagonal needs no place.
  using Couplings = std::array<double, dim *(dim + 1) / 2>;
  /// A cell that holds soil of this body, at the remap.
  struct Part {
    int cell;
    std::array<int, dim + 1> node;
    double volume;  ///< of this body [m3]
    Couplings coupling;
  };

  void find_parts(const FilledGrid<dim> &grid, const PointSet &points);
  PetscErrorCode load(FilledGrid<dim> &grid, const PointSet &points);
  PetscErrorCode apply(FilledGrid<dim> &grid, const double *x, double *y);
  PetscErrorCode iterate(FilledGrid<dim> &grid, int iterations);
  void spread(const FilledGrid<dim> &grid, const PointSet &points);
  int iterations_to(double factor) const;

  double area_;  ///< l^2 [m2]
  int field_, history_count_;
  double least_ = 1, largest_ = 1;  ///< bounds of the eigenvalues of the scaled matrix
  std::vector<double> size_;        ///< [cells]
  std::vector<Part> part_;          ///< of which the first `parts_` count
  int parts_ = 0;
  std::vector<std::array<double, 2>> cell_;  ///< [cells] volume, and its product with the strain: room
  std::vector<std::array<double, 2>> sums_;  ///< [nodes] volume and diagonal: room for sums over ranks
  std::vector<double> mass_, over_diagonal_, load_, average_, residual_, direction_, product_;  ///< [nodes]
  std::vector<double> excess_;                                                                  ///< [points]
};

}  // namespace talus
