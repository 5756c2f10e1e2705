#pragma once
/// How close the soil lies to its bases, for `history.csv`.
#include <vector>

namespace talus {

template <int dim>
class World;

/// Height of the lowest particle over each facet of a base, in the cell beside it, as the mean over the area of the
/// facets that have soil in this cell; per boundary, 0 where it is no base or no soil is near [m]. Particles count
/// where they were at the last remap, in the mesh as it was then. Collective.
template <int dim>
std::vector<double> base_clearances(const World<dim> &world);

}  // namespace talus
