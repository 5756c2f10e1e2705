#pragma once
/// Elements of Gmsh's current model as corners.
#include <gmsh.h>

#include <array>
#include <vector>

#include "base/vec.h"

namespace talus {

/// Corners of the simplices of dimension `dim` on an entity; edges and triangles of a 3D mesh lose their z where `dim`
/// = 1, 2 and `space` = 2.
template <int dim, int space = dim>
std::vector<std::array<Vec<space>, dim + 1>> corners_of(int tag) {
  constexpr int type = dim == 1 ? 1 : dim == 2 ? 2 : 4;
  std::vector<std::size_t> nodes;
  std::vector<double> x, parametric;
  gmsh::model::mesh::getNodesByElementType(type, nodes, x, parametric, tag, false);
  std::vector<std::array<Vec<space>, dim + 1>> corners(nodes.size() / (dim + 1));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int d = 0; d < space; ++d) corners[i / (dim + 1)][i % (dim + 1)][d] = x[3 * i + d];
  return corners;
}

}  // namespace talus
