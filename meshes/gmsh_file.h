#pragma once
/// Reader of Gmsh files, format 2.2 or 4.1, text or binary.
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace talus {

/// A mesh of simplices as a Gmsh file describes it; nodes, cells and facets in the order of the file. Nodes of no cell
/// are left out, and so are the nodes on the edges of elements of higher order.
struct GmshMesh {
  int dimension = 0;
  std::vector<double> position;                                   ///< of nodes, `dimension` numbers each [m]
  std::vector<int> cells;                                         ///< `dimension` + 1 nodes each
  std::vector<int> facets;                                        ///< `dimension` nodes each
  std::vector<long long> facet_number;                            ///< of the element in the file
  std::vector<std::pair<std::string, std::vector<int>>> regions;  ///< named groups: their cells
  std::vector<std::pair<std::string, std::vector<int>>> groups;   ///< named groups: their facets
  std::string remark;                                             ///< a sentence about cells of higher order, or empty
};

/// Reads a mesh of dimension 2 or 3. Serial. Throws std::invalid_argument with the file, the place in it, the fault and
/// what to do: damaged files, elements that name absent nodes, cells that are no simplices, cells of higher order with
/// curved edges, a 2D mesh that is not plane, groups without names or with names that DMPlex needs.
GmshMesh read_gmsh(const std::string &file, int dimension);

}  // namespace talus
