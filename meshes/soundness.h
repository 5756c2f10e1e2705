#pragma once
/// Faults of a mesh that no single cell shows: parts that overlap, seams whose nodes were not merged, parts without
/// neighbours, slivers and tiny edges.
#include <string>
#include <utility>
#include <vector>

#include "meshes/cell_tree.h"

namespace talus {

/// Two cells that lie in one place without being neighbours, by more than a thousandth of their edges; {-1, -1} if
/// there are none. Only cells with a free side are compared with others: where a mesh overlaps itself, one of the cells
/// has one. `tree` is that of the cells. Serial.
template <int dim>
std::pair<int, int> overlapping_cells(const Simplices<dim> &cells, const CellTree<dim> &tree);

/// Sentences about what may be meant but rarely is, each with its place, the worst first. Serial; for a whole mesh.
template <int dim>
std::vector<std::string> mesh_remarks(const Simplices<dim> &cells, const CellTree<dim> &tree, const Regions &regions);

}  // namespace talus
