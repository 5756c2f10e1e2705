#pragma once
/// Search for the cells near a place: boxes around groups of cells, halved again and again.
#include <algorithm>
#include <vector>

#include "meshes/box.h"
#include "meshes/simplices.h"

namespace talus {

template <int dim>
Box<dim> box_around(const std::array<Vec<dim>, dim + 1> &corner) {
  Box<dim> box{corner[0], corner[0]};
  for (const Vec<dim> &x : corner) box.enclose(x);
  return box;
}

template <int dim>
class CellTree {
 public:
  explicit CellTree(const Simplices<dim> &cells) {
    const int count = static_cast<int>(cells.node.size());
    leaves_.reserve(count);
    for (int c = 0; c < count; ++c) leaves_.push_back({box_around<dim>(cells.corners(c)), c});
    if (count > 0) build(0, count);
  }

  /// Calls `take(cell)` for the cells whose boxes meet `box`, until it returns true; returns whether it did.
  template <class Take>
  bool any(const Box<dim> &box, const Take &take) const {
    return !leaves_.empty() && any(0, box, take);
  }

 private:
  static constexpr int most = 8;  // cells at the end of a branch
  /// A cell with its box: those of a branch stand together in memory.
  struct Leaf {
    Box<dim> box;
    int cell;
  };
  struct Branch {
    Box<dim> box;
    int begin, end;  ///< leaves
    int second;      ///< the second half; the first follows; -1 at the end
  };

  int build(int begin, int end) {
    const int mine = static_cast<int>(branches_.size());
    Box<dim> all = leaves_[begin].box;
    for (int i = begin; i < end; ++i) all.enclose(leaves_[i].box);
    branches_.push_back({all, begin, end, -1});
    if (end - begin <= most) return mine;
    int axis = 0;
    for (int d = 1; d < dim; ++d)
      if (all.high[d] - all.low[d] > all.high[axis] - all.low[axis]) axis = d;
    const int middle = (begin + end) / 2;
    std::nth_element(leaves_.begin() + begin, leaves_.begin() + middle, leaves_.begin() + end,
                     [&](const Leaf &a, const Leaf &b) {
                       return a.box.low[axis] + a.box.high[axis] < b.box.low[axis] + b.box.high[axis];
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
    return std::any_of(leaves_.begin() + branch.begin, leaves_.begin() + branch.end,
                       [&](const Leaf &leaf) { return leaf.box.meets(box) && take(leaf.cell); });
  }

  std::vector<Leaf> leaves_;
  std::vector<Branch> branches_;
};

}  // namespace talus
