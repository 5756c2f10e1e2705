#pragma once
/// What Talus asks of a DMPlex of simplices: its cells as plain arrays, its named groups, making one of a
/// Gmsh file, distribution.
#include <petscdmplex.h>
#include <petscsf.h>

#include <array>
#include <string>
#include <vector>

#include "base/owned.h"
#include "base/vec.h"

namespace talus {

using StarForest = Owned<PetscSF, PetscSFDestroy>;

/// Local cells in the plex's own order. Cells, nodes and neighbours are numbered from 0 (plex point minus `first_cell`,
/// `first_vertex`). Cells are positively oriented.
template <int dim>
struct Simplices {
  PetscInt first_cell = 0, first_vertex = 0;
  std::vector<Vec<dim>> position;                    ///< of nodes [m]
  std::vector<std::array<int, dim + 1>> node;        ///< of cells
  std::vector<std::array<int, dim + 1>> neighbour;   ///< across the face opposite to node k, or -1
  std::vector<std::array<PetscInt, dim + 1>> facet;  ///< plex point of that face
  int crowded = -1;                                  ///< a cell with a face that more than two cells share, or -1

  std::array<Vec<dim>, dim + 1> corners(int cell) const {
    std::array<Vec<dim>, dim + 1> x;
    for (int k = 0; k <= dim; ++k) x[k] = position[node[cell][k]];
    return x;
  }
};
template <int dim>
PetscErrorCode read_simplices(DM plex, Simplices<dim> &simplices);

/// Which regions hold a cell: `names[combination[cell]]`, sorted. Local.
struct Regions {
  std::vector<int> combination;
  std::vector<std::vector<std::string>> names;
};
PetscErrorCode read_regions(DM plex, Regions &regions);

/// Names of labels with points at a height (0: cells, 1: facets), the same on all ranks, sorted; DMPlex's own labels
/// are left out. Collective.
PetscErrorCode names_at_height(DM plex, int height, std::vector<std::string> &names);
/// Local points of a label at a height, ascending; none when there is no such label.
PetscErrorCode points_at_height(DM plex, const std::string &label, int height, std::vector<PetscInt> &points);
bool is_reserved_label(const std::string &name);

/// A mesh with a label for each named group of cells and facets; all of it is on rank 0, where `mesh` is filled in. The
/// complaint, on rank 0, is about a facet that no cell has; empty without one. Collective.
struct GmshMesh;
PetscErrorCode make_plex(MPI_Comm comm, int dimension, const GmshMesh &mesh, DM *plex, std::string &complaint);

/// Sends each cell of rank 0 to `rank_of_cell`. `migration` leads from points there to local points. On one rank
/// nothing moves: `distributed` and `migration` stay null.
PetscErrorCode distribute(DM plex, const std::vector<int> &rank_of_cell, DM *distributed, PetscSF *migration);

}  // namespace talus
