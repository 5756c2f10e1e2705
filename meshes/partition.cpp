#include "meshes/partition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace talus {
namespace {

// Of a face that two ranks share, in a step: from 0.07 ms for 2200 faces and 1e7 particles a second, docs/scaling.md.
// Between patches without soil faces cost nothing; there fewer are better all the same.
constexpr double face_cost = 0.3, empty_face_cost = 1e-6, least_filled_weight = 1;

template <int dim>
class Bisection {
 public:
  Bisection(const std::vector<Vec<dim>> &centre, const PatchLoad<dim> &load,
            const std::vector<std::vector<int>> &touching)
      : centre_(centre), load_(load), touching_(touching), side_(centre.size(), neither) {}

  /// Cuts some patches for `ranks` ranks.
  void divide(std::vector<int> patches, int ranks) {
    if (ranks == 1) return;
    const int lower_ranks = ranks / 2;
    const double share = static_cast<double>(lower_ranks) / ranks;
    std::size_t lower = 0;
    double least = std::numeric_limits<double>::infinity(), least_crossing = 0;
    Cut best;
    for (int axis = 0; axis < dim; ++axis) {
      auto sorted = patches;
      const std::size_t at = cut(sorted, axis, share);
      const double crossing = crossing_weight(sorted, at, axis);
      const double cost = cost_of_faces(sorted, at) + cost_of_crossing(crossing, load_.partition_cost);
      if (cost >= least) continue;
      least = cost, least_crossing = crossing, lower = at, best_ = sorted;
      best = {std::numeric_limits<double>::infinity(), axis, 0};
      if (at < sorted.size()) best.place = centre_[sorted[at]][axis], best.patch = sorted[at];
    }
    cuts.push_back(best), most_crossing = std::max(most_crossing, least_crossing);
    const std::vector<int> halves[2] = {{best_.begin(), best_.begin() + lower}, {best_.begin() + lower, best_.end()}};
    divide(halves[0], lower_ranks);
    divide(halves[1], ranks - lower_ranks);
  }

 private:
  static constexpr char neither = 0, below = 1, above = 2;
  const std::vector<Vec<dim>> &centre_;
  const PatchLoad<dim> &load_;
  const std::vector<std::vector<int>> &touching_;
  std::vector<char> side_;
  std::vector<int> best_;

 public:
  Cuts cuts;
  double most_crossing = 0;  // of the cuts

 private:
  /// Sorts patches along an axis; returns how many of them hold `share` of the weight.
  std::size_t cut(std::vector<int> &patches, int axis, double share) const {
    std::sort(patches.begin(), patches.end(), [&](int a, int b) {
      return centre_[a][axis] != centre_[b][axis] ? centre_[a][axis] < centre_[b][axis] : a < b;
    });
    double total = 0, sum = 0;
    for (int p : patches) total += load_.weight[p];
    std::size_t at = 0;
    while (at < patches.size() &&
           std::abs(sum + load_.weight[patches[at]] - share * total) <= std::abs(sum - share * total))
      sum += load_.weight[patches[at++]];
    return at;
  }

  double cost_of_faces(const std::vector<int> &patches, std::size_t lower) {
    for (std::size_t i = 0; i < patches.size(); ++i) side_[patches[i]] = i < lower ? below : above;
    double cost = 0;
    for (std::size_t i = 0; i < lower; ++i)
      for (const int other : touching_[patches[i]])
        if (side_[other] == above) {
          const double weight = std::min(load_.weight[patches[i]], load_.weight[other]);
          cost += weight < least_filled_weight ? empty_face_cost : face_cost;
        }
    for (int p : patches) side_[p] = neither;
    return cost;
  }

  /// Weight that crosses the cut in a step.
  double crossing_weight(const std::vector<int> &patches, std::size_t lower, int axis) const {
    constexpr double share_of_extent = 0.1;  // which the fastest goes, so that many patches can cross the cut
    if (load_.way.empty() || lower == patches.size()) return 0;
    double low = std::numeric_limits<double>::max(), high = -low, fastest = 0;
    for (const int p : patches) {
      if (load_.weight[p] < least_filled_weight) continue;
      low = std::min(low, centre_[p][axis]), high = std::max(high, centre_[p][axis]);
      fastest = std::max(fastest, std::abs(load_.way[p][axis]));
    }
    if (fastest == 0) return 0;
    const double steps = share_of_extent * (high - low) / fastest, place = centre_[patches[lower]][axis];
    double crossed = 0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const int p = patches[i];
      const bool is_lower = centre_[p][axis] + steps * load_.way[p][axis] < place;
      crossed += (i < lower) == is_lower ? 0 : i < lower ? load_.weight[p] : -load_.weight[p];
    }
    return steps > 0 ? std::abs(crossed) / steps : 0;
  }
};

}  // namespace

template <int dim>
Cuts find_cuts(const std::vector<Vec<dim>> &centre, const PatchLoad<dim> &load,
               const std::vector<std::vector<int>> &touching, int ranks, PartitionForecast *forecast) {
  Bisection<dim> bisection(centre, load, touching);
  std::vector<int> all(centre.size());
  std::iota(all.begin(), all.end(), 0);
  bisection.divide(all, ranks);
  const std::vector<int> rank = ranks_by_cuts<dim>(centre, bisection.cuts);
  std::vector<double> sum(ranks, 0);
  for (std::size_t p = 0; p < rank.size(); ++p) sum[rank[p]] += load.weight[p];
  const double mean = std::accumulate(sum.begin(), sum.end(), 0.) / ranks;
  *forecast = {mean > 0 ? *std::max_element(sum.begin(), sum.end()) / mean : 1, bisection.most_crossing};
  return bisection.cuts;
}

template <int dim>
std::vector<int> ranks_by_cuts(const std::vector<Vec<dim>> &centre, const Cuts &cuts) {
  std::vector<int> rank(centre.size(), 0);
  for (std::size_t p = 0; p < centre.size(); ++p) {
    int &first = rank[p];
    std::size_t cut = 0;  // of the ranks from `first` on
    for (int ranks = static_cast<int>(cuts.size()) + 1; ranks > 1;) {
      const Cut &here = cuts[cut];
      const int lower_ranks = ranks / 2;
      const double x = centre[p][here.axis];
      const bool below = x < here.place || (x == here.place && static_cast<long long>(p) < here.patch);
      cut += below ? 1 : lower_ranks;  // the cut here, and the others of the lower half
      first += below ? 0 : lower_ranks, ranks = below ? lower_ranks : ranks - lower_ranks;
    }
  }
  return rank;
}

template Cuts find_cuts<2>(const std::vector<Vec<2>> &, const PatchLoad<2> &, const std::vector<std::vector<int>> &,
                           int, PartitionForecast *);
template Cuts find_cuts<3>(const std::vector<Vec<3>> &, const PatchLoad<3> &, const std::vector<std::vector<int>> &,
                           int, PartitionForecast *);
template std::vector<int> ranks_by_cuts<2>(const std::vector<Vec<2>> &, const Cuts &);
template std::vector<int> ranks_by_cuts<3>(const std::vector<Vec<3>> &, const Cuts &);

}  // namespace talus
