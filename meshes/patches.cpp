#include "meshes/patches.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

namespace talus {
namespace {

template <int dim>
class Patches {
 public:
  using Corners = std::vector<std::array<int, dim + 1>>;
  Patches(const Corners &node, const Corners &neighbour, const std::vector<int> &kind, int size)
      : node_(node), neighbour_(neighbour), kind_(kind), size_(size), patch(node.size(), none) {}

  void grow() {
    const int count = static_cast<int>(node_.size());
    free_neighbours_.resize(count);
    for (int c = 0; c < count; ++c) waiting_[free_neighbours_[c] = count_free(c)].push(c);
    for (int first; (first = loneliest()) != none;) {
      cells_.assign(1, first);
      nodes_.clear();
      take(cells_.front());
      for (int next; static_cast<int>(cells_.size()) < size_ && (next = best()) != none;) {
        take(next);
        cells_.push_back(next);
      }
      ++patch_count_;
    }
  }

  /// Three passes, since a joined pair of fragments may still be a fragment.
  void join_fragments() {
    std::vector<std::vector<int>> members(patch_count_);
    for (std::size_t c = 0; c < patch.size(); ++c) members[patch[c]].push_back(static_cast<int>(c));
    for (int pass = 0; pass < 3; ++pass)
      for (int p = 0; p < patch_count_; ++p) {
        if (members[p].empty() || static_cast<int>(members[p].size()) >= (size_ + 1) / 2) continue;
        const int into = smallest_neighbour(p, members);
        if (into == none) continue;
        for (int c : members[p]) patch[c] = into;
        members[into].insert(members[into].end(), members[p].begin(), members[p].end());
        members[p].clear();
      }
  }

  void number_by_first_appearance() {
    std::vector<int> number(patch_count_, none);
    int count = 0;
    for (int &p : patch) {
      if (number[p] == none) number[p] = count++;
      p = number[p];
    }
  }

 private:
  static constexpr int none = -1;
  const Corners &node_, &neighbour_;
  const std::vector<int> &kind_;
  const int size_;
  int patch_count_ = 0;
  std::vector<int> free_neighbours_, cells_;
  std::vector<int> nodes_;  // of the patch that grows; few
  /// Cells by their number of free neighbours, which only falls: a cell that is not free any more, or has fewer, is
  /// left out when its turn comes.
  std::array<std::priority_queue<int, std::vector<int>, std::greater<>>, dim + 2> waiting_;

 public:
  std::vector<int> patch;

 private:
  bool joinable(int c, int j) const { return j >= 0 && kind_[j] == kind_[c]; }

  int count_free(int c) const {
    return static_cast<int>(std::count_if(neighbour_[c].begin(), neighbour_[c].end(),
                                          [&](int j) { return joinable(c, j) && patch[j] == none; }));
  }

  /// The free cell with the fewest free neighbours, the first one of them; none when all are taken.
  int loneliest() {
    for (int free = 0; free < static_cast<int>(waiting_.size()); ++free)
      for (auto &cells = waiting_[free]; !cells.empty(); cells.pop())
        if (const int c = cells.top(); patch[c] == none && free_neighbours_[c] == free) return c;
    return none;
  }

  void take(int c) {
    patch[c] = patch_count_;
    for (int node : node_[c])
      if (!std::count(nodes_.begin(), nodes_.end(), node)) nodes_.push_back(node);
    for (int j : neighbour_[c])
      if (joinable(c, j) && patch[j] == none) waiting_[free_neighbours_[j] = count_free(j)].push(j);
  }

  /// Few new nodes means that cells close around an edge or a vertex.
  double score(int c) const {
    double faces = 0, nodes = 0;
    for (int j : neighbour_[c]) faces += j >= 0 && patch[j] == patch_count_;
    for (int i : node_[c]) nodes += std::count(nodes_.begin(), nodes_.end(), i) > 0;
    return 10 * faces + 6 * nodes - 0.5 * free_neighbours_[c];
  }

  int best() const {
    int best = none;
    double highest = -1e9;
    for (int c : cells_)
      for (int j : neighbour_[c]) {
        if (!joinable(c, j) || patch[j] != none) continue;
        if (const double s = score(j); s > highest) highest = s, best = j;
      }
    return best;
  }

  int smallest_neighbour(int p, const std::vector<std::vector<int>> &members) const {
    int smallest = none;
    for (int c : members[p])
      for (int j : neighbour_[c])
        if (joinable(c, j) && patch[j] != p &&
            (smallest == none || members[patch[j]].size() < members[smallest].size()))
          smallest = patch[j];
    return smallest;
  }
};

}  // namespace

template <int dim>
std::vector<int> make_patches(const std::vector<std::array<int, dim + 1>> &node,
                              const std::vector<std::array<int, dim + 1>> &neighbour, const std::vector<int> &kind,
                              int size) {
  Patches<dim> patches(node, neighbour, kind, size);
  patches.grow();
  patches.join_fragments();
  patches.number_by_first_appearance();
  return std::move(patches.patch);
}

template std::vector<int> make_patches<2>(const std::vector<std::array<int, 3>> &,
                                          const std::vector<std::array<int, 3>> &, const std::vector<int> &, int);
template std::vector<int> make_patches<3>(const std::vector<std::array<int, 4>> &,
                                          const std::vector<std::array<int, 4>> &, const std::vector<int> &, int);

}  // namespace talus
