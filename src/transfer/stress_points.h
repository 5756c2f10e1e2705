#pragma once
/// Where stress is known during a Lagrangian part: with averaged stress one point per cell and body, otherwise the
/// particles themselves. Both look the same to the kernel (docs/theory, section 4.3).
#include <algorithm>
#include <vector>

#include "base/room.h"

namespace talus {

struct PointSet {
  int count = 0;
  const int *cell = nullptr;      ///< [count] compact cell
  double *stress = nullptr;       ///< [count][stress_size] accepted stress [Pa]
  double *history = nullptr;      ///< [count][history]
  double *volume = nullptr;       ///< [count] [m3]
  const double *limit = nullptr;  ///< [count] rest volume: the volume cap is a multiple of it [m3]
  const double *cohesion_share = nullptr, *friction_share = nullptr;  ///< [count] null where the law reads none

  // owned when stress is averaged; else only `own_cell` is used
  std::vector<int> own_cell;
  std::vector<double> own_stress, own_history, own_volume, own_limit, own_cohesion_share, own_friction_share;
  std::vector<double> start_history, start_volume;  ///< at the remap; particles gain the difference

  /// Makes room for the points of `cells` mesh cells.
  void make_room_in(int cells) { make_room(number_, cells); }
  /// The point of a mesh cell, -1 where there is none.
  int find(int mesh_cell) const { return number_[mesh_cell] - 1; }
  /// The point of a mesh cell, which is the last one on first use: its sums are then to be set.
  int enter(int mesh_cell, int compact_cell) {
    if (number_[mesh_cell] == 0) own_cell[count] = compact_cell, number_[mesh_cell] = ++count;
    return find(mesh_cell);
  }
  /// The mesh cell has no point any more.
  void leave(int mesh_cell) { number_[mesh_cell] = 0; }
  /// Turns sums over particles into means weighted by volume, where the Lagrangian part starts.
  void start(int components, int history_count) {
    for (int q = 0; q < count; ++q) {
      const double scale = 1 / own_volume[q];
      for (int s = 0; s < components; ++s) own_stress[q * components + s] *= scale;
      for (int h = 0; h < history_count; ++h) own_history[q * history_count + h] *= scale;
    }
    std::copy_n(own_history.begin(), count * history_count, start_history.begin());
    std::copy_n(own_volume.begin(), count, start_volume.begin());
  }

 private:
  std::vector<int> number_;  ///< [mesh cells] point plus one, 0 where there is none
};

}  // namespace talus
