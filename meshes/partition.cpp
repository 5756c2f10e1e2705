#include "meshes/partition.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace talus {
namespace {

template <int dim>
class Bisection {
 public:
  Bisection(const std::vector<Vec<dim>> &centre, const std::vector<double> &weight,
            const std::vector<std::vector<int>> &touching)
      : centre_(centre), weight_(weight), touching_(touching), side_(centre.size(), neither), rank(centre.size(), 0) {}

  /// Gives `ranks` ranks from `first` on to some patches.
  void divide(std::vector<int> patches, int first, int ranks) {
    if (ranks == 1) {
      for (int p : patches) rank[p] = first;
      return;
    }
    const int lower_ranks = ranks / 2;
    const double share = static_cast<double>(lower_ranks) / ranks;
    std::size_t lower = 0, fewest = -1;
    for (int axis = 0; axis < dim; ++axis) {
      auto sorted = patches;
      const std::size_t at = cut(sorted, axis, share), faces = faces_cut(sorted, at);
      if (faces >= fewest && axis > 0) continue;
      fewest = faces, lower = at, best_ = sorted;
    }
    const std::vector<int> halves[2] = {{best_.begin(), best_.begin() + lower}, {best_.begin() + lower, best_.end()}};
    divide(halves[0], first, lower_ranks);
    divide(halves[1], first + lower_ranks, ranks - lower_ranks);
  }

 private:
  static constexpr char neither = 0, below = 1, above = 2;
  const std::vector<Vec<dim>> &centre_;
  const std::vector<double> &weight_;
  const std::vector<std::vector<int>> &touching_;
  std::vector<char> side_;
  std::vector<int> best_;

 public:
  std::vector<int> rank;

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
std::vector<int> partition(const std::vector<Vec<dim>> &centre, const std::vector<double> &weight,
                           const std::vector<std::vector<int>> &touching, int ranks) {
  Bisection<dim> bisection(centre, weight, touching);
  std::vector<int> all(centre.size());
  std::iota(all.begin(), all.end(), 0);
  bisection.divide(all, 0, ranks);
  return bisection.rank;
}

template std::vector<int> partition<2>(const std::vector<Vec<2>> &, const std::vector<double> &,
                                       const std::vector<std::vector<int>> &, int);
template std::vector<int> partition<3>(const std::vector<Vec<3>> &, const std::vector<double> &,
                                       const std::vector<std::vector<int>> &, int);

}  // namespace talus
