#include "meshes/partition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace talus {
namespace {

template <int dim>
class Bisection {
 public:
  Bisection(const std::vector<Vec<dim>> &centre, const std::vector<double> &weight,
            const std::vector<std::vector<int>> &touching)
      : centre_(centre), weight_(weight), touching_(touching), side_(centre.size(), neither) {}

  /// Cuts some patches for `ranks` ranks.
  void divide(std::vector<int> patches, int ranks) {
    if (ranks == 1) return;
    const int lower_ranks = ranks / 2;
    const double share = static_cast<double>(lower_ranks) / ranks;
    std::size_t lower = 0, fewest = -1;
    Cut best;
    for (int axis = 0; axis < dim; ++axis) {
      auto sorted = patches;
      const std::size_t at = cut(sorted, axis, share), faces = faces_cut(sorted, at);
      if (faces >= fewest && axis > 0) continue;
      fewest = faces, lower = at, best_ = sorted;
      best = {std::numeric_limits<double>::infinity(), axis, 0};
      if (at < sorted.size()) best.place = centre_[sorted[at]][axis], best.patch = sorted[at];
    }
    cuts.push_back(best);
    const std::vector<int> halves[2] = {{best_.begin(), best_.begin() + lower}, {best_.begin() + lower, best_.end()}};
    divide(halves[0], lower_ranks);
    divide(halves[1], ranks - lower_ranks);
  }

 private:
  static constexpr char neither = 0, below = 1, above = 2;
  const std::vector<Vec<dim>> &centre_;
  const std::vector<double> &weight_;
  const std::vector<std::vector<int>> &touching_;
  std::vector<char> side_;
  std::vector<int> best_;

 public:
  Cuts cuts;

 private:
  /// Sorts patches along an axis; returns how many of them hold `share` of the weight.
  std::size_t cut(std::vector<int> &patches, int axis, double share) const {
    std::sort(patches.begin(), patches.end(), [&](int a, int b) {
      return centre_[a][axis] != centre_[b][axis] ? centre_[a][axis] < centre_[b][axis] : a < b;
    });
    double total = 0, sum = 0;
    for (int p : patches) total += weight_[p];
    std::size_t at = 0;
    while (at < patches.size() && std::abs(sum + weight_[patches[at]] - share * total) <= std::abs(sum - share * total))
      sum += weight_[patches[at++]];
    return at;
  }

  std::size_t faces_cut(const std::vector<int> &patches, std::size_t lower) {
    for (std::size_t i = 0; i < patches.size(); ++i) side_[patches[i]] = i < lower ? below : above;
    std::size_t faces = 0;
    for (std::size_t i = 0; i < lower; ++i)
      for (int other : touching_[patches[i]]) faces += side_[other] == above;
    for (int p : patches) side_[p] = neither;
    return faces;
  }
};

}  // namespace

template <int dim>
Cuts find_cuts(const std::vector<Vec<dim>> &centre, const std::vector<double> &weight,
               const std::vector<std::vector<int>> &touching, int ranks) {
  Bisection<dim> bisection(centre, weight, touching);
  std::vector<int> all(centre.size());
  std::iota(all.begin(), all.end(), 0);
  bisection.divide(all, ranks);
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

template Cuts find_cuts<2>(const std::vector<Vec<2>> &, const std::vector<double> &,
                           const std::vector<std::vector<int>> &, int);
template Cuts find_cuts<3>(const std::vector<Vec<3>> &, const std::vector<double> &,
                           const std::vector<std::vector<int>> &, int);
template std::vector<int> ranks_by_cuts<2>(const std::vector<Vec<2>> &, const Cuts &);
template std::vector<int> ranks_by_cuts<3>(const std::vector<Vec<3>> &, const Cuts &);

}  // namespace talus
