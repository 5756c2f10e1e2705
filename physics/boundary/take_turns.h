#pragma once
/// Several things that act on one vector of a node, docs/theory (6.1a): each in turn meets the vector that the others
/// leave, until nothing changes (Gauss-Seidel; Jean 1999, Comput. Methods Appl. Mech. Eng. 177, 235-257).
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/vec.h"

namespace talus {

template <int dim>
class TakeTurns {
 public:
  /// Makes room for `most` actors, so that turns ask for no memory.
  void reserve(int most) { change_.resize(std::max<size_t>(most, change_.size())); }

  /// Lets actors 0 to `count` - 1 act on `v`, `first` before the others: `act(k, others)` is the vector that actor k
  /// leaves of `others`. One that is alone acts once.
  template <class Act>
  void operator()(int count, int first, Vec<dim> &v, Act &&act) {
    std::fill_n(change_.begin(), count, Vec<dim>{});
    double met = 0;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      double moved = 0;
      met = std::max(met, map<dim>(v).norm());
      for (int turn = 0; turn < count; ++turn) {
        const int k = (first + turn) % count;
        Vec<dim> others = v;
        for (int d = 0; d < dim; ++d) others[d] -= change_[k][d];
        const Vec<dim> after = act(k, others);
        for (int d = 0; d < dim; ++d)
          change_[k][d] = after[d] - others[d], moved = std::max(moved, std::abs(after[d] - v[d]));
        v = after;
      }
      if (count == 1 || moved <= negligible * met) return;
    }
  }

  const Vec<dim> &change(int k) const { return change_[k]; }  ///< of the vector by actor k

 private:
  static constexpr int most_sweeps = 200;
  static constexpr double negligible = 1e-14;  // of the vector that the actors meet
  std::vector<Vec<dim>> change_;
};

}  // namespace talus
