#pragma once
/// Patches of cells that share one volumetric strain (F-bar): greedy, compact, never across a change of material.
#include <array>
#include <vector>

namespace talus {

/// Cuts a mesh of simplices into patches of `size` cells. Grows each patch from the free cell with the fewest free
/// neighbours, always by the neighbour that adds the fewest new faces and nodes and leaves no lonely cell behind; then
/// patches of fewer than `smallest` cells (0: than half the size) join their smallest neighbour. A patch never holds
/// cells of two `kind`s. `neighbour[c][k]` is the cell across the face opposite to `node[c][k]`, or negative. Returns
/// the patch of each cell, numbered from 0 by first appearance. The result depends on the order of the cells only.
/// Source: docs/theory, section on locking; sizes 2 (triangles), 8 (tetrahedra), 4 (a slice one element thick).
template <int dim>
std::vector<int> make_patches(const std::vector<std::array<int, dim + 1>> &node,
                              const std::vector<std::array<int, dim + 1>> &neighbour, const std::vector<int> &kind,
                              int size, int smallest = 0);

}  // namespace talus
