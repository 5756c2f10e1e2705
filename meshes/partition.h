#pragma once
/// Which rank gets which patch.
#include <array>
#include <vector>

#include "base/vec.h"

namespace talus {

/// Ranks of patches with nearly equal sums of `weight`: halves the patches again and again at a plane x, y or z =
/// const, each time along the axis that cuts the fewest faces between patches. `centre` is a patch's place, `touching`
/// the patches it shares faces with. A graph partitioner (Scotch) cuts a little less, but its answer differs from call
/// to call, and a run could not be repeated to the bit.
template <int dim>
std::vector<int> partition(const std::vector<Vec<dim>> &centre, const std::vector<double> &weight,
                           const std::vector<std::vector<int>> &touching, int ranks);

}  // namespace talus
