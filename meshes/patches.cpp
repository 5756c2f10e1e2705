#include "meshes/patches.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

namespace talus {
namespace {

/// A set of numbers below a count, of which the lowest is asked for again and again: a bit for each of them, and one
/// for each 64 bits, and so on up to a single word.
class LowestFirst {
 public:
  explicit LowestFirst(std::size_t count) {
    do levels_.emplace_back(count = (count + 63) / 64);
    while (count > 1);
  }
  void insert(std::size_t number) {
    for (auto &level : levels_) level[number / 64] |= bit(number), number /= 64;
  }
  void erase(std::size_t number) {
    for (auto &level : levels_) {
      if ((level[number / 64] &= ~bit(number)) != 0) return;
      number /= 64;
    }
  }
  /// -1 of an empty set.
  int lowest() const {
    if (levels_.back().empty() || levels_.back()[0] == 0) return -1;
    std::size_t number = 0;
    for (auto level = levels_.rbegin(); level != levels_.rend(); ++level)
      number = 64 * number + std::countr_zero((*level)[number]);
    return static_cast<int>(number);
  }

 private:
  static std::uint64_t bit(std::size_t number) { return std::uint64_t{1} << (number % 64); }
  std::vector<std::vector<std::uint64_t>> levels_;
};

template <int dim>
class Patches {
 public:
  using Corners = std::vector<std::array<int, dim + 1>>;
  Patches(const Corners &node, const Corners &neighbour, const std::vector<int> &kind, int size)
      : node_(node),
        neighbour_(neighbour),
        kind_(kind),
        size_(size),
        waiting_(dim + 2, LowestFirst(node.size())),
        patch(node.size(), none) {}

  void grow() {
    const int count = static_cast<int>(node_.size());
    free_neighbours_.resize(count);
    for (int c = 0; c < count; ++c) waiting_[free_neighbours_[c] = count_free(c)].insert(c);
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
  void join_fragments(int smallest) {
    std::vector<int> next(patch.size(), none);  // of the same patch
    std::vector<Members> members(patch_count_);
    for (int c = 0; c < static_cast<int>(patch.size()); ++c) join(members[patch[c]], {c, c, 1}, next);
    for (int pass = 0; pass < 3; ++pass)
      for (int p = 0; p < patch_count_; ++p) {
        if (members[p].count == 0 || members[p].count >= smallest) continue;
        const int into = smallest_neighbour(p, members, next);
        if (into == none) continue;
        for (int c = members[p].first; c != none; c = next[c]) patch[c] = into;
        join(members[into], std::exchange(members[p], {}), next);
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
  std::vector<int> nodes_;            // of the patch that grows; few
  std::vector<LowestFirst> waiting_;  // free cells by their number of free neighbours

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
    for (const LowestFirst &cells : waiting_)
      if (const int c = cells.lowest(); c >= 0) return c;
    return none;
  }

  void take(int c) {
    patch[c] = patch_count_;
    waiting_[free_neighbours_[c]].erase(c);
    for (int node : node_[c])
      if (!std::count(nodes_.begin(), nodes_.end(), node)) nodes_.push_back(node);
    for (int j : neighbour_[c])
      if (joinable(c, j) && patch[j] == none) {
        waiting_[free_neighbours_[j]].erase(j);
        waiting_[free_neighbours_[j] = count_free(j)].insert(j);
      }
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

  /// Cells of a patch, each with the next one.
  struct Members {
    int first = none, last = none, count = 0;
  };
  static void join(Members &members, const Members &more, std::vector<int> &next) {
    (members.count ? next[members.last] : members.first) = more.first;
    members.last = more.last, members.count += more.count;
  }

  int smallest_neighbour(int p, const std::vector<Members> &members, const std::vector<int> &next) const {
    int smallest = none;
    for (int c = members[p].first; c != none; c = next[c])
      for (int j : neighbour_[c])
        if (joinable(c, j) && patch[j] != p && (smallest == none || members[patch[j]].count < members[smallest].count))
          smallest = patch[j];
    return smallest;
  }
};

}  // namespace

template <int dim>
std::vector<int> make_patches(const std::vector<std::array<int, dim + 1>> &node,
                              const std::vector<std::array<int, dim + 1>> &neighbour, const std::vector<int> &kind,
                              int size, int smallest) {
  Patches<dim> patches(node, neighbour, kind, size);
  patches.grow();
  patches.join_fragments(smallest > 0 ? smallest : (size + 1) / 2);
  patches.number_by_first_appearance();
  return std::move(patches.patch);
}

template std::vector<int> make_patches<2>(const std::vector<std::array<int, 3>> &,
                                          const std::vector<std::array<int, 3>> &, const std::vector<int> &, int, int);
template std::vector<int> make_patches<3>(const std::vector<std::array<int, 4>> &,
                                          const std::vector<std::array<int, 4>> &, const std::vector<int> &, int, int);

}  // namespace talus
