#pragma once
/// The directions in which boundaries prescribe the motion of a node, orthonormal. The first direction counts as it is,
/// a later one by its component across those before it.
#include <array>
#include <cmath>

#include "base/vec.h"

namespace talus {

inline constexpr double least_angle_sine =
    0.05233595624294384;  // of 3 degrees: facets of one curved face share a direction within this
inline const double same_direction = std::sqrt(1 - least_angle_sine * least_angle_sine);  ///< their cosine

template <int dim>
struct PrescribedDirections {
  int count = 0;
  std::array<Vec<dim>, dim> direction;  ///< orthonormal
  std::array<int, dim> source;          ///< boundary of each direction
  /// Adds the component of a unit vector across the present directions, unless it is as small as between facets of one
  /// curved face.
  void add(const Vec<dim> &wanted, int of) {
    ColumnVector<dim> rest = map<dim>(wanted);
    for (int k = 0; k < count; ++k) rest -= rest.dot(map<dim>(direction[k])) * map<dim>(direction[k]);
    if (count == dim || rest.norm() < least_angle_sine) return;
    rest.normalize();
    map<dim>(direction[count]) = rest;
    source[count++] = of;
  }
  /// Takes from a vector its part along the directions.
  void take_from(Vec<dim> &v) const {
    for (int k = 0; k < count; ++k) add_scaled<dim>(v, -dot<dim>(v, direction[k]), direction[k]);
  }
};

}  // namespace talus
