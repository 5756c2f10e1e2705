#pragma once
/// Which rank gets which patch.
#include <vector>

#include "base/vec.h"

namespace talus {

/// A plane x, y or z = `place`: patches whose centre is below it go to the lower ranks. Centres on the plane are told
/// apart by the numbers of their patches, so that those below `patch` are lower too.
struct Cut {
  double place = 0;
  long long axis = 0, patch = 0;
};
/// A partition: halves the ranks again and again, each time with one cut, the lower half's further cuts first. One cut
/// fewer than ranks.
using Cuts = std::vector<Cut>;

/// Cuts with nearly equal sums of `weight` on all ranks, each along the axis that cuts the fewest faces between
/// patches. `centre` is a patch's place, `touching` the patches it shares faces with. A graph partitioner (Scotch) cuts
/// a little less, but its answer differs from call to call, and a run could not be repeated to the bit; cuts are also a
/// partition that a checkpoint can hold.
template <int dim>
Cuts find_cuts(const std::vector<Vec<dim>> &centre, const std::vector<double> &weight,
               const std::vector<std::vector<int>> &touching, int ranks);

/// Ranks of patches.
template <int dim>
std::vector<int> ranks_by_cuts(const std::vector<Vec<dim>> &centre, const Cuts &cuts);

}  // namespace talus
