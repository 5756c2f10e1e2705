#pragma once
/// Search for the cells near a place: boxes around groups of cells, halved again and again.
#include <algorithm>
#include <numeric>
#include <vector>

#include "meshes/simplices.h"

namespace talus {

/// A box along the axes.
template <int dim>
struct Box {
  Vec<dim> low, high;

  bool meets(const Box &other) const {
    for (int d = 0; d < dim; ++d)
      if (low[d] > other.high[d] || high[d] < other.low[d]) return false;
    return true;
  }
  void enclose(const Box &other) {
    for (int d = 0; d < dim; ++d) low[d] = std::min(low[d], other.low[d]), high[d] = std::max(high[d], other.high[d]);
  }
};

template <int dim>
Box<dim> box_around(const std::array<Vec<dim>, dim + 1> &corner) {
  Box<dim> box{corner[0], corner[0]};
  for (const Vec<dim> &x : corner) box.enclose({x, x});
  return box;
}

template <int dim>
class CellTree {
 public:
  /// `cells` must outlive the tree.
  explicit CellTree(const Simplices<dim> &cells) : order_(cells.node.size()) {
    for (int c = 0; c < static_cast<int>(order_.size()); ++c) box_.push_back(box_around<dim>(cells.corners(c)));
    std::iota(order_.begin(), order_.end(), 0);
    if (!order_.empty()) build(0, static_cast<int>(order_.size()));
  }

  const Box<dim> &box(int cell) const { return box_[cell]; }

  /// Calls `take(cell)` for the cells whose boxes meet `box`, until it returns true; returns whether it did.
  template <class Take>
  bool any(const Box<dim> &box, const Take &take) const {
    return !order_.empty() && any(0, box, take);
  }

 private:
  static constexpr int leaf = 8;  // cells at the end of a branch
  struct Branch {
    Box<dim> box;
    int begin, end;  ///< cells in `order_`
    int second;      ///< the second half; the first follows; -1 at the end
  };

  int build(int begin, int end) {
    const int mine = static_cast<int>(branches_.size());
    Box<dim> all = box_[order_[begin]];
    for (int i = begin; i < end; ++i) all.enclose(box_[order_[i]]);
    branches_.push_back({all, begin, end, -1});
    if (end - begin <= leaf) return mine;
    int axis = 0;
    for (int d = 1; d < dim; ++d)
      if (all.high[d] - all.low[d] > all.high[axis] - all.low[axis]) axis = d;
    const int middle = (begin + end) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int a, int b) {
      return box_[a].low[axis] + box_[a].high[axis] < box_[b].low[axis] + box_[b].high[axis];
    });
    build(begin, middle);
    const int second = build(middle, end);
    branches_[mine].second = second;
    return mine;
  }

  template <class Take>
  bool any(int number, const Box<dim> &box, const Take &take) const {
    const Branch &branch = branches_[number];
    if (!branch.box.meets(box)) return false;
    if (branch.second >= 0) return any(number + 1, box, take) || any(branch.second, box, take);
    return std::any_of(order_.begin() + branch.begin, order_.begin() + branch.end,
                       [&](int cell) { return box_[cell].meets(box) && take(cell); });
  }

  std::vector<Box<dim>> box_;
  std::vector<int> order_;
  std::vector<Branch> branches_;
};

}  // namespace talus
