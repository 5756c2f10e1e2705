#pragma once
/// What the nodes of a cell add to its particles within the Lagrangian part, docs/theory section 4.6.
#include <array>

#include "base/vec.h"

namespace talus {

template <int dim>
struct CellMotion {
  std::array<Vec<dim>, dim + 1> way{};   ///< of each node since the last remap [m]
  std::array<Vec<dim>, dim + 1> gain{};  ///< velocity that each node gives in place of the share that it had [m/s]
  double own_share = 1;                  ///< of its velocity, that a particle keeps

  /// Of a particle with barycentric coordinates n that was at `place` at the last remap.
  Vec<dim> position(const std::array<double, dim + 1> &n, Vec<dim> place) const {
    for (int k = 0; k <= dim; ++k)
      for (int d = 0; d < dim; ++d) place[d] += n[k] * way[k][d];
    return place;
  }
  /// ... and that had the velocity `own` there.
  Vec<dim> velocity(const std::array<double, dim + 1> &n, Vec<dim> own) const {
    for (double &component : own) component *= own_share;
    for (int k = 0; k <= dim; ++k)
      for (int d = 0; d < dim; ++d) own[d] += n[k] * gain[k][d];
    return own;
  }
};

}  // namespace talus
