#pragma once
/// By which named faces of the mesh particles left it.
#include <vector>

#include "simulation/world.h"

namespace talus {

/// Of each particle in `world.escaped.of_this_rank()` the group of faces by which it left, as a number among
/// `world.mesh.group_names()`; -1: faces that no group names. The same on any number of ranks. Collective.
template <int dim>
std::vector<int> ways_out(const World<dim> &world);

}  // namespace talus
