#pragma once
/// Cells as plain arrays, their neighbours, and the named groups of cells and facets. No PETSc.
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace talus {

struct GmshMesh;  // meshes/gmsh_file.h

/// Cells, nodes and neighbours are numbered from 0. Cells are positively oriented.
template <int dim>
struct Simplices {
  std::vector<Vec<dim>> position;                   ///< of nodes [m]
  std::vector<std::array<int, dim + 1>> node;       ///< of cells
  std::vector<std::array<int, dim + 1>> neighbour;  ///< across the face opposite to node k, or -1
  int crowded = -1;                                 ///< a cell with a face that more than two cells share, or -1

  std::array<Vec<dim>, dim + 1> corners(int cell) const {
    std::array<Vec<dim>, dim + 1> x;
    for (int k = 0; k <= dim; ++k) x[k] = position[node[cell][k]];
    return x;
  }
};

/// Which regions hold a cell: `names[combination[cell]]`, sorted.
struct Regions {
  std::vector<int> combination;
  std::vector<std::vector<std::string>> names;
};
/// `cells_of` lists the cells of each region, in any order; a name may stand there more than once.
Regions combine(int cell_count, std::vector<std::pair<std::string, std::vector<int>>> cells_of);

/// A side of a cell, by the vertex opposite to it.
struct Side {
  int cell, face;
  bool operator<(const Side &other) const { return cell != other.cell ? cell < other.cell : face < other.face; }
  bool operator==(const Side &other) const { return cell == other.cell && face == other.face; }
};
/// The sides of cells that this rank shares with another one, in an order that both ranks agree on.
struct Seam {
  int rank;
  std::vector<Side> sides;
};

/// Named groups of facets, sorted by name, each with the sides of all cells that have one of its facets, ascending.
using Groups = std::vector<std::pair<std::string, std::vector<Side>>>;

/// The mesh of a file. A complaint is about a facet that no cell has; empty without one.
template <int dim>
void read_mesh(const GmshMesh &source, Simplices<dim> &cells, Groups &groups, std::string &complaint);

/// Mean length of the edges at each node [m]. An edge counts once.
template <int dim>
std::vector<double> mean_edges(const Simplices<dim> &cells, const GmshMesh &source);

}  // namespace talus
