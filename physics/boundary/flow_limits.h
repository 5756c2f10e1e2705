#pragma once
/// Limits of the flow of pore fluids at a node, and how all of them are kept together.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "base/vec.h"

namespace talus {

/// Bounds of the velocity of a fluid against the skeleton along a unit vector [m/s].
template <int dim>
struct FlowLimit {
  Vec<dim> n;
  double low, high;
  bool wall;         ///< of all fluids
  double taken = 0;  ///< by `hold_within`: the change along n [m/s]
};

/// What bounds the velocity of the fluids at a node.
template <int dim>
struct FlowLimits {
  std::array<FlowLimit<dim>, 24> all;
  int count = 0;
  /// Throws std::length_error at a node of more planes than a mesh has.
  void add(const FlowLimit<dim> &one) {
    if (count == static_cast<int>(all.size())) throw std::length_error("a node has more than 24 planes of boundaries");
    all[count++] = one;
  }
};

/// The least change of a velocity against the skeleton that brings it within all limits: `taken` along each of them.
/// Limits whose normals are neither equal nor at right angles act on each other, so that one after the other would let
/// through an edge what each of its sides stops. Hildreth (1957): each takes in turn what it needs beside the others.
template <int dim>
void hold_within(FlowLimits<dim> &limits, Vec<dim> velocity) {
  constexpr int most = 3000;         // sweeps: what is left falls by the square of the cosine between normals
  constexpr double settled = 1e-12;  // of what is taken
  for (int k = 0; k < limits.count; ++k) limits.all[k].taken = 0;
  for (int sweep = 0; sweep < most; ++sweep) {
    double change = 0, taken = 0;
    for (int k = 0; k < limits.count; ++k) {
      FlowLimit<dim> &one = limits.all[k];
      const double without = dot<dim>(velocity, one.n) - one.taken;
      const double needed = std::clamp(without, one.low, one.high) - without, more = needed - one.taken;
      add_scaled<dim>(velocity, more, one.n);
      one.taken = needed;
      change = std::max(change, std::abs(more)), taken = std::max(taken, std::abs(needed));
    }
    if (limits.count == 1 || change <= settled * taken) return;
  }
}

}  // namespace talus
