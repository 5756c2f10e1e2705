#pragma once
/// Rigid motions of a body: translations, then rotations.
#include "base/vec.h"

namespace talus {

template <int dim>
constexpr int rigid_modes = dim *(dim + 1) / 2;

/// Velocity of rigid mode m at a place relative to a centre.
template <int dim>
Vec<dim> rigid_motion(int m, const Vec<dim> &r) {
  Vec<dim> v{};
  if (m < dim) {
    v[m] = 1;
  } else {
    const int i = dim == 2 ? 0 : m - dim, j = dim == 2 ? 1 : (m - dim + 1) % 3;
    v[i] = -r[j], v[j] = r[i];
  }
  return v;
}

}  // namespace talus
