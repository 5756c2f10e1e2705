#pragma once
/// Which rank gets which patch.
#include <cmath>
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

/// A cell with soil, for a partition.
template <int dim>
struct FilledCell {
  long long number = 0;  ///< its global one
  double weight = 0;
  Vec<dim> way{};  ///< of its soil in a step [m]
};

/// What there is to share.
template <int dim>
struct PatchLoad {
  std::vector<double> weight;  ///< of patches
  std::vector<Vec<dim>> way;   ///< of the weight of a patch in a step [m]; empty where nothing moves
  double partition_cost = 0;   ///< of a new partition, in the unit of weight
};

/// What a partition promises.
struct PartitionForecast {
  double imbalance = 1;  ///< weight of the rank that has most, over the mean
  double crossing = 0;   ///< weight that crosses a cut in a step, of the cut with most
};

/// Cuts with nearly equal sums of weight on all ranks, each along the axis that costs least in a step: for the faces
/// between patches with weight that are cut, and for the weight that crosses the cut. `centre` is a patch's place,
/// `touching` the patches it shares faces with. A graph partitioner (Scotch) cuts a little less, but its answer differs
/// from call to call, and a run could not be repeated to the bit; cuts are also a partition that a checkpoint can hold.
template <int dim>
Cuts find_cuts(const std::vector<Vec<dim>> &centre, const PatchLoad<dim> &load,
               const std::vector<std::vector<int>> &touching, int ranks, PartitionForecast *forecast);

/// What the loss by soil that crosses a cut and the partitions that mend it cost in each step. If weight s crosses in
/// each step, n steps lose s n^2 / 2, and a new partition, which costs C, is due when they have lost as much: both
/// together cost sqrt(2 C s).
inline double cost_of_crossing(double crossing, double partition_cost) {
  return std::sqrt(2 * partition_cost * crossing);
}

/// Ranks of patches.
template <int dim>
std::vector<int> ranks_by_cuts(const std::vector<Vec<dim>> &centre, const Cuts &cuts);

}  // namespace talus
